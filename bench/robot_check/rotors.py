"""Which motors' rotor inertias are separate parameters, and which the bodies take up."""

from bench.model.base import BaseParameters
from bench.model.geometry import Geometry
from bench.model.regressor import rotor_columns
from bench.robot_check.outcome import Check, CheckCode


def check_rotors(geometry: Geometry, base: BaseParameters) -> Check:
    """A rotor turns with its motor alone: where no body's inertia can represent it, it is identified itself."""
    kept = set(base.columns.tolist())
    identified: list[str] = []
    within_bodies: list[str] = []
    for joint, column in zip(geometry.robot.driven, rotor_columns(geometry).tolist(), strict=True):
        (identified if column in kept else within_bodies).append(joint)
    return Check(CheckCode.ROTOR_INERTIA, "ok", {"identified": identified, "within_bodies": within_bodies})
