"""A user's Python file: read it, run it as a separate module, and report its errors with their line."""

import hashlib
import sys
import traceback
import types
from pathlib import Path

from bench.basics.errors import BenchError

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


def read_source(path: Path) -> str:
    """The text of the file. Raises BenchError that names the file if it cannot be read."""
    try:
        return path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise BenchError(f"{path}: {getattr(error, 'strerror', None) or error}") from None


def module_name(source: str, path: Path, prefix: str) -> str:
    """The module name for a text at this path; a different text has a different name."""
    return prefix + hashlib.sha256(f"{path}\n{source}".encode()).hexdigest()[:16]


def module_of(source: str, path: Path, prefix: str) -> types.ModuleType:
    """Run the text of a file, which need not exist yet; the module stays in `sys.modules`.

    Raises BenchError that names the file and, if known, the line.
    """
    module = types.ModuleType(module_name(source, path, prefix))
    module.__file__ = str(path)
    sys.modules[module.__name__] = module  # dataclasses look up their module
    try:
        exec(compile(source, str(path), "exec"), module.__dict__)
    except SyntaxError as error:
        del sys.modules[module.__name__]
        raise BenchError(f"{path}, line {error.lineno}: {error.msg}") from None
    except MISTAKES as error:
        del sys.modules[module.__name__]
        raise BenchError(described(error, path)) from None
    return module


def described(error: Exception, path: Path) -> str:
    """An error raised by a user's file as one line, with the file and the line number."""
    lines = [
        frame.lineno for frame in traceback.extract_tb(error.__traceback__) if frame.filename == str(path)
    ]
    at = f", line {lines[-1]}" if lines else ""
    return f"{path}{at}: {type(error).__name__}: {' '.join(str(error).split())}"
