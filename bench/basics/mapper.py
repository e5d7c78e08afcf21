"""Who works out the independent pieces of a computation: this process one after the other, or several at once."""

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
        """work(shared, item) of every item, in the order of the items. work: a function of a module, which depends on
        nothing else, so that every process gives the same result. Raises BenchError as the first item that does.
        """


class _InTurn:
    """A mapper that works in this process."""

    def map(
        self, work: Callable[[Shared, Item], Result], shared: Shared, items: Sequence[Item]
    ) -> Iterator[Result]:
        """See `Mapper`."""
        return (work(shared, item) for item in items)


IN_TURN: Mapper = _InTurn()
