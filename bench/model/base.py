"""Base parameters: the smallest set of parameters that determines the model (equation 7).

Determined by a QR factorisation of the regressor at random noise-free states (Gautier 1991, "Numerical calculation of
the base inertial parameters of robots").
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from bench.basics.errors import BenchError
from bench.basics.sentence import and_list
from bench.model.bounds import MEMORY, RANKS
from bench.model.cures import driven_parts, narrower_ranges, range_in_words
from bench.model.geometry import Geometry
from bench.model.regressor import body_columns, parameter_names, projected_regressor, rotor_columns
from bench.model.states import active_ranges, random_motion


class UndecidedRankError(BenchError):
    """No gap of the singular values decides the rank; columns: those in doubt."""

    def __init__(self, columns: np.ndarray) -> None:
        super().__init__(
            f"no gap of the singular values decides whether columns {columns.tolist()} are independent"
        )
        self.columns = columns


@dataclass(frozen=True)
class IndependentColumns:
    """kept (b,): indices of the independent columns. dependence (b, p): matrix = matrix[:, kept] @ dependence.
    neglected: the largest share of the matrix that counts as slack of a drawing; 0 if the rest is rounding.
    """

    kept: np.ndarray
    dependence: np.ndarray
    neglected: float


def independent_columns(rows: np.ndarray, least: int = 0) -> IndependentColumns:
    """Columns of rows (r, p) that are independent of those before them, at least `least`, and how the others follow.

    Rows are scaled to equal length: rows near a singular pose are a million times larger. With columns of unit length,
    the rank is where the singular values fall by a gap to less than the slack; likewise a column counts as zero after
    such a gap of the columns' sizes: a planar robot is drawn slightly out of its plane, and this slack gives no
    parameters. Raises UndecidedRankError if no gap decides.
    """
    rows = _rows_alike(rows)
    norms = np.linalg.norm(rows, axis=0)
    large = _rank(np.sort(norms)[::-1])
    present = np.sort(np.argsort(-norms, kind="stable")[:large])
    scaled = rows[:, present] / norms[present]
    _, values, directions = np.linalg.svd(scaled, full_matrices=False)
    rank = _rank(values, least)
    if rank and values[rank - 1] < RANKS.rounding * values[0]:
        raise UndecidedRankError(present[np.abs(directions[rank - 1]) > RANKS.coefficient])
    slack = float((values[rank:] / values[rank - 1 : rank]).max(initial=0.0))
    directions = directions[:rank]
    kept = _first_independent(directions, max(RANKS.clear, RANKS.gap * slack))
    coefficients = np.linalg.solve(directions[:, kept], directions)
    coefficients[np.abs(coefficients) < RANKS.coefficient] = 0.0
    dependence = np.zeros((rank, rows.shape[1]))
    dependence[:, present] = coefficients * norms[present] / norms[present[kept]][:, None]
    dependence[np.arange(rank), present[kept]] = 1.0
    absent = np.delete(norms, present)
    neglected = max(
        (values[rank:] / values[:1]).max(initial=0.0),
        absent.max(initial=0.0) / (norms.max(initial=0.0) or 1.0),
    )
    return IndependentColumns(
        present[kept], dependence, float(neglected) if neglected > RANKS.rounding else 0.0
    )


def _first_independent(columns: np.ndarray, least: float) -> list[int]:
    """Indices of the first r columns (r, p) that are independent of those before them; r is their rank.

    A column with an independent part below `least` counts only if there are not enough others.
    """
    while True:
        kept: list[int] = []
        basis = np.zeros((columns.shape[0], 0))
        sizes = np.zeros(columns.shape[1])
        for place, column in enumerate(columns.T):
            remainder = column - basis @ (basis.T @ column)
            remainder -= basis @ (basis.T @ remainder)
            sizes[place] = np.linalg.norm(remainder)
            if sizes[place] >= least and len(kept) < len(columns):
                kept.append(place)
                basis = np.hstack((basis, (remainder / sizes[place])[:, None]))
        if len(kept) == len(columns):
            return kept
        least = float(np.delete(sizes, kept).max())


def _rows_alike(rows: np.ndarray) -> np.ndarray:
    """Rows (r, p) of unit length, columns of any unit count alike."""
    norms = np.linalg.norm(rows, axis=0)
    sizes = np.linalg.norm(rows / np.where(norms > 0.0, norms, 1.0), axis=1)
    return np.asarray(rows / np.where(sizes > 0.0, sizes, 1.0)[:, None])


def _rank(values: np.ndarray, least: int = 0) -> int:
    """Number of descending values (k,) before the first gap to less than the slack, at least `least`."""
    below = values[1:] < RANKS.slack * values[:1]
    gaps = np.flatnonzero(below & (values[:-1] > RANKS.gap * values[1:])) + 1
    gaps = gaps[gaps >= least]
    return int(gaps[0]) if len(gaps) else int(np.count_nonzero(values))


SEEDS = (20120601, 20120603)  # of two sets of states; fixed, so that base parameters never depend on data


@dataclass(frozen=True)
class BaseParameters:
    """chi of equation 7 and how each groups standard parameters.

    columns (nb,): the columns of `projected_regressor` that remain, those of rotors last. grouping (nb, p_all) and
    rotors (nb, n): base parameters from all standard parameters of the tree and from the inertias of the motors'
    rotors, chi = grouping @ chi_st + rotors @ Ia. names, units, descriptions: nb each. neglected: largest share of the
    regressor that counts as slack of a drawing, 0 if all smaller shares are rounding.
    """

    columns: np.ndarray
    grouping: np.ndarray
    rotors: np.ndarray
    names: tuple[str, ...]
    units: tuple[str, ...]
    descriptions: tuple[str, ...]
    neglected: float


@lru_cache(maxsize=MEMORY.geometries)
def base_parameters(geometry: Geometry) -> BaseParameters:
    """The base parameters of a robot; geometry alone decides them.

    Of dependent columns the first stay: free bodies (platforms) come first, then bodies from the base outwards, then
    the rotors, of which those remain that no body's inertia can represent. The rank is at the first gap of the singular
    values that two sets of states share. Raises BenchError, naming the bodies, if there is none.
    """
    free = [i for i, joint in enumerate(geometry.joints) if joint.kind == "free"]
    bodies = np.concatenate([*(np.arange(10 * i, 10 * i + 10) for i in free), body_columns(geometry)])
    bodies = bodies[np.sort(np.unique(bodies, return_index=True)[1])]
    candidates = np.concatenate((bodies, rotor_columns(geometry)))
    names = parameter_names(geometry)
    first, second = (_independent_at(geometry, candidates, names, seed) for seed in SEEDS)
    most = max(len(first.kept), len(second.kept))
    first, second = (
        columns if len(columns.kept) == most else _independent_at(geometry, candidates, names, seed, most)
        for columns, seed in zip((first, second), SEEDS, strict=True)
    )
    if len(first.kept) != len(second.kept):
        raise _undecided(geometry, names, candidates[np.setxor1d(first.kept, second.kept)])
    whole = np.zeros((len(first.kept), len(names)))
    whole[:, candidates] = first.dependence
    columns = candidates[first.kept]
    return BaseParameters(
        columns=columns,
        grouping=whole[:, : 10 * len(geometry.joints)],
        rotors=whole[:, 10 * len(geometry.joints) :],
        names=tuple(names[column][0] for column in columns),
        units=tuple(names[column][1] for column in columns),
        descriptions=tuple(
            _description(row, int(column), names) for row, column in zip(whole, columns, strict=True)
        ),
        neglected=max(first.neglected, second.neglected),
    )


def _independent_at(
    geometry: Geometry, candidates: np.ndarray, names: list[tuple[str, str]], seed: int, least: int = 0
) -> IndependentColumns:
    """`independent_columns` of the candidates at random states, at least `least`. Raises BenchError if these do not
    decide.
    """
    count = max(40, 3 * len(candidates) // len(geometry.active))
    motion = random_motion(geometry, count, seed)
    if len(motion.time) < count // 4:
        raise BenchError(
            f"robot {geometry.robot.name}: only {len(motion.time)} of {count} random poses inside the joint "
            f"ranges can be reached from home without a singularity; check home{_ranges_to_check(geometry)}"
        )
    rows = projected_regressor(geometry, motion, candidates).reshape(-1, len(candidates))
    try:
        return independent_columns(rows, least)
    except UndecidedRankError as error:
        raise _undecided(geometry, names, candidates[error.columns]) from None


def _ranges_to_check(geometry: Geometry) -> str:
    """The motors' joints and tendons without a range, for which a wide one is assumed; the ranges, if all have one."""
    low, high = active_ranges(geometry)
    wide = [
        f"{range_in_words(joint.name, drives)} "
        f"({high[i] - low[i]:.3g} {'m' if joint.kind == 'slide' else 'rad'} are assumed)"
        for i, (joint, drives) in enumerate(
            zip(geometry.active_joints, driven_parts(geometry.robot).values(), strict=True)
        )
        if joint.limits is None
    ]
    return f", and give a range in the MJCF to {and_list(wide)}" if wide else " and the joint ranges"


def _undecided(geometry: Geometry, names: list[tuple[str, str]], columns: np.ndarray) -> BenchError:
    symbols = ", ".join(names[column][0] for column in columns.tolist())
    return BenchError(
        f"robot {geometry.robot.name}: whether {symbols} are base parameters is not decided by random states: no gap "
        f"of the singular values sets them apart from rounding; {narrower_ranges(driven_parts(geometry.robot))}"
    )


def _description(row: np.ndarray, leading: int, names: list[tuple[str, str]]) -> str:
    terms = []
    for column in (leading, *(int(column) for column in np.flatnonzero(row) if column != leading)):
        factor, symbol = row[column], names[column][0]
        sign = "-" if factor < 0 else "+"
        size = "" if abs(abs(factor) - 1.0) < RANKS.coefficient else f"{abs(factor):.6g} "
        terms.append(f"{sign} {size}{symbol}")
    return " ".join(terms).removeprefix("+ ")
