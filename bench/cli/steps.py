"""Steps that bring an answer to its reader: each is taken, whatever becomes of the others, and no error is lost."""

import json
from collections.abc import Callable, Mapping
from types import TracebackType
from typing import Any

import click

from bench.basics.errors import BenchError, FaultsError, lines_of


class _Collected:
    """Errors that are raised inside, each kept for later; what is no error, as an interrupt, goes on at once."""

    def __init__(self) -> None:
        self.errors: list[Exception] = []

    def __enter__(self) -> None:
        pass

    def __exit__(
        self, _kind: type[BaseException] | None, error: BaseException | None, _trace: TracebackType | None
    ) -> bool:
        if not isinstance(error, Exception):
            return False
        self.errors.append(error)
        return True


def take_all(*steps: Callable[[], object]) -> None:
    """Take every step in order. What steps raised is raised once all were taken; several errors together."""
    collected = _Collected()
    for step in steps:
        with collected:
            step()
    errors = collected.errors
    users = [error for error in errors if isinstance(error, BenchError)]
    if len(errors) == 1:
        raise errors[0]
    if errors and len(users) == len(errors):
        raise FaultsError(line for error in users for line in lines_of(error))
    if errors:
        raise ExceptionGroup("more than one step failed", errors)


def shown(report: Callable[[], object], verdict: Callable[[], Mapping[str, Any]]) -> None:
    """Print a report; where it cannot be made, the verdict as JSON, and the error goes on."""
    done = False
    try:
        report()
        done = True
    finally:
        if not done:
            click.echo(json.dumps(verdict(), indent=2, ensure_ascii=False))
