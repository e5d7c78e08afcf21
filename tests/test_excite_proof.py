"""Limits that are proven at every time: what happens between samples is caught, and bounds are near."""

from dataclasses import replace

import mujoco
import numpy as np
import pytest

from bench.basics.errors import BenchError
from bench.dataset.robot import load_robot
from bench.excitation.experiment import open_limits, proof, search
from bench.excitation.experiment.between_samples import intervals_of, motor_balls
from bench.excitation.experiment.enclosed_loops import enclosed, follows, pose_sets
from bench.excitation.experiment.enclosed_torques import enclosed_torques
from bench.excitation.experiment.nominal import seen
from bench.excitation.experiment.open_limits import Kept, margins
from bench.excitation.experiment.plan import nominal_machine
from bench.excitation.experiment.proof import Promise, Proof, Unproven, prove
from bench.excitation.experiment.proof_words import limit_in_words, made_smaller, refused
from bench.excitation.experiment.request import Box, ExperimentTable
from bench.excitation.experiment.room import filled, robot_motion, room_of, tool_positions
from bench.model.configuration import displacements, integrate
from bench.model.mobility import smallest_singular_values
from bench.model.motion import Motion, motion_of
from bench.model.passive_ranges import PassiveRange, passive_ranges
from bench.scenario.trajectory import random_trajectory
from tests.mechanisms import BALL as BALL_JOINT
from tests.mechanisms import random_open_poses, to_mujoco, write_robot

ROBOTS = (
    "delta",
    "emps",
    "five_bar",
    "orthoglide",
    "palletiser",
    "stewart",
    "three_rrr",
    "two_link",
    "wrist",
)
DURATION = 1.6
QUICK = {"duration": DURATION, "ramp": 0.5, "harmonics": 4, "velocity": 1.0, "acceleration": 20.0}
BALL = {"mass": 1.0, "center_of_mass": [0.0, 0.0, 0.03], "inertia": [4e-4, 4e-4, 4e-4, 0, 0, 0]}
NEAR = 1.005  # times the true extreme: where halving must end
DENSE = 100_000  # Hz


class Case:
    """A robot with a motion that keeps its own limits."""

    def __init__(self, name, **changes):
        table = ExperimentTable.model_validate({**QUICK, **changes})
        robot = load_robot(name) if isinstance(name, str) else name
        self.nominal = nominal_machine(robot, table, [], {})
        self.geometry = self.nominal.model.geometry
        self.room = room_of(self.geometry, table)
        room, slow = self.room, self.room.velocity.min() / self.room.velocity
        trajectory = random_trajectory(
            4,
            room.home,
            room.joint.high - room.joint.low,
            room.velocity * slow,
            acceleration_limit=room.acceleration,
            harmonics=4,
            base_frequency=0.7,
            duration=DURATION,
            ramp=0.5,
        )
        trajectory = filled(room, trajectory)
        times = np.linspace(0.0, DURATION, 401)
        while robot_motion(self.geometry, room, trajectory, times) is None:
            trajectory = replace(trajectory, a=0.8 * trajectory.a, b=0.8 * trajectory.b)
        self.trajectory = trajectory

    def promise(self, payload=None, **limits):
        return Promise(self.nominal, replace(self.room, **limits), self.trajectory, payload)

    def poses(self, times):
        """Closed poses (K, nq) at the times (K,)."""
        time = np.union1d(np.linspace(0.0, DURATION, 4001), times)
        motion = motion_of(self.geometry, time, *self.trajectory.evaluate(time))
        return motion.q[np.searchsorted(time, times)]

    def dense(self, first=0.0, last=DURATION, rate=DENSE):
        time = np.linspace(first, last, int((last - first) * rate) + 1)
        whole = np.linspace(0.0, DURATION, 4001)
        motion = motion_of(
            self.geometry, np.union1d(whole, time), *self.trajectory.evaluate(np.union1d(whole, time))
        )
        return motion.at(np.searchsorted(motion.time, time))


@pytest.fixture(scope="module", params=ROBOTS)
def case(request):
    name = request.param
    carried = {} if name == "emps" else {"payload": BALL}
    return Case(name, **carried)


def enclosure_of(case, rate=1000.0, window=slice(None)):
    intervals = intervals_of(case.trajectory, rate)
    motion = motion_of(case.geometry, intervals.middle, *case.trajectory.evaluate(intervals.middle))
    return enclosure_at(case, intervals.at(np.arange(len(intervals.half))[window]), motion.at(window))


def enclosure_at(case, intervals, motion):
    motors = motor_balls(case.trajectory, intervals)
    sets = pose_sets(case.geometry, intervals, motors, motion)
    return intervals, sets, enclosed(case.geometry, intervals, motors, motion, sets, rates=True)


def test_intervals_hold_all_that_a_dense_sampling_shows(case):
    """Poses, speeds, accelerations, loop Jacobians and torques at 100 kHz lie in their intervals' bounds."""
    window = slice(3500, 3560)
    intervals, sets, enclosure = enclosure_of(case, rate=8000.0, window=window)
    assert sets.held.all()
    assert follows(case.geometry, intervals, enclosure.motion, enclosure.strays, sets.reach).all()
    first, last = intervals.middle[0] - intervals.half[0], intervals.middle[-1] + intervals.half[-1]
    motion = case.dense(first + 1e-9, last - 1e-9)
    at = np.clip(np.searchsorted(intervals.middle + intervals.half, motion.time), 0, len(intervals.half) - 1)
    for name, radius in (("q", enclosure.q), ("v", enclosure.v), ("a", enclosure.a)):
        off = np.abs(getattr(motion, name) - getattr(enclosure.motion, name)[at])
        assert np.all(off <= radius[at] + 1e-9), name
    for end in (-1.0, 1.0):
        there = case.poses(intervals.middle + end * intervals.half)
        goes_on = integrate(case.geometry, enclosure.motion.q.T, end * intervals.half * enclosure.motion.v.T)
        off = np.abs(displacements(case.geometry, goes_on, there.T)).T
        assert np.all(off <= enclosure.strays + 1e-9)
    off = np.abs(motion.jacobian - enclosure.motion.jacobian[at])
    assert np.all(off <= enclosure.jacobian[at] + 1e-9)
    load = next(iter(case.nominal.payloads), None)
    _, largest = enclosed_torques(case.nominal, load, enclosure)
    torque = np.abs(seen(case.nominal, motion, load).current * case.nominal.gains)
    assert np.all(torque <= largest[at] + 1e-9 * np.abs(torque).max())


@pytest.mark.slow
def test_a_limit_just_above_what_is_reached_is_proven_and_one_below_is_not(case):
    """Torques and loop amplification: halved, the bounds are within 0.5 % of the extremes of a dense sampling."""
    load = next(iter(case.nominal.payloads), None)
    motion = case.dense(rate=20_000)
    torque = np.abs(seen(case.nominal, motion, load).current * case.nominal.gains).max(axis=0)
    assert isinstance(prove(case.promise(load, torque=torque * NEAR)), Proof)
    told = prove(case.promise(load, torque=torque / NEAR))
    assert isinstance(told, Unproven)
    assert told.limit is Kept.TORQUE
    assert told.where in case.geometry.robot.joints
    if case.geometry.closed:
        largest = float(np.abs(motion.jacobian).max())
        held = float(smallest_singular_values(case.geometry, motion.q).min())
        if largest > 1.0:  # else a motor's own
            near = replace(case.room.joint, amplification=largest * NEAR, held=0.0)
            assert isinstance(prove(case.promise(joint=near)), Proof)
            over = replace(case.room.joint, amplification=largest / NEAR)
            assert prove(case.promise(joint=over)).limit is Kept.AMPLIFICATION
        near = replace(case.room.joint, held=held / NEAR)
        assert isinstance(prove(case.promise(joint=near)), Proof)
        over = replace(case.room.joint, held=held * NEAR)
        assert prove(case.promise(joint=over)).limit is Kept.SINGULAR


@pytest.fixture(scope="module")
def delta():
    return Case("delta")


def between_two_samples(values, time, rate=1000.0):
    """A level that values (N,) exceed only between two samples of a rate: at their highest point."""
    samples = np.interp(np.arange(0.0, time[-1], 1.0 / rate), time, values)
    assert values.max() > samples.max()
    return 0.5 * (values.max() + samples.max())


def test_a_wall_that_is_passed_between_two_samples_only_is_caught(delta):
    """A box of which the tool is outside for a part of a millisecond."""
    motion = delta.dense()
    height = tool_positions(delta.geometry, motion)[:, 2]
    high = between_two_samples(height, motion.time)
    wall = Box(low=(-9.0, -9.0, -9.0), high=(9.0, 9.0, high))
    told = prove(delta.promise(boxes=(wall,)))
    assert isinstance(told, Unproven)
    assert (told.limit, told.where) == (Kept.WORKSPACE, "0")
    assert told.time == pytest.approx(motion.time[height.argmax()], abs=2e-3)
    roomy = Box(low=(-9.0, -9.0, -9.0), high=(9.0, 9.0, height.max() + 1e-5))
    assert isinstance(prove(delta.promise(boxes=(roomy,))), Proof)
    obstacle = Box(keep="outside", low=(-9.0, -9.0, high), high=(9.0, 9.0, 9.0))
    assert prove(delta.promise(boxes=(obstacle,))).limit is Kept.WORKSPACE
    beyond = Box(keep="outside", low=(-9.0, -9.0, height.max() + 1e-5), high=(9.0, 9.0, 9.0))
    assert isinstance(prove(delta.promise(boxes=(beyond,))), Proof)


def test_currents_and_singular_poses_between_two_samples_only_are_caught():
    case = Case("five_bar")
    motion = case.dense()
    torque = np.abs(seen(case.nominal, motion, None).current * case.nominal.gains)
    limits = np.full(2, np.inf)
    limits[1] = between_two_samples(torque[:, 1], motion.time)
    told = prove(case.promise(torque=limits))
    assert (told.limit, told.where) == (Kept.TORQUE, "right")
    held = -smallest_singular_values(case.geometry, motion.q)
    over = replace(case.room.joint, held=-between_two_samples(held, motion.time))
    assert prove(case.promise(joint=over)).limit is Kept.SINGULAR


def test_a_loop_that_moves_faster_between_two_samples_only_is_caught():
    case = Case("stewart")
    motion = case.dense()
    sizes = np.abs(motion.jacobian).reshape(len(motion.time), -1).max(axis=1)
    over = replace(case.room.joint, amplification=between_two_samples(sizes, motion.time))
    assert prove(case.promise(joint=over)).limit is Kept.AMPLIFICATION


def test_ranges_of_passive_joints_between_two_samples_only_are_caught(delta, monkeypatch):
    motion = delta.dense()
    joint = next(
        one for one in delta.geometry.joints if one.kind == "hinge" and one.v.start in delta.geometry.passive
    )
    angle = motion.q[:, joint.q.start]

    def limited(high):
        ranges = (PassiveRange(joint.name, joint.q, joint.v, -9.0, high),)
        monkeypatch.setattr(open_limits, "passive_room", lambda _: ranges)
        return prove(delta.promise())

    told = limited(between_two_samples(angle, motion.time))
    assert (told.limit, told.where) == (Kept.PASSIVE_RANGE, joint.name)
    assert isinstance(limited(angle.max() + 1e-5), Proof)


def test_a_limit_can_be_looked_at_around_a_time_alone(delta):
    """What is exceeded there is found there; elsewhere nothing is."""
    motion = delta.dense()
    torque = np.abs(seen(delta.nominal, motion, None).current * delta.nominal.gains)
    promise = delta.promise(torque=torque.max(axis=0) / NEAR)
    told = prove(promise)
    assert told.limit is Kept.TORQUE
    there = prove(promise, around=told.time)
    assert (there.limit, there.where) == (told.limit, told.where)
    assert there.time == pytest.approx(told.time, abs=0.1)
    calm = float(motion.time[(torque / torque.max(axis=0)).max(axis=1).argmin()])
    elsewhere = prove(promise, around=calm)
    assert isinstance(elsewhere, Proof)
    assert elsewhere.intervals < prove(delta.promise()).intervals


@pytest.mark.parametrize("kept", [True, False])
def test_where_a_larger_motion_kept_no_limit_is_looked_at_first(kept, delta, monkeypatch):
    """A proof of the whole motion takes seconds, and would end there again."""
    asked = []

    def proved(_, *, around=None):
        asked.append(around)
        return Proof(1, 0.1) if kept else Unproven(Kept.TORQUE, "elbow", 1.25, True)

    monkeypatch.setattr(search, "prove", proved)
    assert isinstance(search.proven_near(delta.promise(), 1.25), Proof if kept else Unproven)
    assert asked == ([1.25, None] if kept else [1.25])


@pytest.fixture(scope="module")
def ball(tmp_path_factory):
    """A crank that drives a slide through a rod, in a ball joint that may be turned by 2 rad."""
    limited = BALL_JOINT.replace('type="ball"', 'type="ball" range="0 2"')
    return Case(write_robot(tmp_path_factory.mktemp("ball"), limited, ("crank",)))


def test_the_angle_of_a_ball_joint_is_the_one_that_mujoco_limits(ball):
    (limit,) = passive_ranges(ball.geometry)
    compiled = ball.geometry.robot.mjcf_model()
    compiled.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_EQUALITY
    compiled.jnt_margin[:] = 4.0  # every limit is a constraint, however far
    data = mujoco.MjData(compiled)
    for q in random_open_poses(ball.geometry, 40).T:
        data.qpos[:] = to_mujoco(ball.geometry, q)
        mujoco.mj_forward(compiled, data)
        assert data.efc_pos[0] == pytest.approx(2.0 - limit.at(q[None])[0], abs=1e-12)


def test_ranges_of_ball_joints_are_proven(ball, monkeypatch):
    """What is reached by turning about any axis: 0.5 % less is refused, also between two samples only."""
    motion = ball.dense(rate=20_000)
    (limit,) = passive_ranges(ball.geometry)
    assert isinstance(prove(ball.promise()), Proof)
    angle = limit.at(motion.q)
    *_, enclosure = enclosure_of(ball)
    found = margins(ball.nominal, ball.room, None, enclosure)[Kept.PASSIVE_RANGE, "ball"]
    at = np.clip((motion.time * 1000.0).astype(int), 0, len(found.least) - 1)
    assert np.all(limit.high - angle >= found.least[at])

    def limited(high):
        monkeypatch.setattr(open_limits, "passive_room", lambda _: (replace(limit, high=high),))
        return prove(ball.promise())

    assert isinstance(limited(angle.max() * NEAR), Proof)
    for high in (angle.max() / NEAR, between_two_samples(angle, motion.time)):
        told = limited(high)
        assert (told.limit, told.where) == (Kept.PASSIVE_RANGE, "ball")
        assert told.time == pytest.approx(motion.time[angle.argmax()], abs=0.1)


def test_another_assembly_mode_is_none_that_follows():
    """A five-bar whose elbow is on the other side is closed, too, but no motion from home leads there."""
    case = Case("five_bar")
    intervals, sets, enclosure = enclosure_of(case)
    q = enclosure.motion.q.copy()
    motion = replace(enclosure.motion, q=q)
    assert follows(case.geometry, intervals, motion, enclosure.strays, sets.reach).all()
    q[700:, case.geometry.passive] += 0.3
    apart = ~follows(case.geometry, intervals, motion, enclosure.strays, sets.reach)
    assert np.flatnonzero(apart).tolist() == [699]


def test_margins_are_those_of_the_samples_less_what_lies_between(delta):
    *_, enclosure = enclosure_of(delta)
    wall = Box(low=(-9.0, -9.0, -9.0), high=(9.0, 9.0, 9.0))
    room = replace(delta.room, boxes=(wall,), torque=np.full(3, 100.0))
    found = margins(delta.nominal, room, None, enclosure)
    assert {limit for limit, _ in found} == {Kept.AMPLIFICATION, Kept.SINGULAR, Kept.WORKSPACE, Kept.TORQUE}
    assert isinstance(enclosure.motion, Motion)
    for margin in found.values():
        assert np.all(margin.least <= margin.middle)


def test_where_no_interval_holds_its_loops_there_are_no_margins(delta):
    """A block of time in which nothing is known yet is halved, as any other."""
    intervals, _, enclosure = enclosure_of(delta)
    wall = Box(low=(-9.0, -9.0, -9.0), high=(9.0, 9.0, 9.0))
    room = replace(delta.room, boxes=(wall,), torque=np.full(3, 100.0))
    none = np.arange(0)
    *_, nothing = enclosure_at(delta, intervals.at(none), enclosure.motion.at(none))
    found = margins(delta.nominal, room, None, nothing)
    assert set(found) == set(margins(delta.nominal, room, None, enclosure))
    assert all(margin.middle.size == margin.least.size == 0 for margin in found.values())


def test_why_loops_cannot_be_closed_is_told(delta, monkeypatch):
    def out_of_reach(*_):
        raise BenchError(
            "t = 1.5000 s: the loops of delta cannot be closed at a = 3 (singular or out of reach)"
        )

    monkeypatch.setattr(proof, "motion_of", out_of_reach)
    told = prove(delta.promise())
    assert told.limit is Kept.LOOPS
    assert limit_in_words(told).startswith(
        "the loops (t = 1.5000 s: the loops of delta cannot be closed at a = 3 ("
    )


def test_a_limit_that_stays_open_is_told_in_words():
    assert limit_in_words(Unproven(Kept.TORQUE, "elbow", 1.25, True)) == "the torque of elbow at t = 1.2500 s"
    assert limit_in_words(Unproven(Kept.WORKSPACE, "1", 0.5, False)) == "workspace[1] at t = 0.5000 s"
    assert limit_in_words(Unproven(Kept.LOOPS, "", None, True)) == "the loops"


@pytest.mark.parametrize("limit", Kept)
def test_a_motion_that_was_made_smaller_says_where_and_what_relaxes_it(limit):
    said = made_smaller("unloaded", Unproven(limit, "elbow", 2.25, True))
    assert said.startswith("The motion 'unloaded' was reduced, because at t = 2.25 s ")
    assert "--limits" in said or "MJCF" in said


@pytest.mark.parametrize("limit", Kept)
def test_a_limit_that_leaves_no_room_is_refused_with_what_relaxes_it(limit):
    said = refused(Unproven(limit, "elbow", None, True))
    assert said.startswith(limit_in_words(Unproven(limit, "elbow", None, True)))
    assert "--limits" in said or ("range` in the MJCF" in said and "home further inside" in said)
    assert "{" not in said
