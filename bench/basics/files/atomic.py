"""Files that are whole or not there: an interrupted command leaves no half-written one."""

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
    """Give a path to write to in place of `path`, and move it there once the block ends well.

    The stand-in lies in the same folder and has the same suffix, so that libraries that choose a
    format by suffix behave alike; folders that are missing are made. If the block raises, an interrupt
    included, the stand-in is removed and `path` stays as it was. A device or a pipe (/dev/stdout) is
    handed out as it is.

    Raises BenchError if `path` is a folder, or cannot be written: no permission, no space, a folder that is gone.
    """
    path = Path(path)
    if path.is_dir():
        raise BenchError(f"cannot write {path}: it is a folder")
    if path.exists() and not path.is_file():
        with _named(path, path):
            yield path
        return
    target = path.resolve()  # through a symbolic link, not over it
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
    """What the system says against writing, as a line that names `path`; paths: others that mean the same.

    An error that names another file is about that one, and goes on as it is.
    """
    try:
        yield
    except OSError as error:
        if error.filename is not None and Path(error.filename) not in paths:
            raise
        raise BenchError(f"cannot write {path}: {error.strerror or error}") from error


def why_unwritable(path: Path) -> str | None:
    """What speaks against writing a file there, or nothing: its stand-in is made and removed again.

    The folder has to be there.
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
    """The same of files in a folder, which may have to be made: one is made in the nearest that is there."""
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
    """Give an empty folder to fill in place of `folder`, and move it there once the block ends well.

    A folder of that name is replaced; what may be replaced is for the caller to say. If the block raises, an
    interrupt included, nothing remains and `folder` stays as it was. Raises BenchError if it cannot be written.
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
    """Write a UTF-8 text file in one step; see `atomic_path` for the errors."""
    with atomic_path(path) as partial:
        partial.write_text(text, encoding="utf-8")


def write_json_atomically(path: str | Path, value: Any) -> None:
    """Write `value` as indented JSON in one step.

    Raises ValueError for NaN and infinity, which JSON does not have, and TypeError for what has no
    JSON form; either before anything is written.
    """
    write_text_atomically(path, json.dumps(value, indent=2, ensure_ascii=False, allow_nan=False) + "\n")
