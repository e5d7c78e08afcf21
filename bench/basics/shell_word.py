"""Words of displayed command lines."""

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any, TypeVar

Word = TypeVar("Word", str, Path)


def each(option: str, values: Iterable[Word]) -> list[str | Word]:
    """The option before each of the values, as in --with A --with B."""
    return [word for value in values for word in (option, value)]


def option_words(options: Mapping[str, Any]) -> list[str]:
    """Options by name, with underscores for hyphens, as words: without those that are None or False."""
    words = []
    for name, value in options.items():
        if value not in (None, False):
            words.append(f"--{name.replace('_', '-')}")
            if value is not True:
                words.append(",".join(map(str, value)) if isinstance(value, list | tuple) else str(value))
    return words


def quoted(word: str | Path) -> str:
    """A word, quoted for a shell if necessary."""
    word = str(word)
    return (
        word if all(c.isalnum() or c in "-_./:=,+~" for c in word) else "'" + word.replace("'", "'\\''") + "'"
    )
