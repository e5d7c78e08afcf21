"""Counts with nouns."""


def plural(count: int, noun: str) -> str:
    """As in "1 recording" and "3 recordings"."""
    return f"{count} {noun}" + ("" if count == 1 else "s")


def and_more(count: int) -> str:
    """After the first of `count` things: how many more there are; "" if none."""
    return f" (and {count - 1} more)" if count > 1 else ""
