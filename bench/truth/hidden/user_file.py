"""User-defined hidden effects: classes in a Python file that a scenario names."""

import inspect
import sys
from collections.abc import Callable, Mapping
from dataclasses import fields
from pathlib import Path
from typing import Any

from bench.basics.errors import BenchError
from bench.basics.files.python_file import module_name, module_of, read_source
from bench.truth.hidden.base import HiddenEffect

PREFIX = "bench_hidden_effects_"


def hidden_in(path: Path) -> dict[str, type[HiddenEffect]]:
    """The hidden effects that a Python file defines, by name: its subclasses of HiddenEffect or JointEffect.

    The file is run. Raises BenchError that names the file, and the line where it can.
    """
    return _hidden_of(read_source(path), path)


def _hidden_of(source: str, path: Path) -> dict[str, type[HiddenEffect]]:
    name = module_name(source, path, PREFIX)
    module = sys.modules.get(name) or module_of(source, path, PREFIX)
    classes = [
        member
        for member in vars(module).values()
        if isinstance(member, type) and issubclass(member, HiddenEffect) and member.__module__ == name
    ]
    by_name = {
        kind.name: kind for kind in classes if isinstance(inspect.getattr_static(kind, "name", None), str)
    }
    if not by_name:
        raise BenchError(f"{path}: no subclass of HiddenEffect or JointEffect that has a name")
    for kind in by_name.values():
        kind.__reduce__ = _reducer(source, path)  # type: ignore[assignment, method-assign]
    return by_name


def _reducer(source: str, path: Path) -> Callable[[Any], tuple[Any, ...]]:
    """How such an effect goes to another process, which has not run its file: with the file's text."""

    def reduced(effect: Any) -> tuple[Any, ...]:
        values = {field.name: getattr(effect, field.name) for field in fields(effect)}
        return _restored, (source, str(path), effect.name, values)

    return reduced


def _restored(source: str, path: str, name: str, values: Mapping[str, Any]) -> HiddenEffect:
    return _hidden_of(source, Path(path))[name](**values)
