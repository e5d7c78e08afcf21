"""First-order change of errors and limits with the coefficients of a motion.

At every sample, positions, velocities and accelerations of every motor are perturbed slightly, with loops closed again.
The effect of a coefficient is a combination of these, since the series is linear in it.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import islice

import numpy as np
from scipy.linalg import block_diag

from bench.basics.mapper import IN_TURN, Mapper
from bench.excitation.bounds import LIMITS, SEARCH
from bench.excitation.current_band import band_shares, current_above, hann
from bench.excitation.experiment.covariance import ErrorSlopes
from bench.excitation.experiment.nominal import (
    Equations,
    Evidence,
    Noise,
    SeenMotion,
    equations,
    pooled_variance,
    seen,
    seen_each,
)
from bench.excitation.experiment.request import Box
from bench.excitation.experiment.room import Room, outside, tool_positions
from bench.excitation.experiment.search import Candidate, Search, Tried
from bench.model.geometry import Geometry
from bench.model.mobility import least_held, smallest_singular_values
from bench.model.motion import Motion, at_speeds, joined, motion_near
from bench.scenario.trajectory import FourierTrajectory


@dataclass(frozen=True)
class Linear:
    """Values (k,) and their derivatives (k, c) by the coefficients."""

    values: np.ndarray
    slopes: np.ndarray

    def at(self, chosen: np.ndarray) -> "Linear":
        """Some of them."""
        return Linear(self.values[chosen], self.slopes[chosen])


@dataclass(frozen=True)
class Linearised:
    """errors: the largest logarithms to minimise; mean (c,): slopes of the mean of all logarithms; limits: must stay at
    or below 1; all by all coefficients of all motions, in the units of `coefficient_sizes`.
    """

    errors: Linear
    mean: np.ndarray
    limits: Linear


def coefficient_sizes(room: Room, trajectory: FourierTrajectory) -> np.ndarray:
    """The largest size (2, n, H) that each coefficient a, b could have alone, rad or m."""
    k_omega = 2.0 * np.pi * trajectory.base_frequency * np.arange(1, trajectory.harmonics + 1)
    ranges = 0.5 * (room.joint.high - room.joint.low)[:, None]
    by_speed, by_acceleration = room.velocity[:, None] / k_omega, room.acceleration[:, None] / k_omega**2
    sizes = np.minimum(np.minimum(by_speed, by_acceleration), ranges)
    return np.stack((sizes, sizes))


def moved(trajectory: FourierTrajectory, steps: np.ndarray) -> FourierTrajectory:
    """The trajectory with its coefficients changed by steps (2, n, H), rad or m."""
    return replace(trajectory, a=trajectory.a + steps[0], b=trajectory.b + steps[1])


def linearised(search: Search, candidates: Sequence[Candidate], mapper: Mapper = IN_TURN) -> list[Linearised]:
    """Errors and limits about each candidate."""
    motions = [(candidate, number) for candidate in candidates for number in range(len(candidate))]
    parts = mapper.map(_by_one_motion, search, motions)
    return [_joined(search, candidate, list(islice(parts, len(candidate)))) for candidate in candidates]


def _joined(search: Search, candidate: Candidate, parts: list[tuple[np.ndarray, Linear]]) -> Linearised:
    """Slopes by the coefficients of all motions of a candidate, from those of each."""
    errors, near = _near(search, search.fit(candidate))
    *each, mean = np.hstack([slopes for slopes, _ in parts])
    limits = _concatenated([limits for _, limits in parts])
    return Linearised(Linear(errors[near], np.array(each) if each else mean[None]), mean, limits)


def _near(search: Search, fit: Equations) -> tuple[np.ndarray, np.ndarray]:
    """The logarithms (k,) of the errors, and which of them are nearly as large as the largest."""
    errors = search.errors(fit)
    return errors, np.exp(errors - errors.max()) > SEARCH.near


def _by_one_motion(search: Search, motion: tuple[Candidate, int]) -> tuple[np.ndarray, Linear]:
    """Slopes (m + 1, 2 n H) of the errors and of their mean, and limits, by the coefficients of one motion."""
    candidate, number = motion
    recordings = [*search.known, *(trial.evidence for trial in candidate)]
    fit = equations(recordings)
    gradient = search.errors.slopes(fit, _near(search, fit)[1])
    tried = candidate[number]
    sizes = coefficient_sizes(search.room, tried.trajectory)
    basis = _basis(tried.trajectory, search.shape.times)
    probe = _perturbed(search, tried, search.loads[number])
    at = len(search.known) + number
    slopes = _error_slopes(search, probe, basis, sizes, gradient, recordings, at)
    return slopes, _limits(search, tried, probe, basis, sizes)


@dataclass(frozen=True)
class _Perturbed:
    """A motion and its currents; showing: those with a step in position, velocity or acceleration (first index) of each
    motor (second index), at all samples; steps (3, n); moved: the motions with a step in position of each motor, one
    after the other.
    """

    motion: Motion
    shown: SeenMotion
    moved: Motion
    showing: list[list[SeenMotion]]
    steps: np.ndarray

    def moved_at(self, samples: np.ndarray) -> Motion:
        """Some of the samples with a step in position of each motor, one after the other."""
        count = len(self.motion.time)
        starts = count * np.arange(self.steps.shape[1])
        return self.moved.at((starts[:, None] + samples).ravel())


def _perturbed(search: Search, tried: Tried, load: str | None) -> _Perturbed:
    room, geometry, times = search.room, search.nominal.model.geometry, search.shape.times
    states = tried.trajectory.evaluate(times)
    n, count = len(room.home), len(times)
    steps = SEARCH.difference * np.array([room.joint.high - room.joint.low, room.velocity, room.acceleration])
    every = np.tile(np.arange(count), n)
    moved_states = [state[every] for state in states]
    for j in range(n):
        moved_states[0][j * count : (j + 1) * count, j] += steps[0, j]
    moved_motions = motion_near(geometry, tried.motion.at(every), *moved_states)
    faster = at_speeds(geometry, tried.motion, [states[1] + step for step in np.diag(steps[1])], states[2])
    accelerated = (
        replace(tried.motion, a=tried.motion.a + steps[2, j] * tried.motion.jacobian[:, :, j])
        for j in range(n)
    )
    whole = joined((moved_motions, *faster, *accelerated))
    each = seen_each(search.nominal, whole, count, load)
    showing = [each[order * n : (order + 1) * n] for order in range(3)]
    shown = seen(search.nominal, tried.motion, load)
    return _Perturbed(tried.motion, shown, moved_motions, showing, steps)


def _basis(trajectory: FourierTrajectory, times: np.ndarray) -> np.ndarray:
    """Position, velocity and acceleration of unit coefficients: (3, N, 2, H)."""
    harmonics = trajectory.harmonics
    identity, none = np.eye(harmonics), np.zeros((harmonics, harmonics))
    a, b = np.vstack((identity, none)), np.vstack((none, identity))
    series = replace(trajectory, center=np.zeros(2 * harmonics), a=a, b=b)
    return np.array(series.evaluate(times)).reshape(3, len(times), 2, harmonics)


def _error_slopes(
    search: Search,
    probe: _Perturbed,
    basis: np.ndarray,
    sizes: np.ndarray,
    gradient: ErrorSlopes,
    recordings: list[Evidence],
    number: int,
) -> np.ndarray:
    """Derivatives (m + 1, 2 n H) of the errors, and of their mean, by the coefficients of a recording (index).

    Its current derivatives change at every sample, and with them the grams; its current variance changes, and with it
    the motors' weights. Columns of `gradient` multiply the regressor first, so no gram is formed per coefficient.
    """
    recording, n, m = recordings[number], sizes.shape[1], gradient.factor.shape[1]
    weight = 1.0 / pooled_variance(recordings)
    scale = recording.samples / len(probe.shown.current)
    weights = (
        scale * np.array((weight, weight**2 * recording.variance))[:, :, None, None]
    )  # of normal and score
    sides = np.hstack((gradient.factor, gradient.by_normal)).T
    jacobian = probe.shown.by_motor
    present = sides @ jacobian  # (n, 2 m, N)
    by_factor, by_normal = present[:, :m], present[:, m:]
    of_each = np.concatenate(
        (weights[0] * by_normal + 2.0 * weights[1] * by_factor, weights[0] * by_factor), axis=1
    )
    of_mean = 2.0 * (
        (weights[0] * gradient.mean_by_normal + weights[1] * gradient.mean_by_score) @ jacobian
    )  # (n, P, N)
    slopes = np.zeros((m + 1, *sizes.shape))
    for order, j in np.ndindex(3, n):
        other = probe.showing[order][j].by_motor
        by_side = np.einsum("imt,imt->mt", of_each, sides @ other - present)
        of_all = np.vstack((by_side[:m] + by_side[m:], np.einsum("ipt,ipt->t", of_mean, other - jacobian)))
        by_series = of_all @ basis[order].reshape(len(basis[order]), -1) / probe.steps[order, j]
        slopes[:, :, j] += by_series.reshape(m + 1, 2, -1) * sizes[:, j]
    variances = _variance_slopes(search.nominal.noise, probe, basis, sizes)
    slopes += np.tensordot(_by_variances(gradient, recordings, number, weight), variances, axes=1)
    return slopes.reshape(len(slopes), sizes.size)


def _variance_slopes(noise: Noise, probe: _Perturbed, basis: np.ndarray, sizes: np.ndarray) -> np.ndarray:
    """Derivatives (n, 2, n, H) of the variance of each motor's currents by the coefficients."""
    current, before = probe.shown.current, noise.deviation(probe.shown.current) ** 2
    slopes = np.zeros((len(before), *sizes.shape))
    for which, j, k in np.ndindex(sizes.shape):
        amount = SEARCH.coefficient_difference * sizes[which, j, k] * basis[:, :, which, k]  # (3, N)
        changed = current + sum(
            amount[order][:, None] * (probe.showing[order][j].current - current) / probe.steps[order, j]
            for order in range(3)
        )
        slopes[:, which, j, k] = (noise.deviation(changed) ** 2 - before) / SEARCH.coefficient_difference
    return slopes


def _by_variances(
    gradient: ErrorSlopes, recordings: list[Evidence], number: int, weight: np.ndarray
) -> np.ndarray:
    """Derivatives (m + 1, n) of the errors, and of their mean, by the variance of each motor's currents in one
    recording.
    """
    changed = recordings[number]
    share = changed.samples / sum(recording.samples for recording in recordings)

    def between(grams: np.ndarray, right: np.ndarray, mean: np.ndarray) -> np.ndarray:
        each = np.einsum("pm,npm->mn", gradient.factor, grams @ right)
        return np.vstack((each, np.einsum("pq,nqp->n", mean, grams)))

    whole = sum(recording.grams for recording in recordings)
    noisy = sum(recording.grams * recording.variance[:, None, None] for recording in recordings)
    by_normal, by_score = gradient.by_normal, gradient.factor
    return np.asarray(
        weight**2
        * (
            between(changed.grams, by_score, gradient.mean_by_score)
            - share * between(np.asarray(whole), by_normal, gradient.mean_by_normal)
            - 2.0 * share * weight * between(np.asarray(noisy), by_score, gradient.mean_by_score)
        )
    )


def _limits(search: Search, tried: Tried, probe: _Perturbed, basis: np.ndarray, sizes: np.ndarray) -> Linear:
    """All limits of one motion that are near, each as a share."""
    room = search.room
    parts = [_of_motors(room, tried.trajectory, search.shape.times, sizes)]
    for samples, shares in _whole_robot(search, probe):
        by_coefficient = np.einsum("mj,mwk,wjk->mwjk", shares.slopes, basis[0][samples], sizes)
        parts.append(Linear(shares.values, by_coefficient.reshape(len(samples), sizes.size)))
    if np.isfinite(room.torque).any():
        parts.append(_of_torques(search, probe, basis, sizes))
    parts.append(_of_bands(search, tried.trajectory, probe, basis, sizes))
    return Linear(np.concatenate([part.values for part in parts]), np.vstack([part.slopes for part in parts]))


def _of_motors(room: Room, trajectory: FourierTrajectory, times: np.ndarray, sizes: np.ndarray) -> Linear:
    """Ranges, speeds and accelerations: exactly linear."""
    fine = np.linspace(times[0], times[-1], SEARCH.finer * (len(times) - 1) + 1)
    basis = _basis(trajectory, fine)
    position, velocity, acceleration = trajectory.evaluate(fine)
    values, slopes = [], []
    up, down = room.joint.high - room.home, room.home - room.joint.low
    for state, least, most, effect in (
        (position - room.home, down, up, basis[0]),
        (velocity, room.velocity, room.velocity, basis[1]),
        (acceleration, room.acceleration, room.acceleration, basis[2]),
    ):
        for j in range(len(room.home)):
            for sign, limit in ((1.0, most[j]), (-1.0, least[j])):
                share = sign * state[:, j] / limit
                near = np.flatnonzero(share > SEARCH.near)
                slope = np.zeros((len(near), *sizes.shape))
                slope[:, :, j] = sign * effect[near] * sizes[:, j] / limit
                values.append(share[near])
                slopes.append(slope.reshape(len(near), sizes.size))
    return Linear(np.concatenate(values), np.vstack(slopes))


def _whole_robot(search: Search, probe: _Perturbed) -> Iterator[tuple[np.ndarray, Linear]]:
    """Loop amplification, singular values and boxes: shares (m,) of a limit at some of the samples (m,), and their
    derivatives (m, n) by the positions there.
    """
    geometry, room = search.nominal.model.geometry, search.room

    def of(
        values: Callable[[Motion, np.ndarray], np.ndarray], samples: np.ndarray, whole: np.ndarray
    ) -> Iterator[tuple[np.ndarray, Linear]]:
        """The values that are near their limit, `whole` at some samples."""
        near, present = samples[whole > SEARCH.near], whole[whole > SEARCH.near]
        if len(near):
            moved_values = values(probe.moved_at(near), np.tile(near, len(room.home)))
            slopes = (moved_values.reshape(-1, len(near)) - present) / probe.steps[0][:, None]
            yield near, Linear(present, slopes.T)

    every = np.arange(len(probe.motion.time))
    if geometry.closed:
        flat = probe.motion.jacobian.reshape(len(every), -1)
        largest = np.abs(flat).argmax(axis=1)
        signs = np.sign(flat[every, largest])

        def not_held(motion: Motion, _: np.ndarray) -> np.ndarray:
            return np.asarray(room.joint.held / smallest_singular_values(geometry, motion.q))

        def amplified(motion: Motion, samples: np.ndarray) -> np.ndarray:
            which = largest[samples]
            entries = motion.jacobian.reshape(len(which), -1)[np.arange(len(which)), which]
            return np.asarray(signs[samples] * entries / room.joint.amplification)

        worst, held = least_held(geometry, probe.motion.q, LIMITS.poses)
        yield from of(not_held, worst, room.joint.held / held)
        yield from of(amplified, every, amplified(probe.motion, every))
    for box in room.boxes:
        out_of = partial(_out_of, geometry, box)
        yield from of(out_of, every, out_of(probe.motion, every))


def _out_of(geometry: Geometry, box: Box, motion: Motion, _: np.ndarray) -> np.ndarray:
    """The used share (m,) of a box's room: 1 at its walls."""
    width = max(high - low for low, high in zip(box.low, box.high, strict=True))
    return 1.0 + outside(box, tool_positions(geometry, motion)) / width


def _of_torques(search: Search, probe: _Perturbed, basis: np.ndarray, sizes: np.ndarray) -> Linear:
    """Torques of the motors."""
    scale = search.nominal.gains / search.room.torque
    present = probe.shown.current * scale
    values, slopes = [], []
    for i in np.flatnonzero(np.isfinite(search.room.torque)):
        near = np.flatnonzero(np.abs(present[:, i]) > SEARCH.near)
        sign = np.sign(present[near, i])
        slope = np.zeros((len(near), *sizes.shape))
        for order, j in np.ndindex(3, sizes.shape[1]):
            change = (probe.showing[order][j].current[near, i] - probe.shown.current[near, i]) * scale[i]
            rate = sign * change / probe.steps[order, j]
            slope[:, :, j] += rate[:, None, None] * basis[order][near] * sizes[:, j]
        values.append(np.abs(present[near, i]))
        slopes.append(slope.reshape(len(near), sizes.size))
    return Linear(np.concatenate(values), np.vstack(slopes))


def _of_bands(
    search: Search, trajectory: FourierTrajectory, probe: _Perturbed, basis: np.ndarray, sizes: np.ndarray
) -> Linear:
    """Parts of the currents above the band: see `band_shares`."""
    rate = search.shape.rate
    values = band_shares(probe.shown.current, rate, trajectory)
    near = np.flatnonzero(values > SEARCH.near)
    present = probe.shown.current[:, near]
    whole, above = current_above(present, rate, trajectory)
    of_logarithm = hann(len(present))[:, None] * (
        above / (above**2).sum(axis=0) - whole / (whole**2).sum(axis=0)
    )
    of_logarithm -= of_logarithm.mean(axis=0)  # of currents about their mean
    slopes = np.zeros((len(near), *sizes.shape))
    for order, j in np.ndindex(3, sizes.shape[1]):
        change = probe.showing[order][j].current[:, near] - present
        weights = of_logarithm * change / probe.steps[order, j]
        slopes[:, :, j] += np.einsum("tm,twk->mwk", weights, basis[order]) * sizes[:, j]
    return Linear(values[near], slopes.reshape(len(near), sizes.size) * values[near, None])


def _concatenated(parts: list[Linear]) -> Linear:
    """The limits of all motions, each by its coefficients."""
    slopes = block_diag(*(part.slopes for part in parts))
    return Linear(np.concatenate([part.values for part in parts]), slopes)
