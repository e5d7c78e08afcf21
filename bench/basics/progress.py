"""What long work says of how far it is, to whoever wants to show it; numeric code knows no more of it."""

from typing import Protocol


class Progress(Protocol):
    """Called with the phase of the work that begins, and of every step of it."""

    def phase(self, name: str, total: int | None = None) -> None:
        """A phase begins, of `total` steps; None: nobody knows how many."""

    def advance(self, steps: int = 1) -> None:
        """So many more steps of the phase are done."""


class _Silent:
    """Tells nobody."""

    def phase(self, name: str, total: int | None = None) -> None:
        """Tell nobody."""

    def advance(self, steps: int = 1) -> None:
        """Tell nobody."""


SILENT: Progress = _Silent()
