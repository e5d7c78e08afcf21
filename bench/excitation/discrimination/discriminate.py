"""Design a motion that distinguishes two effects."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from bench.basics.errors import BenchError
from bench.basics.progress import SILENT, Progress
from bench.basics.threads import on_one_thread
from bench.dataset.dataset import Dataset
from bench.dataset.payload import Payload
from bench.dataset.robot import refuse_redundant
from bench.excitation.bounds import DISCRIMINATION
from bench.excitation.discrimination.evidence import error_over_noise, estimate_of_rival, shown_nats
from bench.excitation.discrimination.limits import Envelope, envelope
from bench.excitation.discrimination.predicted_currents import planned, predicted, times_of
from bench.excitation.discrimination.result import Discrimination, ImpossibleSign, MotionFacts, motion_facts
from bench.excitation.discrimination.rival_models import Rival, fit_rivals, noise_of
from bench.excitation.discrimination.search import DesignedMotion, band_of, best_loaded, best_motion, starts
from bench.excitation.discrimination.separation import Question, question, residual_share, separation
from bench.excitation.limits import feasible_motion
from bench.identification.decision import RULE
from bench.identification.problem import Problem
from bench.identification.tolerances import TOLERANCES
from bench.scenario.trajectory import FourierTrajectory

SECOND = "a second payload"


@on_one_thread
def discriminate(
    problem: Problem,
    requests: tuple[str, str],
    *,
    duration: float | None = None,
    widen: float = 1.0,
    seed: int = 0,
    progress: Progress = SILENT,
) -> Discrimination:
    """The motion for which models with either effect differ most, inside the robot's limits.

    requests: the two effects, as EFFECT or EFFECT:JOINT, in addition to those of the problem. One model, fitted to the
    given data, predicts motor currents; the difference is the part that the other, fitted again to given and new data
    together, cannot imitate, in nats, as an expected log-likelihood difference. The smaller of both directions is
    maximised. There is no motion if neither effect shows in the data and none promises evidence. duration: s, of the
    motion; widen: factor on the largest speeds, accelerations and currents of the recordings. Raises BenchError for
    effects that are unknown or equal.
    """
    if duration is not None and not duration > 0.0:
        raise BenchError(f"the duration of a motion must be positive, not {duration:g} s")
    if not widen > 0.0:
        raise BenchError(f"the factor on the limits must be positive, not {widen:g}")
    dataset = problem.dataset
    refuse_redundant(dataset.robot, "a motion that tells two effects apart")
    progress.phase("fitting both models")
    rivals = fit_rivals(replace(problem, dataset=_with_second_payload(dataset)), requests)
    first = rivals[0]
    noise, around = noise_of(rivals), envelope(first, widen)
    measured, joints = first.prepared.measured, dataset.robot.joints
    spans = [float(np.ptp(measurement.time)) for measurement in measured]
    recorded = [(entry.position, entry.velocity, entry.acceleration) for entry in measured]
    duration = duration or float(np.clip(round(max(spans)), DISCRIMINATION.shortest, DISCRIMINATION.longest))
    absorbed = tuple(rival.request for rival in rivals if rival.absorbed)
    asked: tuple[Question, ...] = (question(*rivals, noise), question(*rivals[::-1], noise))
    asked = () if absorbed else asked
    loads = list(dict.fromkeys([None, *(measurement.recording.payload for measurement in measured)]))
    progress.phase("testing whether one effect can do what the other does")
    imitated = _imitated(asked, around, loads, duration, seed)
    asked = tuple(query for query in asked if query.truth.request not in imitated)
    motion = best_motion(asked, around, loads, duration, seed, progress) if asked else None
    shown = {rival.request: 0.0 if rival.absorbed else shown_nats(rival) for rival in rivals}
    nothing = motion is not None and motion.nats < DISCRIMINATION.faint and max(shown.values()) < RULE.prior
    motion = None if nothing else motion
    result = Discrimination(
        robot=dataset.robot.name,
        effects=requests,
        error_over_noise=error_over_noise(rivals),
        shown=shown,
        nothing=nothing,
        joints={actuator.joint: actuator.gain_unit for actuator in dataset.robot.actuators},
        absorbed=absorbed,
        imitated=imitated,
        questions=asked,
        given_seconds=sum(spans),
        held_out_rows=_judged_rows(dataset, first),
        motion=motion,
        recorded=motion_facts(recorded, sum(spans), joints),
        planned={} if motion is None else _planned_facts(motion.trajectory, joints),
        second=None,
        wider=None,
        impossible=_impossible(rivals),
    )
    if motion is None or result.tells:
        return result
    heavier = _heavier(asked, around, motion, first)
    far = best_motion(asked, envelope(first, DISCRIMINATION.wider * widen), loads, duration, seed, progress)
    return replace(
        result, second=heavier, wider=None if far is None else (DISCRIMINATION.wider * widen, far.nats)
    )


def _planned_facts(trajectory: FourierTrajectory, joints: Sequence[str]) -> dict[str, MotionFacts]:
    time = np.arange(int(trajectory.duration * DISCRIMINATION.rate) + 1) / DISCRIMINATION.rate
    return motion_facts([trajectory.evaluate(time)], trajectory.duration, joints)


def _judged_rows(dataset: Dataset, rival: Rival) -> int:
    """Number of given equations on which a diagnosis judges: those of recordings that it does not fit."""
    kept = {recording.name for recording in dataset.recordings if recording.use == "validate"}
    rows = {observation.name: int(observation.moving.sum()) for observation in rival.prepared.observations}
    if not kept:
        return round(TOLERANCES.statistics.held_out * sum(rows.values()))
    return sum(count for name, count in rows.items() if name in kept)


def _with_second_payload(dataset: Dataset) -> Dataset:
    """The dataset with one more payload, heavier than all, that no recording carries."""
    known = [payload for payload in dataset.payloads.values() if payload.mass is not None]
    if dataset.robot.tool_site is None or not known:
        return dataset
    heaviest = max(known, key=lambda payload: payload.mass or 0.0)
    center = np.zeros(3) if heaviest.center_of_mass is None else heaviest.center_of_mass
    inertia = np.zeros(6) if heaviest.inertia is None else heaviest.inertia
    second = Payload(
        SECOND, DISCRIMINATION.heavier * (heaviest.mass or 0.0), center, DISCRIMINATION.heavier * inertia
    )
    return replace(dataset, payloads={**dataset.payloads, SECOND: second})


def _heavier(
    asked: Sequence[Question], around: Envelope, motion: DesignedMotion, first: Rival
) -> tuple[float, float] | None:
    """Mass of the second payload, and the nats of the same motion with it."""
    payload = first.prepared.dataset.payloads.get(SECOND)
    if payload is None or payload.mass is None:
        return None
    free = replace(around, current=np.full_like(around.current, np.inf))
    design = best_loaded(asked, free, [SECOND], motion.trajectory)
    return None if design is None else (payload.mass, design.nats)


def _imitated(
    asked: Sequence[Question], around: Envelope, loads: Sequence[str | None], duration: float, seed: int
) -> tuple[str, ...]:
    """Effects that the other one imitates completely, on a few random motions."""
    if not asked:
        return ()
    rival = asked[0].truth
    random = np.random.default_rng(seed)
    shares = {query.truth.request: 0.0 for query in asked}
    motions = range(DISCRIMINATION.alike_motions)
    for i, (_, trajectory) in zip(motions, starts(rival, around, duration, random), strict=False):
        time = times_of(trajectory, band_of(around, trajectory))
        tree = feasible_motion(rival.prepared.model.geometry, around.joint, trajectory, time)
        if tree is None:
            continue
        plan = planned(rival, trajectory, time, tree, loads[i % len(loads)])
        for query in asked:
            current = predicted(query.truth, plan)
            share = residual_share(query, plan, current, separation(query, plan, current))
            shares[query.truth.request] = max(shares[query.truth.request], share)
    return tuple(name for name, share in shares.items() if share < DISCRIMINATION.alike)


def _impossible(rivals: Sequence[Rival]) -> tuple[ImpossibleSign, ...]:
    """Evidence against an effect in the fits to the given data: an impossible sign."""
    signs = []
    for rival in rivals:
        values, covariance = estimate_of_rival(rival)
        std = np.sqrt(np.maximum(np.diag(covariance), 0.0))
        at = 0
        for instance in rival.instances:
            for parameter in instance.effect.parameters:
                if parameter.positive and values[at] < -RULE.shows * std[at]:
                    signs.append(ImpossibleSign(rival.name, parameter.name, instance.joint))
                at += 1
    return tuple(signs)
