"""A frozen value that decides in many places, and another in its place while a caller asks for that."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from typing import Any, Generic, TypeVar, cast

Value = TypeVar("Value")


class _Read:
    """Attributes of the value in force."""

    def __init__(self, value: Callable[[], Any]) -> None:
        self._value = value

    def __getattr__(self, name: str) -> Any:
        return getattr(self._value(), name)


class InForce(Generic[Value]):
    """read: the value in force, to be read attribute by attribute wherever it decides."""

    read: Value

    def __init__(self, default: Value) -> None:
        self._variable: ContextVar[Value] = ContextVar(type(default).__name__, default=default)
        self.read = cast("Value", _Read(self._variable.get))

    def value(self) -> Value:
        """The value in force, whole."""
        return self._variable.get()

    @contextmanager
    def during(self, value: Value | None) -> Iterator[None]:
        """Another value while the context lasts, in this thread; None: no other."""
        token = self._variable.set(self._variable.get() if value is None else value)
        try:
            yield
        finally:
            self._variable.reset(token)
