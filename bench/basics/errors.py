"""The exception for mistakes of users, and hints for misspelt names."""

from collections.abc import Iterable, Sequence
from difflib import get_close_matches

SHORTENED = 3  # letters that suffice to recognise the beginning of a longer name


class BenchError(Exception):
    """A mistake in the user's input, reported in one line that names the faulty item.

    The command line prints the line without a traceback and exits with code 2.
    """


class FaultsError(BenchError):
    """Several mistakes in the user's input, each reported in one line."""

    def __init__(self, lines: Iterable[str]) -> None:
        self.lines = tuple(lines)
        super().__init__("\n".join(self.lines))


def lines_of(error: BenchError) -> tuple[str, ...]:
    """The mistakes, one line each."""
    return error.lines if isinstance(error, FaultsError) else (str(error),)


def refuse(lines: Sequence[str]) -> None:
    """Raise BenchError with these lines, if there are any."""
    if lines:
        raise BenchError(lines[0]) if len(lines) == 1 else FaultsError(lines)


def meant(name: str, known: Iterable[str], otherwise: str = "there are") -> str:
    """The end of a message about an unknown name: the most similar known name, or all known names."""
    names = list(known)
    near = nearest(name, names)
    if near is not None:
        return f"did you mean {near!r}?"
    return f"{otherwise} {', '.join(names) or 'none'}"


def nearest(name: str, known: Iterable[str]) -> str | None:
    """The known name that is most similar to a misspelt one, or begins with it; None if there is none."""
    names = list(known)
    near = get_close_matches(name, names, 1, cutoff=0.75)
    begun = [longer for longer in names if longer.startswith(name)] if len(name) >= SHORTENED else []
    return next(iter([*near, *begun]), None)
