"""The one exception that a user meets, and what its message says of a misspelt name."""

from collections.abc import Iterable
from difflib import get_close_matches


class BenchError(Exception):
    """A mistake in what the user gave, told in one line that names the culprit.

    The command line prints the line without a traceback and exits with code 2.
    """


def meant(name: str, known: Iterable[str], otherwise: str = "there are") -> str:
    """The end of a message about an unknown name: the known one most like it, or all of them."""
    names = list(known)
    near = get_close_matches(name, names, 1, cutoff=0.75)
    if near:
        return f"did you mean {near[0]!r}?"
    return f"{otherwise} {', '.join(names) or 'none'}"
