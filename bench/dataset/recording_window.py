"""The used parts of a recording: `window` and `exclude` of dataset.toml, in the log's time."""

from dataclasses import dataclass, replace
from itertools import pairwise
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
import numpy.typing as npt
from pydantic import BeforeValidator

from bench.basics.errors import BenchError
from bench.dataset.sampling import FEWEST

if TYPE_CHECKING:
    from bench.basics.files.table import FileTable


def _spans(value: Any) -> tuple[tuple[float, float], ...]:
    """[start, end] or several of them, sorted. Raises ValueError for anything else, and for stretches that overlap."""
    several = value if isinstance(value, list | tuple) and value and _is_list(value[0]) else [value]
    spans = []
    for span in several:
        numbers = _is_list(span) and all(isinstance(x, int | float) and not isinstance(x, bool) for x in span)
        if not numbers or len(span) != 2 or not np.isfinite(span).all():
            raise ValueError("should be [start, end] in seconds, or several of them")
        if not span[0] < span[1]:
            raise ValueError(f"[{span[0]:.12g}, {span[1]:.12g}] does not start before it ends")
        spans.append((float(span[0]), float(span[1])))
    spans.sort()
    for (a, b), (c, d) in pairwise(spans):
        if c < b:
            raise ValueError(f"[{a:.12g}, {b:.12g}] and [{c:.12g}, {d:.12g}] overlap")
    return tuple(spans)


def _is_list(value: object) -> bool:
    return isinstance(value, list | tuple)


Spans = Annotated[tuple[tuple[float, float], ...], BeforeValidator(_spans)]
"""Stretches (start, end), s, in rising order and without overlap."""


@dataclass(frozen=True)
class Window:
    """The used parts (empty: all of the recording) and the excluded parts, both ends included."""

    used: tuple[tuple[float, float], ...] = ()
    left_out: tuple[tuple[float, float], ...] = ()

    def parts(self, table: "FileTable") -> "list[FileTable]":
        """The used rows, one table for each contiguous stretch; the whole table if nothing is cut.

        Raises BenchError if a stretch has too few samples, or a given window or exclusion contains none.
        """
        if not self.used and not self.left_out:
            return [table]
        time = table.stamps()
        if not np.isfinite(time).any():
            return [table]  # the check of the time column reports its fault
        first, last = float(np.nanmin(time)), float(np.nanmax(time))
        for name, spans in (("window", self.used), ("exclude", self.left_out)):
            for start, end in spans:
                if not ((time >= start) & (time <= end)).any():
                    raise BenchError(
                        f"{table.path}: {name} [{start:.12g}, {end:.12g}]: no sample is there; time runs from "
                        f"{first:.12g} to {last:.12g} s"
                    )
        return [_part(table, *stretch) for stretch in self._stretches(time, first, last)]

    def _stretches(
        self, time: npt.NDArray[np.float64], first: float, last: float
    ) -> list[tuple[float, float, npt.NDArray[np.bool_]]]:
        """Start, end and mask of the stamps (N,) of each stretch."""
        stretches = []
        for start, end in self.used or ((first, last),):
            inside = (time >= start) & (time <= end)
            cuts = [pair for pair in self.left_out if pair[1] >= start and pair[0] <= end]
            edges = [start, *(x for cut in cuts for x in cut), end]
            for i in range(0, len(edges), 2):
                chosen = inside & (time >= edges[i]) & (time <= edges[i + 1])
                for a, b in cuts:
                    chosen &= ~((time >= a) & (time <= b))
                if chosen.any():
                    stretches.append((edges[i], edges[i + 1], chosen))
        return stretches


WHOLE = Window()


def _part(table: "FileTable", start: float, end: float, chosen: npt.NDArray[np.bool_]) -> "FileTable":
    """The rows from the first to the last in the mask `chosen` (N,): rows between them are checked, not omitted."""
    rows = np.flatnonzero(chosen)
    if len(rows) < FEWEST:
        raise BenchError(
            f"{table.path}: only {len(rows)} samples are used between {start:.12g} and {end:.12g} s, at least {FEWEST} "
            "are needed: use more of it, or exclude it, too"
        )
    begin, stop = int(rows[0]), int(rows[-1]) + 1
    return replace(table, data=table.data.slice(begin, stop - begin), first_row=table.first_row + begin)
