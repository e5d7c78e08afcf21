"""What a physical parameter set is drawn towards where the data leave it open: CAD values, or equal bars."""

from dataclasses import dataclass

import mujoco
import numpy as np

from bench.dataset.robot_mjcf import ROTOR
from bench.export.pseudo_inertia import pseudo_inertia, standard_parameters
from bench.model.geometry import Geometry, Placement
from bench.model.guess import guessed_parameters
from bench.model.regressor import moved_parameters

SLENDER = (
    1e-4  # of a body's longest extent squared: a body thinner than its hundredth is taken to be that thick
)


@dataclass(frozen=True)
class Prior:
    """Standard parameters (10 a joint of the geometry) and inertias of rotors (n,), kg m2 or kg.

    source: where they are from, in words. guessed: bodies for which the MJCF has no mass.
    """

    parameters: np.ndarray
    rotors: np.ndarray
    source: str
    guessed: tuple[str, ...] = ()


def geometric_prior(geometry: Geometry) -> Prior:
    """Equal bars from joint to joint; no mass is read. Their common mass is for the data to scale."""
    return Prior(guessed_parameters(geometry), np.zeros(len(geometry.active)), "bars from joint to joint")


def cad_prior(geometry: Geometry) -> Prior:
    """The masses of the MJCF, of welded bodies together with those that carry them; bars where it has none."""
    compiled = geometry.robot.mjcf_model()
    parameters = np.zeros(10 * len(geometry.joints))
    for body in range(1, compiled.nbody):
        name = mujoco.mj_id2name(compiled, mujoco.mjtObj.mjOBJ_BODY, body) or f"body_{body}"
        joint, place = geometry.body_frames[name]
        if joint >= 0 and not name.startswith(ROTOR):
            parameters[10 * joint : 10 * joint + 10] += _of_body(compiled, body, place)
    bars, guessed = guessed_parameters(geometry), []
    heaviest = max((parameters[10 * joint] for joint, _ in geometry.bodies), default=0.0)
    for joint, name in geometry.bodies:
        of_body = slice(10 * joint, 10 * joint + 10)
        if parameters[of_body][0] <= 0.0:
            guessed.append(name)
            parameters[of_body] = bars[of_body] * (0.1 * heaviest if heaviest else 1.0)
        else:
            parameters[of_body] = _solid(parameters[of_body])
    armature = compiled.dof_armature
    rotors = np.array([float(armature[compiled.joint(joint).dofadr[0]]) for joint in geometry.robot.driven])
    return Prior(parameters, rotors, "masses of the MJCF", tuple(guessed))


def scaled_to(prior: Prior, grouping: np.ndarray, base: np.ndarray, weights: np.ndarray) -> Prior:
    """The prior with all masses times the one factor that brings it nearest to base parameters (nb,)."""
    weighted, wanted = weights * (grouping @ prior.parameters), weights * base
    factor = float(weighted @ wanted) / float(weighted @ weighted) if weighted.any() else 1.0
    if factor <= 0.0:
        return prior
    return Prior(factor * prior.parameters, prior.rotors, prior.source, prior.guessed)


def _of_body(compiled: mujoco.MjModel, body: int, place: Placement) -> np.ndarray:
    """Standard parameters (10,) of one body of the file, in the frame of the joint that moves it."""
    rotation = np.empty(9)
    mujoco.mju_quat2Mat(rotation, compiled.body_iquat[body])
    x, y, z = compiled.body_inertia[body]
    principal = np.array([compiled.body_mass[body], 0.0, 0.0, 0.0, x, 0.0, y, 0.0, 0.0, z])
    parameters = moved_parameters(principal, rotation.reshape(3, 3), compiled.body_ipos[body])
    return moved_parameters(parameters, place.rotation, place.translation)


def _solid(parameters: np.ndarray) -> np.ndarray:
    """The same body, at least a hundredth as thick as it is long: a point or a rod has no volume to compare with."""
    matrix = pseudo_inertia(parameters)
    mass = matrix[3, 3]
    center = matrix[:3, 3] / mass
    spread = matrix[:3, :3] - mass * np.outer(center, center)
    extents, axes = np.linalg.eigh(0.5 * (spread + spread.T))
    longest = max(float(extents[-1]), mass * SLENDER * float(center @ center), mass * SLENDER**2)
    spread = (axes * np.maximum(extents, SLENDER * longest)) @ axes.T
    matrix[:3, :3] = spread + mass * np.outer(center, center)
    return standard_parameters(matrix)
