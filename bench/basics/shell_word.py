"""A word of a command line that is shown."""

from pathlib import Path


def quoted(word: str | Path) -> str:
    """A word as a shell takes it."""
    word = str(word)
    return (
        word if all(c.isalnum() or c in "-_./:=,+~" for c in word) else "'" + word.replace("'", "'\\''") + "'"
    )
