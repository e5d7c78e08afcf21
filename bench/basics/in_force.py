"""A frozen value that is read in many places, and that a caller can replace temporarily."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from typing import Any, Generic, TypeVar, cast

Value = TypeVar("Value")


class _Read:
    """Forwards attributes of the current value."""

    def __init__(self, value: Callable[[], Any]) -> None:
        self._value = value

    def __getattr__(self, name: str) -> Any:
        return getattr(self._value(), name)


class InForce(Generic[Value]):
    """read: a proxy of the current value, for reading its attributes."""

    read: Value

    def __init__(self, default: Value) -> None:
        self._variable: ContextVar[Value] = ContextVar(type(default).__name__, default=default)
        self.read = cast("Value", _Read(self._variable.get))

    def value(self) -> Value:
        """The current value."""
        return self._variable.get()

    @contextmanager
    def during(self, value: Value | None) -> Iterator[None]:
        """Replace the value inside the context, in this thread; None keeps it."""
        token = self._variable.set(self._variable.get() if value is None else value)
        try:
            yield
        finally:
            self._variable.reset(token)
