"""Checks that the loop closures determine every passive joint, and no motor; else refuses by name."""

import numpy as np

from bench.basics.errors import BenchError
from bench.basics.joint_units import joint_units
from bench.dataset.robot_redundancy import listed
from bench.model.bounds import CLOSURE, RANDOM_POSES, RANKS
from bench.model.closure import loop_jacobian, loop_residual
from bench.model.configuration import integrate, normalised
from bench.model.cures import cure_in_words, joints_in_words, no_motor_in_words, welds_as_connects, what_to_do
from bench.model.geometry import Coupling, Geometry
from bench.model.nodes import robot_length

SEED = 20120602  # of that pose


class SingularHomeError(BenchError):
    """The home pose is singular, although the poses near it are not."""


def check_assembled(geometry: Geometry) -> None:
    """Raise BenchError naming the loop or coupling that is open by more than 1e-6 m or rad in the home pose.

    With more equations than joints to close them, the least-squares residual may be up to `CLOSURE.slack`.
    """
    if not geometry.closed:
        return
    residual = np.abs(loop_residual(geometry, geometry.home[:, None])[:, 0])
    widest = int(np.argmax(residual))
    allowed = CLOSURE.slack if len(residual) > len(geometry.passive) else CLOSURE.assembled
    if residual[widest] <= allowed:
        return
    cure = welds_as_connects(geometry, residual, allowed)
    rows = [
        (f"loop {loop.name!r}", joint_units(rotates=k >= 3).position)
        for loop in geometry.loops
        for k in range(loop.size)
    ]
    rows += [(_named(geometry, coupling), _unit(geometry, coupling)) for coupling in geometry.couplings]
    owner, unit = rows[widest]
    raise BenchError(
        f"robot {geometry.robot.name}: {owner} is open by {residual[widest]:.3g} {unit} in the "
        f"home pose{cure_in_words(cure) or '; bench robot check prints the assembled one'}"
    )


def _named(geometry: Geometry, coupling: Coupling) -> str:
    """An equality with the joints that it couples or holds."""
    joints = [geometry.joints[joint] for joint, _ in (*coupling.first, *coupling.second)]
    return f"equality {coupling.name!r} of {joints_in_words(joints)}"


def _unit(geometry: Geometry, coupling: Coupling) -> str:
    """The unit of the first joint's position."""
    joint, _ = coupling.first[0]
    return joint_units(geometry.joints[joint].kind != "slide").position


def check_mobility(geometry: Geometry) -> None:
    """Raise BenchError unless motors and closures together determine the robot's motion, without excess.

    The rank of the closures' Jacobian by the passive joints must be their number, and the motors must not increase it.
    Home may be a special pose, so a pose near it decides; home itself must not be singular.
    """
    loose = loose_joints(geometry, geometry.home)
    if not loose and not geometry.closed:
        return
    name = geometry.robot.name
    general = _closed_nearby(geometry)
    undetermined = loose if general is None else loose_joints(geometry, general)
    if undetermined:
        jacobian = scaled_jacobian(geometry, geometry.home if general is None else general)
        if geometry.nv - _rank(jacobian) <= len(geometry.active):
            raise BenchError(
                f"robot {name}: {_in_words(geometry, undetermined)} can move with all motors held, although there are "
                "as many motors as degrees of freedom: the arrangement is singular in all poses near home, as legs are "
                "in a regular hexagon; change it, or drive other joints"
            )
        closures = jacobian[:, geometry.passive]
        cure = cure_in_words(what_to_do(geometry, undetermined, closures, _rank(closures)))
        said = f"{'it' if len(undetermined) == 1 else 'they'} {no_motor_in_words(len(undetermined))}"
        raise BenchError(
            f"robot {name}: {_in_words(geometry, undetermined)} can move with all motors held: {said}{cure}"
        )
    if loose:
        raise SingularHomeError(
            f"robot {name}: home is a singular pose: {_in_words(geometry, loose)} can move there, all motors held; "
            "write a keyframe home away from it"
        )
    jacobian = scaled_jacobian(geometry, geometry.home if general is None else general)
    freedom = geometry.nv - _rank(jacobian)
    if freedom < len(geometry.active):
        bound = listed(_bound_motors(geometry, jacobian))
        raise BenchError(
            f"robot {name}: the loop closures leave {freedom} degree{'s' if freedom != 1 else ''} of freedom for "
            f"{len(geometry.active)} motors: {bound} cannot move independently near the home pose, although they "
            "can at home; a closure is one too many, or a joint is missing"
        )


def loose_joints(geometry: Geometry, q: np.ndarray) -> tuple[str, ...]:
    """Joints that can still move at the pose q (nq,) with all motors held."""
    passive = geometry.passive
    jacobian = scaled_jacobian(geometry, q)[:, passive]
    if not len(passive):
        return ()
    _, values, motions = np.linalg.svd(jacobian)
    free = np.abs(motions[int((values > RANKS.dependent * values.max(initial=0.0)).sum()) :])
    taking_part = (free > RANKS.takes_part * free.max(axis=1, keepdims=True)).any(axis=0)
    moving = set(passive[taking_part].tolist())
    return tuple(joint.name for joint in geometry.joints if moving & set(range(joint.v.start, joint.v.stop)))


def scaled_jacobian(geometry: Geometry, q: np.ndarray) -> np.ndarray:
    """Dimensionless Jacobian (m, nv) of the closures at the pose q (nq,): see `scaled_jacobians`."""
    return np.asarray(scaled_jacobians(geometry, q[None])[0])


def scaled_jacobians(geometry: Geometry, q: np.ndarray) -> np.ndarray:
    """Dimensionless Jacobians (N, m, nv) of the closures at q (N, nq): all lengths over the robot's length.

    The row of a coupling has a largest entry of one.
    """
    jacobian = loop_jacobian(geometry, q.T).transpose(2, 0, 1) * column_scales(geometry)
    row = 0
    for loop in geometry.loops:
        jacobian[:, row : row + 3] /= robot_length(geometry)
        row += loop.size
    gears = slice(row, row + len(geometry.couplings))
    largest = np.abs(jacobian[:, gears]).max(axis=2, keepdims=True, initial=0.0)
    jacobian[:, gears] /= np.where(largest > 0.0, largest, 1.0)
    return np.asarray(jacobian)


def smallest_singular_values(geometry: Geometry, q: np.ndarray, free: int = 0) -> np.ndarray:
    """The smallest singular values (N,) of the scaled loop Jacobian by the passive joints at q (N, nq). Zero: some
    joint is loose.

    free: number of `free_motions`, which are omitted.
    """
    return _smallest(scaled_jacobians(geometry, q)[:, :, geometry.passive], free)


def _smallest(passive: np.ndarray, free: int = 0) -> np.ndarray:
    """The smallest singular values (N,) of matrices (N, m, np), without `free` of them."""
    held = passive.shape[2] - free
    if held <= 0:
        return np.full(len(passive), np.inf)
    if passive.shape[1] < held:
        return np.zeros(len(passive))
    return np.asarray(np.linalg.svd(passive, compute_uv=False)[:, held - 1])


def free_motions(geometry: Geometry, q: np.ndarray) -> int:
    """Number of motions that no closure prevents in any of the poses q (N, nq), loops open or closed, the motors held:
    joints that nothing holds.
    """
    passive = scaled_jacobians(geometry, q)[:, :, geometry.passive]
    values = np.linalg.svd(passive, compute_uv=False)
    held = values > RANKS.dependent * values.max(axis=1, initial=0.0, keepdims=True)
    return int(passive.shape[2] - held.sum(axis=1).max(initial=0))


def conditioning(geometry: Geometry, q: np.ndarray) -> float:
    """Largest condition number of the scaled loop Jacobian by the passive joints at q (N, nq); 1 without closures."""
    passive = scaled_jacobians(geometry, q)[:, :, geometry.passive]
    if not min(passive.shape):
        return 1.0
    values = np.linalg.svd(passive, compute_uv=False)
    return float((values[:, 0] / values[:, -1]).max())


def least_held(geometry: Geometry, q: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Indices (count,), in order, of the poses q (N, nq) with the smallest determinant by the passive joints, and their
    `smallest_singular_values`.
    """
    passive = scaled_jacobians(geometry, q)[:, :, geometry.passive]
    square = passive
    if passive.shape[1] != passive.shape[2]:
        square = passive.transpose(0, 2, 1) @ passive
    _, sizes = np.linalg.slogdet(square)
    worst = np.sort(np.argsort(sizes, kind="stable")[:count])
    return worst, _smallest(passive[worst])


def column_scales(geometry: Geometry) -> np.ndarray:
    """(nv,): the robot's length [m] where a tree velocity is a length per time, else 1."""
    scales = np.ones(geometry.nv)
    for joint in geometry.joints:
        if joint.kind in ("slide", "free"):
            scales[joint.v.start : min(joint.v.stop, joint.v.start + 3)] = robot_length(geometry)
    return scales


def _rank(matrix: np.ndarray) -> int:
    values = np.linalg.svd(matrix, compute_uv=False)
    return int((values > RANKS.dependent * values.max(initial=0.0)).sum())


def _bound_motors(geometry: Geometry, jacobian: np.ndarray) -> tuple[str, ...]:
    """Motors that the closures couple to one another, whatever the passive joints do."""
    passive, active = jacobian[:, geometry.passive], jacobian[:, geometry.active]
    uncontrolled = active - passive @ np.linalg.lstsq(passive, active, rcond=RANKS.dependent)[0]
    sizes = np.abs(uncontrolled).max(axis=0)
    return tuple(
        name
        for name, size in zip(geometry.robot.joints, sizes, strict=True)
        if size > RANKS.takes_part * sizes.max()
    )


def _closed_nearby(geometry: Geometry) -> np.ndarray | None:
    """A closed pose (nq,), a random step from home along the motions that the closures allow, or None."""
    random = np.random.default_rng(SEED)
    scales = column_scales(geometry)
    jacobian = scaled_jacobian(geometry, geometry.home)
    _, _, motions = np.linalg.svd(jacobian)
    free = motions[_rank(jacobian) :]
    if not len(free):
        return None
    direction = free.T @ random.normal(size=len(free))
    step = RANDOM_POSES.nearby * direction / np.abs(direction).max()
    q = integrate(geometry, geometry.home[:, None], (scales * step)[:, None])
    for _ in range(CLOSURE.nearby):
        q = normalised(geometry, q)
        residual = loop_residual(geometry, q)
        back = np.linalg.lstsq(
            loop_jacobian(geometry, q)[:, :, 0] * scales, -residual, rcond=RANKS.dependent
        )[0]
        q = integrate(geometry, q, scales[:, None] * back)
        if np.abs(back).max() < CLOSURE.closed_nearby:
            return np.asarray(q[:, 0]) if np.abs(residual).max() < CLOSURE.slack else None
    return None


def _in_words(geometry: Geometry, names: tuple[str, ...]) -> str:
    return joints_in_words([joint for joint in geometry.joints if joint.name in names])
