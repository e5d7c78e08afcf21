"""So many of something, in words."""


def counted(count: int, noun: str) -> str:
    """1 value, 2 values."""
    return f"{count} {noun}" if count == 1 else f"{count} {noun}s"
