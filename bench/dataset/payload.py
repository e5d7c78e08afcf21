"""A payload: the body fixed to the tool during a recording, and its known parameters."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

FAR = 10.0  # m: a centre of mass farther away, or a larger radius of gyration, is in the wrong unit


@dataclass(frozen=True, eq=False)
class Payload:
    """A body fixed to the tool site. Values that are None are unknown and estimated.

    - `mass`: kg
    - `center_of_mass`: (3,) m, in the tool frame
    - `inertia`: (6,) kg·m², Ixx Iyy Izz Ixy Ixz Iyz at the payload's centre of mass, tool axes
    """

    name: str
    mass: float | None = None
    center_of_mass: npt.NDArray[np.float64] | None = None
    inertia: npt.NDArray[np.float64] | None = None


def inertia_matrix(inertia: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """The symmetric (3, 3) matrix of (6,) Ixx Iyy Izz Ixy Ixz Iyz."""
    xx, yy, zz, xy, xz, yz = inertia
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def payload_fault(payload: Payload) -> tuple[str, str] | None:
    """The key and the reason why no rigid body can have these values; None if one can.

    A rigid body has a positive mass and principal moments that are not negative, of which none exceeds the sum of the
    other two (the triangle inequality). Zero moments, of a thin rod or a point mass, are accepted.
    """
    mass, center = payload.mass, payload.center_of_mass
    if mass is not None and not mass > 0.0:
        return "mass", f"must be positive, not {mass:g} kg"
    if center is not None and np.linalg.norm(center) > FAR:
        return "center_of_mass", f"lies {np.linalg.norm(center):g} m from the tool: metres are expected"
    fault = None if payload.inertia is None else _inertia_fault(payload.inertia, mass)
    return None if fault is None else ("inertia", fault)


def _inertia_fault(inertia: npt.NDArray[np.float64], mass: float | None) -> str | None:
    low, middle, high = np.linalg.eigvalsh(inertia_matrix(inertia)).tolist()
    slack = 1e-9 * max(abs(low), abs(high), 1e-12)
    if low < -slack:
        return f"is not positive: its smallest principal moment is {low:.3g} kg*m^2"
    if high > low + middle + slack:
        return (
            f"breaks the triangle inequality: principal moment {high:.3g} kg*m^2 exceeds the sum of the"
            f" others, {low:.3g} + {middle:.3g}"
        )
    if mass is not None and high > mass * FAR**2:
        return f"of {high:.3g} kg*m^2 cannot belong to {mass:g} kg: kg*m^2 are expected"
    return None
