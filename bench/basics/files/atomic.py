"""Atomic writing: an interrupted command leaves no incomplete file."""

import json
import os
import secrets
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from bench.basics.errors import BenchError


@contextmanager
def atomic_path(path: str | Path) -> Iterator[Path]:
    """Provide a temporary path to write to, and move it to `path` if the block succeeds.

    The temporary file is in the same folder and has the same suffix, for libraries that choose a format by suffix;
    missing folders are created. If the block raises, including an interrupt, the temporary file is removed and `path`
    is unchanged. A device or a pipe (/dev/stdout) is provided directly.

    Raises BenchError if `path` is a folder, or cannot be written, for example without permission or space, or if the
    folder is gone.
    """
    path = Path(path)
    if path.is_dir():
        raise BenchError(f"cannot write {path}: it is a folder")
    if path.exists() and not path.is_file():
        with _named(path, path):
            yield path
        return
    target = path.resolve()  # write through a symbolic link instead of replacing it
    partial = _stand_in(target)
    with _named(path, partial, target, target.parent):
        target.parent.mkdir(parents=True, exist_ok=True)
        partial.touch(exist_ok=False)
        try:
            yield partial
            partial.replace(target)
        finally:
            partial.unlink(missing_ok=True)


def _stand_in(target: Path) -> Path:
    return target.with_name(f".{target.stem}.partial-{secrets.token_hex(4)}{target.suffix}")


@contextmanager
def _named(path: Path, *paths: Path) -> Iterator[None]:
    """Turn an OSError into a BenchError that names `path`. paths: other names of the same file.

    An error about a different file is raised unchanged.
    """
    try:
        yield
    except OSError as error:
        if error.filename is not None and Path(error.filename) not in paths:
            raise
        raise BenchError(f"cannot write {path}: {error.strerror or error}") from error


def why_unwritable(path: Path) -> str | None:
    """Why a file cannot be written, or None; tested by creating and removing a temporary file.

    The folder must exist.
    """
    if path.is_dir():
        return "it is a folder"
    if path.exists() and not path.is_file():
        return None if os.access(path, os.W_OK) else "it takes no writing"
    partial = _stand_in(path.resolve())
    try:
        partial.touch(exist_ok=False)
        partial.unlink()
    except OSError as error:
        return error.strerror or str(error)
    return None


def why_no_folder(folder: Path) -> str | None:
    """Why files cannot be written into a folder that may not exist yet, or None; tested in its nearest existing
    parent.
    """
    there = next(path for path in (folder, *folder.parents) if path.exists())
    if not there.is_dir():
        return f"{there} is a file: name a folder"
    partial = there.resolve() / f".partial-{secrets.token_hex(4)}"
    try:
        partial.mkdir()
        partial.rmdir()
    except OSError as error:
        return error.strerror or str(error)
    return None


@contextmanager
def whole_folder(folder: str | Path) -> Iterator[Path]:
    """Provide an empty temporary folder to fill, and move it to `folder` if the block succeeds.

    An existing folder is replaced; the caller decides whether it may be. If the block raises, including an interrupt,
    nothing remains and `folder` is unchanged. Raises BenchError if it cannot be written.
    """
    target = Path(folder).resolve()
    mark = secrets.token_hex(4)
    partial, old = (target.with_name(f".{target.name}.{kind}-{mark}") for kind in ("partial", "old"))
    try:
        partial.mkdir(parents=True)
        yield partial
        if target.exists():
            target.rename(old)
        partial.rename(target)
    except OSError as error:
        raise BenchError(f"{folder}: cannot be written: {error.strerror}") from error
    finally:
        if old.exists() and not target.exists():  # interrupted between the two renames
            old.rename(target)
        shutil.rmtree(partial, ignore_errors=True)
        shutil.rmtree(old, ignore_errors=True)


def write_text_atomically(path: str | Path, text: str) -> None:
    """Write a UTF-8 text file atomically; see `atomic_path` for the errors."""
    with atomic_path(path) as partial:
        partial.write_text(text, encoding="utf-8")


def write_json_atomically(path: str | Path, value: Any) -> None:
    """Write `value` as indented JSON atomically.

    Raises ValueError for NaN and infinity, and TypeError for a value without a JSON form, both before anything is
    written.
    """
    write_text_atomically(path, json.dumps(value, indent=2, ensure_ascii=False, allow_nan=False) + "\n")
