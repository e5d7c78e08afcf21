"""A first look at a large text: its beginning and pieces from all over it, so that its columns are seen at once."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np

from bench.basics.errors import BenchError
from bench.dataset.logs.log_file import LogFile, Reading, read_log, text_log
from bench.dataset.names import TEXTS

LARGE = 1 << 25  # bytes of a text from which on its first look is at pieces
HEAD, PIECE, PIECES = 1 << 18, 1 << 14, 255  # bytes at the beginning, bytes of a piece behind it, how many
WHOLE_LINES = re.compile(rb"[\r\n](.*[\r\n])", re.DOTALL)


def glimpse(path: Path, reading: Reading) -> LogFile:
    """The log as `read_log` gives it; of a large text only the rows of its beginning and of evenly spaced pieces.

    A note says so. A text that cannot be read by pieces is read whole. Raises BenchError as `read_log` does.
    """
    if path.suffix.lower() not in TEXTS or not path.is_file() or (size := path.stat().st_size) <= LARGE:
        return read_log(path, reading)
    try:
        log = text_log(path, _pieces(path, size), reading)
    except BenchError:  # a fault in a piece, whose place only the whole text tells
        return read_log(path, reading)
    said = (
        f"{size / 2**20:.0f} MB: the beginning and {PIECES} pieces from all over it are shown; every row is read when "
        "the columns are checked, and again when it is imported"
    )
    return replace(log, notes=(*log.notes, said))


def _pieces(path: Path, size: int) -> bytes:
    """The beginning and evenly spaced pieces, all of whole lines."""
    with path.open("rb") as file:
        head = file.read(HEAD)
        parts = [head[: max(head.rfind(b"\n"), head.rfind(b"\r")) + 1]]
        for start in np.linspace(HEAD, size - PIECE, PIECES).astype(int):
            file.seek(start)
            if match := WHOLE_LINES.search(file.read(PIECE)):
                parts.append(match.group(1).lstrip(b"\r\n"))
    return b"".join(parts)
