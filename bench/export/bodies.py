"""Linear equations of identified parameters for the bodies' standard parameters, and priors for the rest."""

from dataclasses import dataclass

import mujoco
import numpy as np

from bench.dataset.payload import Payload
from bench.dataset.robot_mjcf import ROTOR
from bench.export.identified import IdentifiedModel
from bench.identification.layout import payload_columns
from bench.model.base import independent_columns
from bench.model.geometry import Geometry, Placement, rotation_matrix
from bench.model.guess import guessed_parameters
from bench.model.regressor import moved_parameters
from bench.model.supported import label_of

SLENDER = 1e-4  # of a body's squared longest extent: a body thinner than a hundredth counts as that thick
INERTIA = np.array([[4, 5, 7], [5, 6, 8], [7, 8, 9]])  # places of I (3, 3) among standard parameters (10,)
LOAD = "payload "  # what the names of payloads begin with, among those of bodies


def pseudo_inertia(parameters: np.ndarray) -> np.ndarray:
    """P (4, 4) of standard parameters (10,)."""
    inertia = parameters[INERTIA]
    square = 0.5 * np.trace(inertia) * np.eye(3) - inertia
    first = parameters[1:4, None]
    return np.block([[square, first], [first.T, parameters[:1]]])


def standard_parameters(matrix: np.ndarray) -> np.ndarray:
    """Standard parameters (10,) of P (4, 4); linear in P."""
    square = matrix[:3, :3]
    inertia = np.trace(square) * np.eye(3) - square
    return np.concatenate(([matrix[3, 3]], matrix[:3, 3], inertia[[0, 0, 1, 0, 1, 2], [0, 1, 1, 2, 2, 2]]))


def from_scaled(root: np.ndarray) -> np.ndarray:
    """(10, 16): standard parameters for the entries, row by row, of symmetric Q with P = root Q root'."""
    columns = np.empty((10, 16))
    for place, unit in enumerate(np.eye(16)):
        entry = unit.reshape(4, 4)
        columns[:, place] = standard_parameters(root @ (0.5 * (entry + entry.T)) @ root.T)
    return columns


def about_center(parameters: np.ndarray) -> tuple[float, np.ndarray, np.ndarray]:
    """Mass kg, centre of mass (3,) m in the frame, and inertia (3, 3) kg m2 about it in the frame's axes.

    A body without mass has its centre at the origin.
    """
    mass = float(parameters[0])
    center = parameters[1:4] / mass if mass else np.zeros(3)
    square = float(center @ center) * np.eye(3) - np.outer(center, center)
    return mass, center, parameters[INERTIA] - mass * square


@dataclass(frozen=True)
class Prior:
    """Standard parameters (10 a joint of the geometry) and inertias of rotors (n,), kg m2 or kg.

    source: of the values, in words. guessed: bodies without a mass in the MJCF.
    """

    parameters: np.ndarray
    rotors: np.ndarray
    source: str
    guessed: tuple[str, ...] = ()


def cad_prior(geometry: Geometry) -> Prior:
    """The masses of the MJCF, welded bodies merged with those that carry them; bars if it has none."""
    compiled = geometry.robot.mjcf_model()
    parameters = np.zeros(10 * len(geometry.joints))
    for body in range(1, compiled.nbody):
        name = label_of(compiled, mujoco.mjtObj.mjOBJ_BODY, body)
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


def _scaled_bars(identified: IdentifiedModel) -> Prior:
    """Equal bars from joint to joint, without any mass of the MJCF, with the common mass that brings them nearest to
    the base parameters.
    """
    geometry = identified.model.geometry
    bars = guessed_parameters(geometry)
    std = np.sqrt(np.maximum(np.diag(identified.covariance), 0.0))[: len(identified.base)]
    weights = np.divide(1.0, std, out=np.zeros_like(std), where=std > 0.0)
    weighted, wanted = weights * (identified.model.base.grouping @ bars), weights * identified.base
    factor = float(weighted @ wanted) / float(weighted @ weighted) if weighted.any() else 1.0
    scaled = factor * bars if factor > 0.0 else bars
    return Prior(scaled, np.zeros(len(geometry.active)), "bars from joint to joint")


def _of_body(compiled: mujoco.MjModel, body: int, place: Placement) -> np.ndarray:
    """Standard parameters (10,) of one body of the file, in the frame of the joint that moves it."""
    x, y, z = compiled.body_inertia[body]
    principal = np.array([compiled.body_mass[body], 0.0, 0.0, 0.0, x, 0.0, y, 0.0, 0.0, z])
    axes = rotation_matrix(compiled.body_iquat[body])
    parameters = moved_parameters(principal, axes, compiled.body_ipos[body])
    return moved_parameters(parameters, place.rotation, place.translation)


def _solid(parameters: np.ndarray) -> np.ndarray:
    """The same body, at least a hundredth as thick as long: a point or a rod has no volume for comparison."""
    matrix = pseudo_inertia(parameters)
    mass = matrix[3, 3]
    center = matrix[:3, 3] / mass
    spread = matrix[:3, :3] - mass * np.outer(center, center)
    extents, axes = np.linalg.eigh(0.5 * (spread + spread.T))
    longest = max(float(extents[-1]), mass * SLENDER * float(center @ center), mass * SLENDER**2)
    spread = (axes * np.maximum(extents, SLENDER * longest)) @ axes.T
    matrix[:3, :3] = spread + mass * np.outer(center, center)
    return standard_parameters(matrix)


@dataclass(frozen=True)
class Body:
    """A body or payload with ten unknown standard parameters.

    prior (10,): of these; rows (nz, 10): contribution of each to the estimated parameters; held (k, 10), to (k,):
    equations of its declared parameters.
    """

    name: str
    prior: np.ndarray
    rows: np.ndarray
    held: np.ndarray
    to: np.ndarray


@dataclass(frozen=True)
class BodyEquations:
    """estimated (nz,) = sum of body.rows @ its parameters + rotors (nz, n) @ Ia.

    covariance (nz, nz); fixed (nz,): estimated parameters to meet exactly. rotor_prior (n,).
    """

    estimated: np.ndarray
    covariance: np.ndarray
    fixed: np.ndarray
    bodies: tuple[Body, ...]
    rotors: np.ndarray
    rotor_prior: np.ndarray
    prior: Prior


def equations_of(identified: IdentifiedModel, use_cad: bool) -> BodyEquations:
    """The equations of a model. use_cad: prior from the masses of the MJCF, not from bars."""
    geometry, base = identified.model.geometry, identified.model.base
    prior = cad_prior(geometry) if use_cad else _scaled_bars(identified)
    nb, nz = len(identified.base), len(identified.estimated)
    bodies = []
    for joint, name in geometry.bodies:
        columns = slice(10 * joint, 10 * joint + 10)
        rows = np.zeros((nz, 10))
        rows[:nb] = base.grouping[:, columns]
        bodies.append(Body(name, prior.parameters[columns], rows, np.zeros((0, 10)), np.zeros(0)))
    place = nb
    for name, values in identified.payloads.items():
        declared = identified.declared.get(name, Payload(name))
        bodies.append(_load(identified, declared, place, tuple(values)))
        place += len(values)
    rotors = np.zeros((nz, len(geometry.active)))
    rotors[:nb] = base.rotors
    return BodyEquations(
        estimated=identified.estimated,
        covariance=identified.covariance[:nz, :nz],
        fixed=identified.fixed,
        bodies=tuple(bodies),
        rotors=rotors,
        rotor_prior=prior.rotors,
        prior=prior,
    )


def _load(identified: IdentifiedModel, declared: Payload, place: int, kept: tuple[int, ...]) -> Body:
    """A payload: each estimated parameter also represents those with the same effect on the robot."""
    columns = payload_columns(declared)
    nz = len(identified.estimated)
    measured = identified.model.random_rows[1].reshape(-1, 10)
    unknown = columns.unknown
    candidates = measured[:, unknown]
    with_known = bool(np.any(columns.known))
    if with_known:
        candidates = np.column_stack((measured @ columns.known, candidates))
    independent = independent_columns(candidates)
    dependence = independent.dependence
    indices = [int(unknown[i - with_known]) for i in independent.kept if i >= with_known]
    rows = np.zeros((nz, 10))
    share = dependence[with_known:, with_known:]
    for row, index in zip(share, indices, strict=True):
        if index in kept:
            rows[place + kept.index(index), unknown] = row
    held = np.setdiff1d(np.arange(10), unknown)
    equations, to = np.eye(10)[held], columns.known[held]
    if with_known:
        # parameters omitted from the estimate must not add to what is declared
        extra = np.zeros((1, 10))
        extra[0, unknown] = dependence[0, 1:]
        if extra.any():
            equations, to = np.vstack((equations, extra)), np.append(to, 0.0)
    return Body(LOAD + declared.name, _solid_load(declared, identified, place, kept), rows, equations, to)


def _solid_load(
    declared: Payload, identified: IdentifiedModel, place: int, kept: tuple[int, ...]
) -> np.ndarray:
    """A ball of the payload's mass, where it was identified."""
    known = payload_columns(declared).known.copy()
    known[list(kept)] = identified.estimated[place : place + len(kept)]
    mass = known[0] if known[0] > 0.0 else 1.0
    center = known[1:4] / mass
    radius = max(0.02, 0.3 * float(np.linalg.norm(center)))
    square = float(center @ center) * np.eye(3) - np.outer(center, center) + 0.4 * radius**2 * np.eye(3)
    return np.concatenate(([mass], mass * center, mass * square[[0, 0, 1, 0, 1, 2], [0, 1, 1, 2, 2, 2]]))
