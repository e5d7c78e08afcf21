"""Hidden effects of one's own: classes in a Python file that a scenario names."""

from __future__ import annotations

import hashlib
import inspect
import sys
import traceback
import types
from pathlib import Path

from bench.basics.errors import BenchError
from bench.truth.hidden.base import HiddenEffect

PREFIX = "bench_hidden_effects_"
MISTAKES = (
    ArithmeticError,
    AttributeError,
    ImportError,
    LookupError,
    NameError,
    OSError,
    TypeError,
    ValueError,
)


def hidden_in(path: Path) -> dict[str, type[HiddenEffect]]:
    """The hidden effects that a Python file defines, by name: its subclasses of HiddenEffect or JointEffect.

    The file is run. Raises BenchError that names the file, and the line where it can.
    """
    try:
        source = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise BenchError(f"{path}: {getattr(error, 'strerror', None) or error}") from None
    name = PREFIX + hashlib.sha256(f"{path}\n{source}".encode()).hexdigest()[:16]
    if name not in sys.modules:
        _run(source, path, name)
    classes = [
        one
        for one in vars(sys.modules[name]).values()
        if isinstance(one, type) and issubclass(one, HiddenEffect) and one.__module__ == name
    ]
    found = {one.name: one for one in classes if isinstance(inspect.getattr_static(one, "name", None), str)}
    if not found:
        raise BenchError(f"{path}: no subclass of HiddenEffect or JointEffect that has a name")
    return found


def _run(source: str, path: Path, name: str) -> None:
    module = types.ModuleType(name)
    module.__file__ = str(path)
    sys.modules[name] = module  # dataclasses look their module up
    try:
        exec(compile(source, str(path), "exec"), module.__dict__)
    except SyntaxError as error:
        del sys.modules[name]
        raise BenchError(f"{path}, line {error.lineno}: {error.msg}") from None
    except MISTAKES as error:
        del sys.modules[name]
        frames = traceback.extract_tb(error.__traceback__)
        lines = [one.lineno for one in frames if one.filename == str(path)]
        at = f", line {lines[-1]}" if lines else ""
        raise BenchError(f"{path}{at}: {type(error).__name__}: {' '.join(str(error).split())}") from None
