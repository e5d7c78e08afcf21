"""Arrays as text for a page: little-endian numbers in base64."""

import base64

import numpy as np

STEPS = 32767  # of a quantised column on either side of zero


def floats(values: np.ndarray) -> str:
    """Numbers of single precision, in C order."""
    return _text(values, "<f4")


def doubles(values: np.ndarray) -> str:
    """Numbers of double precision, in C order."""
    return _text(values, "<f8")


def triangle(factor: np.ndarray) -> str:
    """The upper triangle (c, c) of a factor, row after row, in single precision."""
    return floats(factor[np.triu_indices(len(factor))])


def quantised(columns: np.ndarray) -> dict[str, str]:
    """Columns (T, c) in steps of their largest size: integers of 16 bits, one column after the other, and steps."""
    steps = np.abs(columns).max(axis=0, initial=0.0) / STEPS
    counts = np.rint(columns / np.where(steps > 0.0, steps, 1.0))
    return {"counts": _text(counts.T, "<i2"), "steps": floats(steps)}


def _text(values: np.ndarray, kind: str) -> str:
    return base64.b64encode(np.ascontiguousarray(values, dtype=kind).tobytes()).decode("ascii")
