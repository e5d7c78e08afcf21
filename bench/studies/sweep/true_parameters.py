"""What a perfect identification would find: the truth in terms of the model's parameters."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from bench.model.model import IdentificationModel
from bench.model.regressor import moved_parameters, projected_regressor
from bench.model.states import random_motion

SEED = 20120605
STATES = 80


def true_base_parameters(model: IdentificationModel, truth: Mapping[str, Any]) -> np.ndarray:
    """Base parameters (nb,) of the simulated machine, from the contents of its truth file.

    Bodies fixed to others count with them; rotor inertias (armature) appear in the base parameters that take
    them up, found by least squares at random noise-free states.
    """
    geometry = model.geometry
    standard = np.zeros(10 * len(geometry.joints))
    for name, body in truth["bodies"].items():
        if name not in geometry.body_frames:
            continue
        carrier, frame = geometry.body_frames[name]
        if carrier >= 0:
            standard[10 * carrier : 10 * carrier + 10] += moved_parameters(
                _standard(body), frame.rotation, frame.translation
            )
    motion = random_motion(geometry, STATES, SEED)
    torque = projected_regressor(geometry, motion) @ standard
    for joint in geometry.joints:
        armature = truth["joints"].get(joint.name, {}).get("armature", 0.0)
        if armature:
            torque += motion.jacobian[:, joint.v.start] * (armature * motion.a[:, joint.v.start])[:, None]
    rows = projected_regressor(geometry, motion, model.base.columns)
    scale = np.linalg.norm(rows.reshape(-1, rows.shape[2]), axis=0)
    solution = np.linalg.lstsq(rows.reshape(-1, rows.shape[2]) / scale, torque.reshape(-1))[0]
    return np.asarray(solution / scale)


def _standard(body: Mapping[str, Any]) -> np.ndarray:
    """Standard parameters (10,) about the body frame's origin, from mass, centre of mass and central inertia."""
    xx, yy, zz, xy, xz, yz = body["inertia"]
    central = np.array([0.0, 0.0, 0.0, 0.0, xx, xy, yy, xz, yz, zz])
    mass = np.zeros(10)
    mass[0] = body["mass"]
    shifted = moved_parameters(mass, np.eye(3), np.asarray(body["center_of_mass"], dtype=float))
    return central + shifted


def true_values(model: IdentificationModel, truth: Mapping[str, Any]) -> dict[str, float]:
    """True drive gains by joint and base parameters by name, for comparison with an identification."""
    values = {joint: float(gain["true"]) for joint, gain in truth["drive_gains"].items()}
    names = model.base.names
    return values | dict(zip(names, map(float, true_base_parameters(model, truth)), strict=True))
