"""The one exception that a user meets, and what its message says of a misspelt name."""

from collections.abc import Iterable, Sequence
from difflib import get_close_matches

SHORTENED = 3  # letters that are enough to tell which longer name was begun


class BenchError(Exception):
    """A mistake in what the user gave, reported in one line that names the culprit.

    The command line prints the line without a traceback and exits with code 2.
    """


class FaultsError(BenchError):
    """Several mistakes in what the user gave, each reported in one line."""

    def __init__(self, lines: Iterable[str]) -> None:
        self.lines = tuple(lines)
        super().__init__("\n".join(self.lines))


def lines_of(error: BenchError) -> tuple[str, ...]:
    """What is wrong, a line each."""
    return error.lines if isinstance(error, FaultsError) else (str(error),)


def refuse(lines: Sequence[str]) -> None:
    """Raise BenchError with these lines, where there are any."""
    if lines:
        raise BenchError(lines[0]) if len(lines) == 1 else FaultsError(lines)


def meant(name: str, known: Iterable[str], otherwise: str = "there are") -> str:
    """The end of a message about an unknown name: the known one most like it, or all of them."""
    names = list(known)
    near = nearest(name, names)
    if near is not None:
        return f"did you mean {near!r}?"
    return f"{otherwise} {', '.join(names) or 'none'}"


def nearest(name: str, known: Iterable[str]) -> str | None:
    """The known name that a misspelt one is most like, or that it begins; None where none is near."""
    names = list(known)
    near = get_close_matches(name, names, 1, cutoff=0.75)
    begun = [longer for longer in names if longer.startswith(name)] if len(name) >= SHORTENED else []
    return next(iter([*near, *begun]), None)
