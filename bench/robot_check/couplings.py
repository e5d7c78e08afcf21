"""Couplings as equations of joint positions, and those that contradict the joint ranges."""

from collections.abc import Iterable, Mapping

import numpy as np
from numpy.polynomial import Polynomial

from bench.model.geometry import Coupling, Geometry
from bench.robot_check.outcome import Equation, JointRange, RangeConflict

Span = tuple[float, float]


def equation_of(geometry: Geometry, coupling: Coupling) -> Equation:
    """The joints of both sides with their factors, and the polynomial between them."""
    first, second = (
        {geometry.joints[joint].name: factor for joint, factor in side}
        for side in (coupling.first, coupling.second)
    )
    return {
        "coupling": coupling.name,
        "first": first,
        "second": second,
        "polynomial": list(coupling.polynomial),
    }


def contradictions(geometry: Geometry, inside: Mapping[int, Span]) -> list[RangeConflict]:
    """Couplings that no positions satisfy. inside: by joint, the positions that count, in the tree's coordinates."""
    conflicts: list[RangeConflict] = []
    for coupling in geometry.couplings:
        first = _sum_of(coupling.first, inside)
        second = _image(coupling.polynomial, _sum_of(coupling.second, inside))
        if first[0] <= second[1] and second[0] <= first[1]:
            continue
        joints = (geometry.joints[joint] for joint, _ in (*coupling.first, *coupling.second))
        ranges: list[JointRange] = [
            {"joint": joint.name, "lower": joint.limits[0], "upper": joint.limits[1]}
            for joint in joints
            if joint.limits is not None
        ]
        conflicts.append({**equation_of(geometry, coupling), "ranges": ranges})
    return conflicts


def _sum_of(side: Iterable[tuple[int, float]], inside: Mapping[int, Span]) -> Span:
    """The values of one side of a coupling."""
    terms = [sorted(factor * end for end in inside.get(joint, (-np.inf, np.inf))) for joint, factor in side]
    return sum(low for low, _ in terms), sum(high for _, high in terms)


def _image(coefficients: tuple[float, ...], span: Span) -> Span:
    """The values of a polynomial, the coefficient of the lowest power first."""
    polynomial = Polynomial(coefficients or (0.0,)).trim()
    if polynomial.degree() == 0:
        return polynomial.coef[0], polynomial.coef[0]
    if not np.isfinite(span).all():
        return -np.inf, np.inf
    turning = polynomial.deriv().roots().real
    values = polynomial(np.clip([*span, *turning], *span))
    return float(values.min()), float(values.max())
