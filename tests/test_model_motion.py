"""Following the closures: one assembly mode throughout, the same answer however it is cut, errors with a time."""

import tracemalloc
from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest

from bench.basics.errors import BenchError
from bench.model import motion as motion_module
from bench.model.bounds import NODES
from bench.model.closure import loop_residual
from bench.model.follow import advance, home_pose, make_follower
from bench.model.geometry import read_geometry
from bench.model.motion import motion_of, path_of
from tests.mechanisms import LOOPED, movement, robot_named, write_robot

CRANK, COUPLER, ROCKER, GROUND = 0.2, 0.3, 0.25, 0.5
REACH = np.arccos((CRANK**2 + GROUND**2 - (COUPLER + ROCKER) ** 2) / (2 * CRANK * GROUND))  # crank angle, rad
HOME = np.pi / 3


def four_bar(folder, gap=0.0, home=HOME):
    """A four-bar whose crank (angle 0: towards the rocker's pivot) reaches no further than REACH."""
    crank = CRANK * np.array([np.cos(home), np.sin(home)])
    ground = np.array([GROUND, 0.0])
    way = ground - crank
    distance = np.linalg.norm(way)
    along = (COUPLER**2 - ROCKER**2 + distance**2) / (2 * distance)
    across = np.sqrt(COUPLER**2 - along**2) * np.array([-way[1], way[0]]) / distance
    tip = crank + way * along / distance + across
    arm, rod, rest = crank, tip - crank, tip - ground
    body = f"""
      <worldbody>
        <body name="crank"><joint name="crank" axis="0 -1 0" ref="{home!r}"/><geom pos=".05 0 .05"/>
          <body name="coupler" pos="{arm[0]} 0 {arm[1]}"><joint name="pin" axis="0 -1 0"/><geom/>
            <site name="coupler" pos="{rod[0]} 0 {rod[1]}"/></body></body>
        <body name="rocker" pos="{GROUND} 0 0"><joint name="rocker" axis="0 -1 0"/><geom/>
          <site name="rocker" pos="{rest[0]} {gap} {rest[1]}"/></body>
      </worldbody>
      <equality><connect site1="coupler" site2="rocker"/></equality>"""
    return read_geometry(write_robot(folder, body, ("crank",)))


def along(angle, step=1e-3):
    """Time, positions, velocities and accelerations (N, 1) of one joint at `angle` (N,)."""
    velocity = np.gradient(angle, step)
    time = step * np.arange(len(angle))
    return time, angle[:, None], velocity[:, None], np.gradient(velocity, step)[:, None]


def named_time(message):
    assert message.startswith("t = ")
    return float(message.removeprefix("t = ").split(" s:")[0])


def test_unreachable_sample_is_named_with_its_time(tmp_path):
    geometry = four_bar(tmp_path)
    track = along(HOME + 0.5 * np.arange(2000) * 1e-3)
    with pytest.raises(BenchError, match=r"crank = 1\.6") as error:
        motion_of(geometry, *track)
    assert named_time(str(error.value)) == pytest.approx((REACH - HOME) / 0.5, abs=0.01)
    assert "\n" not in str(error.value)


def test_short_excursion_out_of_reach_is_named_with_its_time(tmp_path):
    """Out and back between two nodes that can both be reached."""
    geometry = four_bar(tmp_path)
    time = np.arange(4000) * 1e-3
    angle = (
        HOME + (REACH - 0.03 - HOME) * np.clip(time / 2.0, 0, 1) + 0.04 * np.exp(-(((time - 3) / 0.05) ** 2))
    )
    with pytest.raises(BenchError) as error:
        motion_of(geometry, *along(angle))
    assert np.ptp(angle[2900:3101]) < NODES.travel
    assert named_time(str(error.value)) == pytest.approx(3.0, abs=0.1)


def test_pose_next_to_the_singular_one_is_refused(tmp_path):
    """Within reach, but the passive joints move hundreds of times as fast as the crank."""
    geometry = four_bar(tmp_path)
    angle = HOME + (REACH - 1e-6 - HOME) * np.linspace(0, 1, 4000)
    with pytest.raises(BenchError, match=r"singular") as error:
        motion_of(geometry, *along(angle))
    assert named_time(str(error.value)) > 3.9


def test_rods_that_turn_fast_for_a_slide_s_travel_are_followed(tmp_path):
    """A slide that pushes two rods up, its swings short beside the machine, which stands a metre from its origin."""
    rod, apart = 0.06, 0.06
    up, side = np.sqrt(rod**2 - (apart / 2) ** 2), apart / 2
    body = f"""
      <worldbody>
        <body name="slide" pos="1 0 0"><joint name="slide" type="slide" axis="1 0 0"/><geom/>
          <body name="rod"><joint name="pin" axis="0 -1 0"/><geom/><site name="rod" pos="{side} 0 {up}"/></body></body>
        <body name="rest" pos="{1 + apart} 0 0"><joint name="rest" axis="0 -1 0"/><geom/>
          <site name="rest" pos="{-side} 0 {up}"/></body>
      </worldbody>
      <equality><connect site1="rod" site2="rest"/></equality>"""
    geometry = read_geometry(write_robot(tmp_path, body, ("slide",)))
    time = np.arange(8000) * 1e-3
    place = 0.04 * np.sin(2 * np.pi * 0.5 * time) * np.sin(2 * np.pi * 0.11 * time)
    motion = motion_of(geometry, *along(place))
    turned = np.arccos((apart - place) / (2 * rod)) - np.arccos(apart / (2 * rod))
    names = [joint.name for joint in geometry.joints]
    np.testing.assert_allclose(motion.q[:, geometry.joints[names.index("pin")].q.start], turned, atol=1e-9)
    np.testing.assert_allclose(motion.q[:, geometry.joints[names.index("rest")].q.start], -turned, atol=1e-9)


def test_open_home_is_refused(tmp_path):
    with pytest.raises(BenchError, match="not closed at home"):
        motion_of(four_bar(tmp_path, gap=0.02), *along(np.full(3, HOME)))


def test_crank_turns_with_its_offset(tmp_path):
    """The four-bar's angles from trigonometry alone."""
    geometry = four_bar(tmp_path)
    angle = HOME + 0.4 * np.sin(np.linspace(0.0, 6.0, 3000))
    motion = motion_of(geometry, *along(angle, step=2e-3))
    crank = CRANK * np.exp(1j * angle)
    way = GROUND - crank
    distance = np.abs(way)
    cosine = (COUPLER**2 + distance**2 - ROCKER**2) / (2 * COUPLER * distance)
    coupler = np.angle(way) + np.arccos(cosine)
    assert np.abs(np.diff(coupler - angle) - np.diff(motion.q[:, 1])).max() < 1e-12


def unguided_newton(follower, target):
    """Newton from home, as far as it likes to go: the closing that the model must not do."""
    geometry = follower.geometry
    q = geometry.home.copy()
    q[geometry.active_configuration] = target
    for _ in range(50):
        residual, jacobian = follower.linearise(q)
        step = np.zeros(geometry.nv)
        step[geometry.passive] = np.linalg.lstsq(jacobian[:, geometry.passive], -residual)[0]
        q = pin.integrate(follower.model, q, step)
    return q


def mode(q):
    """On which side of the line between its elbows the five-bar's tip lies."""
    left, left_elbow, right, _ = q.T
    elbows = [side + 0.2 * np.exp(1j * angle) for side, angle in ((-0.06, left), (0.06, right))]
    tip = elbows[0] + 0.3 * np.exp(1j * (left + left_elbow))
    return np.sign(((tip - elbows[0]) * np.conj(elbows[1] - elbows[0])).imag)


def test_one_assembly_mode_where_separate_closing_jumps(tmp_path):
    geometry = read_geometry(robot_named("five_bar", tmp_path))
    track = movement(geometry, size=0.7)
    motion = motion_of(geometry, *track)
    home = mode(geometry.home[None])
    assert np.all(mode(motion.q) == home)
    assert np.abs(np.diff(motion.q, axis=0)).max() < 0.02
    follower = make_follower(geometry)
    alone = np.array([unguided_newton(follower, target) for target in track[1][::20]])
    closed = np.abs(loop_residual(geometry, alone.T)).max(axis=0) < 1e-9
    jumped = np.mean(mode(alone[closed]) != home)
    assert jumped > 0.01


def test_far_targets_are_reached_in_the_same_mode(tmp_path):
    """In one call, from home past the joint ranges and past singular poses: steps that would leap are cut."""
    geometry = read_geometry(robot_named("five_bar", tmp_path))
    follower = make_follower(geometry)
    home = home_pose(follower)
    ways = np.random.default_rng(1).uniform(-2.2, 2.2, size=(1000, 2))
    reached = [advance(follower, home, home.q[geometry.active_configuration] + way) for way in ways]
    assert np.mean([share == 1.0 for _, share in reached]) > 0.95
    assert np.all(mode(np.array([pose.q for pose, _ in reached])) == mode(home.q[None]))


@pytest.mark.parametrize("name", LOOPED)
def test_answer_does_not_depend_on_where_it_is_cut(name, tmp_path, monkeypatch):
    geometry = read_geometry(robot_named(name, tmp_path))
    track = movement(geometry)
    whole = motion_of(geometry, *track)
    tail = motion_of(geometry, *(part[777:] for part in track))
    monkeypatch.setattr(motion_module, "NODES", replace(NODES, block=100, stride=3))
    blocks = motion_of(geometry, *track)
    for field in ("q", "v", "a", "jacobian"):
        assert np.abs(getattr(whole, field)[777:] - getattr(tail, field)).max() < 2e-8
        assert np.abs(getattr(whole, field) - getattr(blocks, field)).max() < 2e-8


def test_a_block_finds_the_memory_of_the_one_before_free(tmp_path, monkeypatch):
    geometry = read_geometry(robot_named("stewart", tmp_path))
    path = path_of(geometry, *movement(geometry))
    samples = len(path.track.time)

    def beside_the_motion(block):
        monkeypatch.setattr(motion_module, "NODES", replace(NODES, block=block))
        path.motion(slice(None))  # what is kept from one time to the next
        tracemalloc.start()
        try:
            found = path.motion(slice(None))
            largest = tracemalloc.get_traced_memory()[1]
        finally:
            tracemalloc.stop()
        return largest - sum(getattr(found, field).nbytes for field in ("q", "v", "a", "jacobian"))

    assert beside_the_motion(-(-samples // 4)) < 0.28 * beside_the_motion(samples)


@pytest.mark.parametrize("name", LOOPED)
def test_noisy_positions_are_closed_as_they_are(name, tmp_path):
    """Velocities that have nothing to do with the positions cost time, not accuracy."""
    geometry = read_geometry(robot_named(name, tmp_path))
    time, position, velocity, acceleration = movement(geometry)
    noisy = position + 1e-4 * np.random.default_rng(8).normal(size=position.shape)
    motion = motion_of(geometry, time, noisy, 0.0 * velocity, acceleration)
    assert np.abs(loop_residual(geometry, motion.q.T)).max() < 1e-11
    assert np.abs(motion.q[:, geometry.active_configuration] + geometry.active_offset - noisy).max() < 1e-15


@pytest.mark.parametrize("name", LOOPED)
def test_few_samples(name, tmp_path):
    geometry = read_geometry(robot_named(name, tmp_path))
    track = movement(geometry)
    whole = motion_of(geometry, *track)
    for samples in ([1200], [1200, 1201], [0, 0 + 900, 1900]):
        few = motion_of(geometry, *(part[samples] for part in track))
        assert np.abs(few.q - whole.q[samples]).max() < 1e-11
        assert np.abs(few.a - whole.a[samples]).max() < 1e-7


@pytest.mark.parametrize("name", LOOPED)
def test_standstill(name, tmp_path):
    geometry = read_geometry(robot_named(name, tmp_path))
    time, position, velocity, acceleration = movement(geometry)
    still = np.repeat(position[:1], len(time), axis=0)
    motion = motion_of(geometry, time, still, 0 * velocity, 0 * acceleration)
    assert np.abs(motion.q - motion.q[0]).max() < 1e-12
    assert np.abs(motion.v).max() == 0.0
    assert np.abs(motion.a).max() == 0.0
