"""Arrays as text for a page: little-endian numbers in base64."""

import base64
from typing import Any

import numpy as np

STEPS = {"<i1": 127, "<i2": 32767}  # of a quantised column on either side of zero
ANSWERS = 2  # last columns of a factor: what the others are to explain, of which no digit is left out


def floats(values: np.ndarray) -> str:
    """Numbers of single precision, in C order."""
    return _text(values, "<f4")


def doubles(values: np.ndarray) -> str:
    """Numbers of double precision, in C order."""
    return _text(values, "<f8")


def triangle(factor: np.ndarray) -> str:
    """The upper triangle (c, c) of a factor, row after row, in single precision."""
    return floats(factor[np.triu_indices(len(factor))])


def short_triangle(factor: np.ndarray) -> dict[str, str]:
    """The same (c, c) at half the length, for columns that are far from each other: integers of 16 bits.

    Each column is divided by its largest size (`sizes`), then each row counts in `steps`. `counts`: the rows of the
    upper triangle, one after the other, without `diagonal` and without the last columns, `answers` (c, ANSWERS).
    """
    sizes = np.abs(factor).max(axis=0, initial=0.0)
    sizes[sizes == 0.0] = 1.0
    scaled = factor / sizes
    inner = np.triu(scaled, 1)[:-ANSWERS, :-ANSWERS]
    steps = np.abs(inner).max(axis=1, initial=0.0) / STEPS["<i2"]
    counts = np.rint(inner / np.where(steps > 0.0, steps, 1.0)[:, None])
    return {
        "sizes": floats(sizes),
        "steps": floats(steps),
        "counts": _text(counts[np.triu_indices(len(inner), 1)], "<i2"),
        "diagonal": floats(np.diag(scaled)[:-ANSWERS]),
        "answers": floats(scaled[:, -ANSWERS:]),
    }


def quantised(columns: np.ndarray, kind: str = "<i2") -> dict[str, Any]:
    """Columns (T, c) in steps of their largest size: integers, one column after the other, and steps."""
    steps = np.abs(columns).max(axis=0, initial=0.0) / STEPS[kind]
    counts = np.rint(columns / np.where(steps > 0.0, steps, 1.0))
    return {"counts": _text(counts.T, kind), "steps": floats(steps), "bytes": int(kind[-1])}


def _text(values: np.ndarray, kind: str) -> str:
    return base64.b64encode(np.ascontiguousarray(values, dtype=kind).tobytes()).decode("ascii")
