"""Base parameters: the fewest parameters from which the model can be calculated (equation 7).

Found numerically by a QR factorisation of the regressor at random noise-free states (Gautier 1991, "Numerical
calculation of the base inertial parameters of robots").
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from bench.basics.errors import BenchError
from bench.model.geometry import Geometry
from bench.model.regressor import body_columns, parameter_names, projected_regressor, rotor_columns
from bench.model.states import random_motion

SEED = 20120601  # of the states; fixed, so that a robot's base parameters never depend on data
DEPENDENT = 1e-5  # of a column's norm: what is smaller beside the columns before it cannot be measured
NEGLIGIBLE = 1e-8
KEPT = 16  # geometries whose base parameters stay in memory


@dataclass(frozen=True)
class BaseParameters:
    """chi of equation 7 and how each groups standard parameters.

    columns (nb,): the columns of `projected_regressor` that remain, those of rotors last. grouping (nb, p_all) and
    rotors (nb, n): base parameters from all standard parameters of the tree and from the inertias of the motors'
    rotors, chi = grouping @ chi_st + rotors @ Ia. names, units, descriptions: nb each.
    """

    columns: np.ndarray
    grouping: np.ndarray
    rotors: np.ndarray
    names: tuple[str, ...]
    units: tuple[str, ...]
    descriptions: tuple[str, ...]


@lru_cache(maxsize=KEPT)
def base_parameters(geometry: Geometry) -> BaseParameters:
    """The base parameters of a robot; geometry alone decides them.

    Of dependent columns the first stay: free bodies (platforms) come first, then bodies from the base
    outwards, then the rotors, of which those remain that no body's inertia can stand for.
    """
    free = [i for i, joint in enumerate(geometry.joints) if joint.kind == "free"]
    candidates = np.concatenate([*(np.arange(10 * i, 10 * i + 10) for i in free), body_columns(geometry)])
    candidates = candidates[np.sort(np.unique(candidates, return_index=True)[1])]
    count = max(40, 3 * len(candidates) // len(geometry.active))
    motion = random_motion(geometry, count, SEED)
    if len(motion.time) < count // 4:
        raise BenchError(
            f"robot {geometry.robot.name}: only {len(motion.time)} of {count} random poses inside the joint "
            "ranges can be reached from home without a singularity; check home and the joint ranges"
        )
    rows = projected_regressor(geometry, motion, candidates).reshape(-1, len(candidates))
    kept, dependence = independent_columns(rows)
    own = rotor_columns(geometry)
    turning = projected_regressor(geometry, motion, own).reshape(-1, len(own))
    alone, rotors = _beside(rows[:, kept], turning)
    grouping = np.zeros((len(kept) + len(alone), 10 * len(geometry.joints)))
    grouping[: len(kept), candidates] = dependence
    columns = np.concatenate((candidates[kept], own[alone]))
    names = parameter_names(geometry)
    whole = np.hstack((grouping, rotors))
    return BaseParameters(
        columns=columns,
        grouping=grouping,
        rotors=rotors,
        names=tuple(names[column][0] for column in columns),
        units=tuple(names[column][1] for column in columns),
        descriptions=tuple(
            _description(row, int(column), names) for row, column in zip(whole, columns, strict=True)
        ),
    )


def _beside(rows: np.ndarray, others: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Which of other columns (r, n) are independent of the independent rows (r, b), and how the rest follow.

    Returns the indices (a,) of the first and the dependence (b + a, n) of all on rows and them.
    """
    kept, dependence = independent_columns(np.hstack((rows, others)))
    b = rows.shape[1]
    return kept[kept >= b] - b, dependence[:, b:]


def independent_columns(rows: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Which columns of rows (r, p) are independent of those before them, and how the others follow.

    Returns the indices (b,) kept and the dependence (b, p) with rows = rows[:, kept] @ dependence. A column counts
    as dependent where less than DEPENDENT of it is its own, and as zero beside a column that is so much larger: a
    planar robot is drawn a little out of its plane, and the parameters of that slack are none.
    """
    norms = np.linalg.norm(rows, axis=0)
    present = np.flatnonzero(norms > DEPENDENT * norms.max())
    scaled = rows[:, present] / norms[present]
    kept: list[int] = []
    basis = np.zeros((rows.shape[0], 0))
    for place, column in enumerate(scaled.T):
        remainder = column - basis @ (basis.T @ column)
        remainder -= basis @ (basis.T @ remainder)
        size = float(np.linalg.norm(remainder))
        if size > DEPENDENT:
            kept.append(place)
            basis = np.hstack((basis, (remainder / size)[:, None]))
    coefficients = np.linalg.lstsq(scaled[:, kept], scaled)[0]
    coefficients[np.abs(coefficients) < NEGLIGIBLE] = 0.0
    dependence = np.zeros((len(kept), rows.shape[1]))
    dependence[:, present] = coefficients * norms[present] / norms[present[kept]][:, None]
    dependence[np.arange(len(kept)), present[kept]] = 1.0
    return present[kept], dependence


def _description(row: np.ndarray, own: int, names: list[tuple[str, str]]) -> str:
    terms = []
    for column in (own, *(int(column) for column in np.flatnonzero(row) if column != own)):
        factor, symbol = row[column], names[column][0]
        sign = "-" if factor < 0 else "+"
        size = "" if abs(abs(factor) - 1.0) < NEGLIGIBLE else f"{abs(factor):.6g} "
        terms.append(f"{sign} {size}{symbol}")
    return " ".join(terms).removeprefix("+ ")
