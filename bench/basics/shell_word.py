"""Words of displayed command lines."""

from pathlib import Path


def quoted(word: str | Path) -> str:
    """A word, quoted for a shell if necessary."""
    word = str(word)
    return (
        word if all(c.isalnum() or c in "-_./:=,+~" for c in word) else "'" + word.replace("'", "'\\''") + "'"
    )
