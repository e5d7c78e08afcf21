"""Cut a log into recordings: at gaps, where time runs backwards, and where its last part is reserved for validation."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import pairwise
from math import floor
from pathlib import Path

import numpy as np
import numpy.typing as npt

from bench.basics.errors import BenchError
from bench.basics.files.table import HUGE, SUFFIXES
from bench.basics.plural import plural
from bench.dataset.names import Use
from bench.dataset.recording_faults import listed
from bench.dataset.sampling import FEWEST, cut_rows, gap_rows

Array = npt.NDArray[np.float64]
MOST = 5  # number of cuts of one kind that are reported individually
LITTLE = 0.05  # of a log: share that cutting at gaps may drop without a request
SHORTEST = 2.0  # s: shortest useful piece between gaps; filters discard samples at both ends


@dataclass(frozen=True, eq=False)
class Segment:
    """A recording to write: its file name, its columns, and the row of the log (0 is the first) at which it begins."""

    name: str
    use: Use
    columns: Mapping[str, Array]
    first_row: int = 0


@dataclass(frozen=True)
class Cutting:
    """How a log is cut. validate_fraction: the share at its end that is reserved for validation. shortest: s, the
    shortest piece between cuts that is kept; with None, a log is cut at gaps only if that drops little and time never
    runs backwards, otherwise it is not cut (and its check refuses it).
    """

    validate_fraction: float = 0.0
    shortest: float | None = None


UNCUT = Cutting()


def cut(
    file: Path, columns: Mapping[str, Array], use: Use, name: str, cutting: Cutting
) -> tuple[list[Segment], tuple[str, ...]]:
    """The recordings of a log, in order, and notes on what was cut and dropped.

    Raises BenchError for a name that is not a recording's file name, an invalid fraction, and if no piece remains.
    """
    path, fraction = Path(name), cutting.validate_fraction
    if path.suffix.lower() not in SUFFIXES or path.name != name:
        raise BenchError(f"{name}: a recording's name is a file name that ends in {' or '.join(SUFFIXES)}")
    if not 0.0 <= fraction < 1.0 or (fraction and use != "identify"):
        raise BenchError(
            f"{file}: a part of 0 to 1 of a log to identify can be reserved for validation, not {fraction:g}"
        )
    rows, twice = _written_once(columns)
    if cutting.shortest is None and _costs_little(columns["time"][rows]):
        cutting = replace(cutting, shortest=SHORTEST)
    lost = 0
    if cutting.shortest is not None:
        measured = _measured(columns)[rows]
        rows, lost = rows[measured], int(np.sum(~measured))
    columns = {key: column[rows] for key, column in columns.items()} if lost or twice else columns
    time = columns["time"]
    count = time.size
    apart = round(count * (1.0 - fraction)) if fraction else count
    cuts = [] if cutting.shortest is None else cut_rows(time).tolist()
    starts = sorted({0, *cuts, *([apart] if apart < count else [])})
    pieces = list(pairwise([*starts, count]))
    notes = (f"{plural(twice, 'row')} written twice omitted",) if twice else ()
    notes = (*notes, f"{plural(lost, 'row')} without a measurement omitted") if lost else notes
    if cuts and cutting.shortest is not None:
        whole = [piece for piece in pieces if _long_enough(time, *piece, cutting.shortest)]
        said = _note_on(time, cuts, pieces, whole, cutting.shortest)
        if not whole:
            raise BenchError(f"{file}: {said}: nothing remains{_shorter(time, pieces)}")
        notes = (*notes, said)
        pieces = whole
    parts = []
    for k, (first, end) in enumerate(pieces, start=1):
        number = f"-{k}" if cuts and len(pieces) > 1 else ""
        part_use: Use = "validate" if use == "validate" or first >= apart else "identify"
        kept_apart = "-validate" if part_use != use else ""
        values = {key: column[first:end] for key, column in columns.items()}
        parts.append(
            Segment(f"{path.stem}{number}{kept_apart}{path.suffix}", part_use, values, int(rows[first]))
        )
    return parts, notes


def _written_once(columns: Mapping[str, Array]) -> tuple[npt.NDArray[np.intp], int]:
    """The rows that do not repeat the previous one in all columns, time included, and the number of those that do."""
    again = np.all([column[1:] == column[:-1] for column in columns.values()], axis=0)
    rows = np.flatnonzero(np.append(True, ~again))
    return rows, columns["time"].size - rows.size


def _measured(columns: Mapping[str, Array]) -> npt.NDArray[np.bool_]:
    """Mask (N,) of the rows in which every needed column has a measurement."""
    needed = [columns[name] for name in columns if name.startswith(("time", "position.", "current."))]
    return np.all([np.abs(column) < HUGE for column in needed], axis=0)


def _costs_little(time: Array) -> bool:
    """Whether a log has gaps, and its sufficiently long pieces contain nearly all of its samples and nearly all of
    the time from the first such piece to the last: an isolated early first sample costs only itself.
    """
    if np.any(np.diff(time) <= 0.0) or not (gaps := gap_rows(time).tolist()):
        return False
    pieces = [piece for piece in pairwise([0, *gaps, time.size]) if _long_enough(time, *piece, SHORTEST)]
    if not pieces:
        return False
    samples = sum(end - first for first, end in pieces)
    seconds = sum(float(time[end - 1] - time[first]) for first, end in pieces)
    lasts = float(time[pieces[-1][1] - 1] - time[pieces[0][0]])
    return samples >= (1.0 - LITTLE) * time.size and seconds >= (1.0 - LITTLE) * lasts


def _long_enough(time: Array, first: int, end: int, shortest: float) -> bool:
    return end - first >= FEWEST and bool(time[end - 1] - time[first] >= shortest)


def _shorter(time: Array, pieces: list[tuple[int, int]]) -> str:
    """The cure if no piece is long enough; "" if none has enough samples."""
    lengths = [float(time[end - 1] - time[first]) for first, end in pieces if end - first >= FEWEST]
    return f"; --shortest {floor(1e2 * max(lengths)) / 1e2:g} keeps the longest" if lengths else ""


def _note_on(
    time: Array, cuts: list[int], pieces: list[tuple[int, int]], whole: list[tuple[int, int]], shortest: float
) -> str:
    gaps = [row for row in cuts if time[row] > time[row - 1]]
    back = [row for row in cuts if row not in gaps]
    lost = [f"{time[row] - time[row - 1]:.3g} s at {time[row - 1]:.12g} s" for row in gaps]
    turned = [f"{time[row - 1]:.12g} s to {time[row]:.12g} s" for row in back]
    parts = [f"at {plural(len(gaps), 'gap')} ({listed(lost, MOST)})"] if gaps else []
    parts += [f"where time runs backwards or stops ({listed(turned, MOST)})"] if back else []
    said = f"cut {' and '.join(parts)}"
    dropped = [piece for piece in pieces if piece not in whole]
    if not dropped:
        return f"{said}; no sample is dropped"
    seconds = sum(time[end - 1] - time[first] for first, end in dropped)
    samples = sum(end - first for first, end in dropped)
    pieces_said = plural(len(dropped), "piece")
    return (
        f"{said}; {pieces_said} shorter than {shortest:g} s or {FEWEST} samples dropped: {samples} of {time.size}"
        f" samples, {seconds:.3g} s"
    )
