"""The interface for computing independent pieces, in this process in sequence or in several processes."""

from collections.abc import Callable, Iterator, Sequence
from typing import Protocol, TypeVar

Shared = TypeVar("Shared")
Item = TypeVar("Item")
Result = TypeVar("Result")


class Mapper(Protocol):
    """Applies a function to many items."""

    def map(
        self, work: Callable[[Shared, Item], Result], shared: Shared, items: Sequence[Item]
    ) -> Iterator[Result]:
        """work(shared, item) for every item, in the order of the items.

        work: a pure module-level function, so that every process gives the same result. Raises the BenchError of the
        first item that raises one.
        """


class _InTurn:
    """A mapper that works in this process, in sequence."""

    def map(
        self, work: Callable[[Shared, Item], Result], shared: Shared, items: Sequence[Item]
    ) -> Iterator[Result]:
        """See `Mapper`."""
        return (work(shared, item) for item in items)


IN_TURN: Mapper = _InTurn()
