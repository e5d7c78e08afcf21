"""Which motors' rotor inertias are parameters of their own, and which the bodies take up."""

from bench.model.base import BaseParameters
from bench.model.geometry import Geometry
from bench.model.regressor import rotor_columns
from bench.robot_check.report import Check


def check_rotors(geometry: Geometry, base: BaseParameters) -> Check:
    """A rotor turns with its motor alone: where no body's inertia can stand for it, it is identified itself."""
    kept = set(base.columns.tolist())
    own: list[str] = []
    others: list[str] = []
    for joint, column in zip(geometry.robot.driven, rotor_columns(geometry).tolist(), strict=True):
        (own if column in kept else others).append(joint)
    told = []
    if own:
        told.append(f"of {', '.join(own)} a base parameter of its own, Ia")
    if others:
        told.append(f"of {', '.join(others)} within a body's inertia")
    return Check("rotor inertia", "ok", "; ".join(told))
