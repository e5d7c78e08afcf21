"""Detect a text whose last line was cut off in the middle of a number: 39 instead of 395,22."""

import re
from pathlib import Path

from bench.basics.errors import BenchError

REACH = 1 << 16  # characters at both ends of a text from which the decimals of its numbers are counted
NUMBER = re.compile(r"[+-]?\d*(?:[.,](\d*(?:[eE][+-]?\d*)?))?")  # group 1: its decimals, with the exponent


def refuse_cut_off(path: Path, rows: str, delimiter: str) -> None:
    """Raise BenchError if the last row has no end of line and its last value has fewer decimals than those of other
    rows.

    rows: the text below the header; delimiter: " " for any blanks.
    """
    if rows.endswith(("\n", "\r")):
        return
    head, tail = rows[:REACH].splitlines(), rows[-REACH:].splitlines()
    last = _last_value(tail[-1], delimiter) if tail else ""
    places = [_decimals(_last_value(line, delimiter)) for line in (*head[:-1], *tail[1:-1])]
    if last and places and _decimals(last) < min(places):
        raise BenchError(
            f"{path}: the last line was cut off: it ends in {last!r}, with fewer decimals than any other, and has no "
            "end of line: remove it"
        )


def _last_value(line: str, delimiter: str) -> str:
    """The last value of a line; "" if it is not a number."""
    value = re.split(r"\s+" if delimiter == " " else re.escape(delimiter), line.rstrip())[-1].strip(' "')
    return value if NUMBER.fullmatch(value) else ""


def _decimals(number: str) -> int:
    match = NUMBER.fullmatch(number)
    return len(match.group(1) or "") if match else 0
