"""Counts with nouns."""


def plural(count: int, noun: str) -> str:
    """As in "1 recording" and "3 recordings"."""
    return f"{count} {noun}" + ("" if count == 1 else "s")
