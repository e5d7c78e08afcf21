"""The interface through which long work reports its progress; numeric code knows only this interface."""

from typing import Protocol


class Progress(Protocol):
    """Receives the beginning of each phase of the work, and its steps."""

    def phase(self, name: str, total: int | None = None) -> None:
        """Begin a phase of `total` steps; None: their number is unknown."""

    def advance(self, steps: int = 1) -> None:
        """Report `steps` more finished steps of the phase."""


class _Silent:
    """Ignores all reports."""

    def phase(self, name: str, total: int | None = None) -> None:
        """Ignore the report."""

    def advance(self, steps: int = 1) -> None:
        """Ignore the report."""


SILENT: Progress = _Silent()
