"""What effects may know of a recording, and of the model as it is at present."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from bench.effects import JointSignals, RobotSignals
from bench.estimate.measured import Measured
from bench.estimate.payload_parameters import payload_columns
from bench.model.geometry import Geometry
from bench.model.model import IdentificationModel
from bench.model.motion import motion_of
from bench.model.regressor import projected_regressor
from bench.payload import Payload


@dataclass(frozen=True)
class PresentModel:
    """The model that effects are linearised about.

    gains (n,) N*m or N per drive unit; base (nb,) base parameters; payloads: all ten standard parameters of
    each payload in the tool frame; declared: the known ones of them, the others zero; speeds (n,): RMS speed
    of every active joint over the fitted recordings.
    """

    gains: np.ndarray
    base: np.ndarray
    payloads: Mapping[str, np.ndarray]
    declared: Mapping[str, np.ndarray]
    speeds: np.ndarray


def declared_parameters(payloads: Mapping[str, Payload]) -> dict[str, np.ndarray]:
    """The known standard parameters (10,) of every payload, zero where unknown."""
    return {name: payload_columns(payload).known for name, payload in payloads.items()}


def robot_signals(model: IdentificationModel, measured: Measured, present: PresentModel) -> RobotSignals:
    """One recording as effects see it."""
    geometry = model.geometry
    payload = measured.recording.payload
    joints = {
        actuator.joint: JointSignals(
            time=measured.time - measured.time[0],
            position=measured.position[:, j],
            velocity=measured.velocity[:, j],
            acceleration=measured.acceleration[:, j],
            current=measured.current[:, j],
            gain=float(present.gains[j]),
            speed=float(present.speeds[j]),
            rate=measured.recording.rate,
        )
        for j, actuator in enumerate(geometry.robot.actuators)
    }

    def torque(
        position: np.ndarray,
        velocity: np.ndarray,
        acceleration: np.ndarray,
        *,
        gravity: np.ndarray | None = None,
        geometry: Geometry | None = None,
    ) -> np.ndarray:
        changed = model.geometry if geometry is None else geometry
        if gravity is not None:
            changed = replace(changed, gravity=gravity)
        tree = motion_of(changed, measured.time, position, velocity, acceleration)
        rows = projected_regressor(changed, tree, model.base.columns) @ present.base
        if payload is not None:
            loads = projected_regressor(changed, tree, model.payload_columns)
            rows = rows + loads @ (model.payload @ present.payloads[payload])
        return np.asarray(rows)

    if payload is None:
        carried = np.zeros_like(measured.current)
    else:
        loads = projected_regressor(geometry, measured.tree, model.payload_columns)
        carried = loads @ (model.payload @ present.declared[payload])
    return RobotSignals(joints, geometry, measured.tree, payload, carried, torque)
