"""Signals of which every derivative is known, for tests of the effects' laws."""

from dataclasses import replace
from pathlib import Path

import numpy as np

from bench.dataset.recording import Recording
from bench.effects import JointSignals, RobotSignals
from bench.identification.effect_columns import PresentModel, robot_signals
from bench.identification.filtered import Measured
from bench.identification.standstill import no_gaps
from bench.model.geometry import Geometry
from bench.model.guess import guessed_parameters
from bench.model.model import IdentificationModel, build_model
from bench.model.motion import Motion, motion_of
from bench.model.regressor import projected_regressor
from bench.signals.settings import FilterSettings
from tests.mechanisms import movement, robot_named

RATE = 1000.0
PAYLOAD = np.array([0.5, 0.01, 0.02, 0.015, 2e-3, 1e-4, 3e-3, 2e-4, 1e-4, 2.5e-3])


def joint_signals(
    samples: int = 4000, rotates: bool = True, band: float = 40.0, duration: float | None = None
) -> JointSignals:
    """A hinge or slide that swings with two frequencies; smooth current of another shape."""
    time = np.arange(samples) / RATE if duration is None else np.linspace(0.0, duration, samples)
    position, velocity, acceleration = (np.zeros(samples) for _ in range(3))
    for size, rate, phase in ((0.6, 3.0, 0.2), (0.15, 9.1, 1.1)):
        position += size * np.sin(rate * time + phase)
        velocity += size * rate * np.cos(rate * time + phase)
        acceleration -= size * rate**2 * np.sin(rate * time + phase)
    current = 0.8 * np.sin(5.0 * time + 0.4) + 0.3 * np.cos(11.0 * time)
    rate = (samples - 1) / (time[-1] - time[0])
    needed = 2.5 * current
    return JointSignals(
        time=time,
        position=position,
        velocity=velocity,
        acceleration=acceleration,
        current=current,
        gain=2.5,
        speed=float(np.sqrt((velocity**2).mean())),
        rate=rate,
        band=band,
        rotates=rotates,
        needs=lambda: needed,
    )


def still(joint: JointSignals) -> JointSignals:
    """The same joint at rest, at the same load."""
    zero = np.zeros(len(joint.time))
    return replace(joint, position=zero + 0.3, velocity=zero, acceleration=zero)


def moving_robot(
    name: str, folder: Path, payload: str | None = None, samples: int = 1501, size: float = 0.15
) -> tuple[RobotSignals, IdentificationModel, Measured, PresentModel]:
    """A robot, or one of the mechanisms, along a smooth movement that is known exactly; guessed masses."""
    model = build_model(robot_named(name, folder))
    time, *active = movement(model.geometry, samples=samples, duration=(samples - 1) / RATE, size=size)
    n = active[0].shape[1]
    current = 0.5 + np.sin(3.0 * time[:, None] + np.arange(n))
    extra = model.geometry.robot.redundant
    given = np.cos(2.0 * time[:, None] + np.arange(len(extra))) if extra else None
    logged = Recording("movement.csv", "identify", payload, time, active[0], current, redundant=given)
    tree = motion_of(model.geometry, time, *active)
    measured = Measured(
        recording=replace(logged, time=time),
        settings=FilterSettings(position_cutoff=100.0, decimation=20),
        time=time,
        position=active[0],
        velocity=active[1],
        acceleration=active[2],
        current=current,
        tree=tree,
        gaps=no_gaps(n),
    )
    payloads = {} if payload is None else {payload: PAYLOAD}
    present = PresentModel(
        gains=np.linspace(2.0, 3.0, n),
        base=model.base.grouping @ guessed_parameters(model.geometry),
        payloads=payloads,
        declared=payloads,
        speeds=np.sqrt((np.hstack((active[1], tree.v[:, model.geometry.redundant])) ** 2).mean(axis=0)),
        redundant_gains=np.array([one.gain for one in extra]),
    )
    return robot_signals(model, measured, present), model, measured, present


def rigid_torque(
    model: IdentificationModel, present: PresentModel, geometry: Geometry, tree: Motion
) -> np.ndarray:
    """The present model's torque without payload, (N, n)."""
    return projected_regressor(geometry, tree, model.base.columns) @ present.base
