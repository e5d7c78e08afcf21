"""Search for trajectories with a well-conditioned observation matrix."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from bench.basics.errors import BenchError
from bench.basics.progress import SILENT, Progress
from bench.basics.threads import on_one_thread
from bench.dataset.payload import Payload
from bench.dataset.robot import Robot
from bench.excitation.bounds import DESIGN
from bench.excitation.current_band import band_shares
from bench.excitation.limits import Limits, feasible_motion, keeps_clear, limits_of
from bench.identification.layout import payload_columns
from bench.model.model import IdentificationModel, build_model
from bench.model.motion import Motion
from bench.model.regressor import projected_regressor
from bench.scenario.trajectory import FourierTrajectory, random_trajectory


@dataclass(frozen=True)
class Movement:
    """Limits of a trajectory. span, velocity, acceleration (n,): largest distance from `center`, rad or m, and largest
    rates; fitted: whether its recording is for identification, with `payload` or None.
    """

    name: str
    fitted: bool
    payload: Payload | None
    center: np.ndarray
    span: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray
    harmonics: int
    base_frequency: float
    duration: float
    ramp: float
    seed: int


@dataclass(frozen=True)
class Designed:
    """Trajectories by recording name, and the condition number of all fitted ones."""

    trajectories: Mapping[str, FourierTrajectory]
    condition: float


@on_one_thread
def design_trajectories(robot: Robot, movements: Sequence[Movement], progress: Progress = SILENT) -> Designed:
    """Trajectories inside all limits; those of fitted recordings minimise the condition number.

    The criterion is the condition number of the observation matrix with columns of unit length, drive gain and payload
    columns included, for all fitted recordings together (Gautier and Khalil, "Exciting trajectories for the
    identification of base inertial parameters of robots", 1992). Random starts, then random improvements of the best;
    results depend only on the movements' seeds.
    """
    model = build_model(robot)
    limits = limits_of(model.geometry)
    random = np.random.default_rng([movement.seed for movement in movements])
    fitted = [movement for movement in movements if movement.fitted]
    best: dict[str, TriedMovement] = {}
    lowest = np.inf
    progress.phase("designing trajectories", DESIGN.starts + DESIGN.steps)
    for _ in range(DESIGN.starts):
        progress.advance()
        tried = {m.name: shrunk(model, limits, m, drawn(m, random)) for m in fitted}
        value = _condition(tried, fitted)
        if value < lowest:
            best, lowest = tried, value
    if fitted and not best:
        raise BenchError(f"robot {robot.name}: no exciting trajectory found inside the limits")
    for step in range(DESIGN.steps if fitted else 0):
        progress.advance()
        spread = DESIGN.first_spread * (DESIGN.last_spread / DESIGN.first_spread) ** (step / DESIGN.steps)
        movement = fitted[step % len(fitted)]
        before = best[movement.name]
        other = _changed(model, limits, movement, before, spread, random)
        if other is None:
            continue
        tried = {**best, movement.name: other}
        value = _condition(tried, fitted)
        if value < lowest:
            best, lowest = tried, value
    progress.phase("checking the trajectories", len(movements))
    by_name: dict[str, FourierTrajectory] = {}
    for movement in movements:
        progress.advance()
        trajectory = best[movement.name].trajectory if movement.fitted else drawn(movement, random)
        by_name[movement.name] = shrunk(model, limits, movement, trajectory, dense=True).trajectory
    return Designed(by_name, float(lowest))


@dataclass(frozen=True)
class TriedMovement:
    """A feasible trajectory with its motion, and its rows (M, c) of the observation matrix."""

    trajectory: FourierTrajectory
    motion: Motion
    rows: np.ndarray


def _changed(
    model: IdentificationModel,
    limits: Limits,
    movement: Movement,
    before: TriedMovement,
    spread: float,
    random: np.random.Generator,
) -> TriedMovement | None:
    """A random trajectory near another one; None if it is not feasible."""
    trajectory = changed(before.trajectory, spread, random)
    trajectory = within(movement, trajectory, _times(movement, dense=True))
    motion = feasible_motion(model.geometry, limits, trajectory, _times(movement), near=before.motion)
    return None if motion is None else _in_band(model, movement, trajectory, motion)


def drawn(movement: Movement, random: np.random.Generator) -> FourierTrajectory:
    """A random trajectory that keeps the movement's span, velocity and acceleration."""
    return random_trajectory(
        int(random.integers(2**31)),
        movement.center,
        movement.span,
        movement.velocity,
        acceleration_limit=movement.acceleration,
        harmonics=movement.harmonics,
        base_frequency=movement.base_frequency,
        duration=movement.duration,
        ramp=movement.ramp,
    )


def changed(trajectory: FourierTrajectory, spread: float, random: np.random.Generator) -> FourierTrajectory:
    """Every coefficient changed at random, by `spread` times the size of its harmonic."""
    size = np.sqrt((trajectory.a**2 + trajectory.b**2).mean(axis=1, keepdims=True))
    size = spread * size / np.arange(1, trajectory.harmonics + 1)
    return replace(
        trajectory,
        a=trajectory.a + size * random.normal(size=trajectory.a.shape),
        b=trajectory.b + size * random.normal(size=trajectory.b.shape),
    )


def within(
    movement: Movement, trajectory: FourierTrajectory, time: np.ndarray, most: float = 1.0
) -> FourierTrajectory:
    """Scaled down, joint by joint, to keep a share `most` of span, velocity and acceleration at the times (N,)."""
    q, qd, qdd = trajectory.evaluate(time)
    limits = (movement.span, movement.velocity, movement.acceleration)
    sizes = [np.abs(x).max(axis=0) for x in (q - movement.center, qd, qdd)]
    shares = np.max([size / limit for size, limit in zip(sizes, limits, strict=True)], axis=0)
    return trajectory.scaled(most / np.maximum(shares, most)[:, None])


def _times(movement: Movement, dense: bool = False) -> np.ndarray:
    """One period after the smooth start, or (dense) the whole movement four times as finely."""
    rate = DESIGN.points * movement.harmonics * movement.base_frequency
    if dense:
        return np.linspace(0.0, movement.duration, int(4 * rate * movement.duration) + 2)
    end = min(movement.ramp + 1.0 / movement.base_frequency, movement.duration)
    return np.linspace(movement.ramp, end, max(20, int(rate * (end - movement.ramp))))


def shrunk(
    model: IdentificationModel,
    limits: Limits,
    movement: Movement,
    trajectory: FourierTrajectory,
    dense: bool = False,
) -> TriedMovement:
    """The trajectory shrunk until it keeps the joint ranges, the distance from singular poses and the band of the
    torques; dense: at finer times, to the end.
    """
    time = _times(movement, dense)
    for _ in range(DESIGN.shrinks):
        motion = feasible_motion(model.geometry, limits, trajectory, time)
        if motion is not None and (not dense or keeps_clear(model.geometry, limits, motion)):
            tried = _in_band(model, movement, trajectory, motion)
            if tried is not None:
                return tried
        trajectory = trajectory.scaled(DESIGN.shrink)
    raise BenchError(
        f"recording {movement.name!r}: no movement around its center keeps the joint ranges and the distance "
        "from singular poses, with torques in the band of a fit"
    )


def _in_band(
    model: IdentificationModel, movement: Movement, trajectory: FourierTrajectory, motion: Motion
) -> TriedMovement | None:
    """A feasible trajectory with its rows; None if torques of guessed bodies have peaks too narrow for a fit."""
    rows, torque = _rows(model, movement, motion)
    rate = (len(motion.time) - 1) / float(motion.time[-1] - motion.time[0])
    return (
        None
        if np.any(band_shares(torque, rate, trajectory) > 1.0)
        else TriedMovement(trajectory, motion, rows)
    )


def _condition(tried: Mapping[str, TriedMovement], movements: Sequence[Movement]) -> float:
    """Condition number of the scaled [phi, v, phi_uL] over all fitted movements."""
    rows = [tried[movement.name].rows for movement in movements]
    if not rows:
        return np.inf
    width = max(block.shape[1] for block in rows)
    stacked = np.vstack([np.pad(block, ((0, 0), (0, width - block.shape[1]))) for block in rows])
    norms = np.linalg.norm(stacked, axis=0)
    stacked = stacked[:, norms > 1e-9 * norms.max()] / norms[norms > 1e-9 * norms.max()]
    singular = np.linalg.svd(stacked, compute_uv=False)
    return float(singular[0] / singular[-1]) if singular[-1] > 0 else np.inf


def _rows(model: IdentificationModel, movement: Movement, motion: Motion) -> tuple[np.ndarray, np.ndarray]:
    """Rows (N n, c) and torques (N, n) of guessed bodies. Columns: base parameters, drive gains, and the payload's
    unknown parameters, if any.
    """
    geometry = model.geometry
    columns = model.base.columns
    if movement.payload is not None:
        columns = np.concatenate((columns, model.payload_columns))
    regressor = projected_regressor(geometry, motion, columns)
    samples, n = regressor.shape[:2]
    nb = len(model.base.columns)
    torque = regressor[:, :, :nb] @ model.guessed
    unknown = np.zeros((samples, n, 0))
    if movement.payload is not None and model.payload is not None:
        loads = regressor[:, :, nb:] @ model.payload
        split = payload_columns(movement.payload)
        torque = torque + loads @ split.known
        unknown = loads[:, :, split.unknown]
    gains = np.zeros((samples, n, n))
    gains[:, np.arange(n), np.arange(n)] = torque
    rows = np.concatenate((regressor[:, :, :nb], gains, unknown), axis=2)
    return rows.reshape(samples * n, -1), torque
