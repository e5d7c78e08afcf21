"""Effects of a whole robot: their columns beside the same law computed in another way."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from bench.basics.errors import BenchError
from bench.effects import CATALOGUE, EffectInstance, effect_columns, places_in, select_effects
from bench.effects.body_length import lengths, with_length
from bench.effects.laws.drive_flexibility import deflection
from bench.effects.signals import UNCHANGED, Changed, RobotSignals
from bench.effects.tool_motion import tool_motion, tool_of
from bench.identification import perturbed_observation
from bench.identification.effect_columns import PresentModel, robot_signals
from bench.model.follow import build_tree
from bench.model.geometry import read_geometry
from bench.model.model import IdentificationModel
from bench.model.motion import Motion, motion_of
from tests.bounds_kit import with_bounds
from tests.effects_kit import PAYLOAD, moving_robot, rigid_torque
from tests.mechanisms import NAMES, robot_named

INNER = slice(30, -30)
LINEARISED = {
    "backlash": "b",
    "base_tilt": "tilt_y",
    "drive_flexibility": "C",
    "encoder_offset": "offset",
    "transmission_error": "a",
}


def instances_of(name: str, robot: RobotSignals) -> tuple[EffectInstance, ...]:
    """The effect wherever it can sit in the robot; nowhere is an answer, too."""
    payloads = [] if robot.payload is None else [robot.payload]
    try:
        return select_effects([name], places_in(robot.geometry, payloads))
    except BenchError:
        return ()


def columns_at(robot: RobotSignals, name: str, place: str = "", **about: float) -> np.ndarray:
    effect = replace(CATALOGUE[name], **about)
    return effect_columns(EffectInstance(effect, place, name), robot)


def close(found: np.ndarray, expected: np.ndarray, share: float) -> None:
    scale = np.abs(expected[INNER]).max()
    assert scale > 0
    assert found[INNER] == pytest.approx(expected[INNER], abs=share * scale)


@pytest.mark.parametrize("robot_name", NAMES)
def test_columns_are_finite_of_the_right_shape_and_the_same_again(robot_name: str, tmp_path: Path) -> None:
    payload = None if robot_name in ("ball", "welded", "emps") else "disc"
    robot, _, measured, _ = moving_robot(robot_name, tmp_path, payload, samples=401)
    seen = {}
    for name in CATALOGUE:
        for instance in instances_of(name, robot):
            columns = effect_columns(instance, robot)
            assert columns.shape == (*measured.position.shape, len(instance.effect.parameters))
            seen[instance] = columns
    again, *_ = moving_robot(robot_name, tmp_path, payload, samples=401)
    for instance, columns in seen.items():
        assert np.array_equal(columns, effect_columns(instance, again)), instance.request
    motors = {instance.joint for instance in seen if instance.effect.name == "viscous_friction"}
    assert motors == {*robot.joints, *robot.redundant}


@pytest.mark.parametrize("robot_name", ["five_bar", "delta", "tilted"])
def test_what_passive_friction_takes_the_motors_deliver(robot_name: str, tmp_path: Path) -> None:
    robot, *_ = moving_robot(robot_name, tmp_path)
    for joint in places_in(robot.geometry, ()).passive:
        index = robot.geometry.joints[robot.geometry.joint_index(joint)].v.start
        speed = np.gradient(robot.tree.q[:, _configuration(robot, joint)], robot.time, edge_order=2)
        assert robot.tree.v[INNER, index] == pytest.approx(speed[INNER], abs=1e-4)
        for name, power in (("viscous", speed**2), ("coulomb", np.abs(speed))):
            columns = columns_at(robot, f"passive_{name}_friction", joint)[:, :, 0]
            close((columns * robot.velocity).sum(axis=1), power, 1e-3)


@pytest.mark.parametrize("robot_name", ["five_bar", "delta", "tilted"])
def test_the_motors_feed_the_energy_of_rotors_in_passive_joints(robot_name: str, tmp_path: Path) -> None:
    robot, *_ = moving_robot(robot_name, tmp_path)
    for joint in places_in(robot.geometry, ()).passive:
        speed = np.gradient(robot.tree.q[:, _configuration(robot, joint)], robot.time, edge_order=2)
        power = np.gradient(0.5 * speed**2, robot.time, edge_order=2)
        columns = columns_at(robot, "passive_rotor_inertia", joint)[:, :, 0]
        close((columns * robot.velocity).sum(axis=1), power, 1e-3)


def _configuration(robot: RobotSignals, joint: str) -> int:
    return robot.geometry.joints[robot.geometry.joint_index(joint)].q.start


@pytest.mark.parametrize("robot_name", ["five_bar", "delta", "orthoglide", "two_link", "tilted", "carried"])
def test_the_tool_moves_as_its_jacobian_says(robot_name: str, tmp_path: Path) -> None:
    robot, *_ = moving_robot(robot_name, tmp_path)
    position, jacobian = tool_motion(robot)
    speed = CubicSpline(robot.coarse.time, position)(robot.coarse.time, 1)
    by_motors = np.einsum("kxn,kn->kx", jacobian, robot.coarse.velocity)
    close(by_motors, speed, 1e-3)
    assert np.abs(position[0]).max() < 0.5 * np.abs(robot.geometry.home).max() + 0.5
    assert tool_of(robot.geometry) == robot.geometry.tool


def test_the_motors_feed_the_work_of_a_force_at_the_platform(tmp_path: Path) -> None:
    robot, *_ = moving_robot("delta", tmp_path)
    position, _ = tool_motion(robot)
    way = robot.refined(position)
    speed = CubicSpline(robot.time, way)(robot.time, 1)
    columns = columns_at(robot, "platform_force")
    force = np.array([1.0, -2.0, 0.5])
    stiffness = np.array([30.0, 20.0, 10.0])
    power = np.einsum("knp,kn,p->k", columns, robot.velocity, np.concatenate((force, stiffness)))
    close(power, -((force - stiffness * way) * speed).sum(axis=1), 1e-3)


def test_the_motors_feed_the_power_of_a_drag_at_the_tool(tmp_path: Path) -> None:
    robot, *_ = moving_robot("delta", tmp_path)
    position, _ = tool_motion(robot)
    speed = np.linalg.norm(CubicSpline(robot.time, robot.refined(position))(robot.time, 1), axis=1)
    power = np.einsum("kn,kn->k", columns_at(robot, "tool_drag")[:, :, 0], robot.velocity)
    close(power, speed**3, 1e-3)


@pytest.mark.parametrize(("robot_name", "place"), [("five_bar", "left_rod"), ("five_bar", "right_crank")])
def test_a_length_changed_in_the_file_gives_the_same_torque(
    robot_name: str, place: str, tmp_path: Path
) -> None:
    robot, model, measured, present = moving_robot(robot_name, tmp_path)
    change = 2e-3
    source = model.geometry.robot.model_path
    ends = {"left_rod": ("left_tip", 0.3), "right_crank": ("right_rod", 0.2)}
    name, length = ends[place]
    text = source.read_text()
    for old in (
        f'name="{name}" pos="{length} 0 0"',
        'name="tool" pos="0.3 0 0"' if place == "left_rod" else "",
    ):
        assert old in text
        text = text.replace(old, old.replace(f"{length} 0 0", f"{length + change} 0 0")) if old else text
    (tmp_path / "longer.xml").write_text(text)
    longer = read_geometry(replace(model.geometry.robot, model_path=tmp_path / "longer.xml"))
    tree = motion_of(longer, measured.time, measured.position, measured.velocity, measured.acceleration)
    expected = rigid_torque(model, present, longer, tree) - rigid_torque(
        model, present, model.geometry, robot.tree
    )
    found = columns_at(robot, "geometric_error", place, dl=change)[:, :, 0] * change
    close(found, expected, 2e-3)


def test_the_bodies_of_the_delta_have_its_maker_s_lengths(tmp_path: Path) -> None:
    geometry = read_geometry(robot_named("delta", tmp_path))
    found = {name: body.length for name, body in lengths(geometry).items()}
    assert found.pop("world") == pytest.approx(0.330, abs=1e-6)
    assert found.pop("platform") == pytest.approx(np.hypot(0.125, 0.0), abs=0.05)
    arms = [length for name, length in found.items() if name.startswith("arm")]
    rods = [length for name, length in found.items() if name.startswith("rod")]
    assert arms == pytest.approx([0.420] * 3, abs=0.02)
    assert rods == pytest.approx([1.055] * 6, abs=1e-6)


@pytest.mark.parametrize("robot_name", NAMES)
def test_a_body_with_another_length_has_that_length(robot_name: str, tmp_path: Path) -> None:
    geometry = read_geometry(robot_named(robot_name, tmp_path))
    for name, body in lengths(geometry).items():
        longer = lengths(with_length(geometry, body, 1e-3))[name]
        # of points to both sides of the direction, the farthest grows by a little less
        assert 0.3e-3 < longer.length - body.length < 1.0001e-3, name


@pytest.mark.parametrize(
    ("robot_name", "tilt"), [("five_bar", (0.0, 0.12)), ("delta", (0.1, -0.12)), ("serial", (0.05, 0.08))]
)
def test_a_tilted_base_turns_gravity(robot_name: str, tilt: tuple[float, float], tmp_path: Path) -> None:
    robot, model, _, present = moving_robot(robot_name, tmp_path)
    sx, cx, sy, cy = np.sin(tilt[0]), np.cos(tilt[0]), np.sin(tilt[1]), np.cos(tilt[1])
    about_x = np.array([[1, 0, 0], [0, cx, -sx], [0, sx, cx]])
    about_y = np.array([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]])
    gravity = (about_x @ about_y).T @ model.geometry.gravity  # in the axes of the base
    tilted = rigid_torque(model, present, replace(model.geometry, gravity=gravity), robot.tree)
    expected = tilted - rigid_torque(model, present, model.geometry, robot.tree)
    found = columns_at(robot, "base_tilt", tilt_x=tilt[0], tilt_y=tilt[1]) @ np.array(tilt)
    close(found, expected, 1e-4)
    small = columns_at(robot, "base_tilt") @ np.array(tilt)
    close(small, expected, 0.2)


def test_a_planar_robot_does_not_feel_a_tilt_out_of_its_plane(tmp_path: Path) -> None:
    robot, *_ = moving_robot("five_bar", tmp_path)
    columns = columns_at(robot, "base_tilt", tilt_x=0.3)
    assert not np.any(columns[:, :, 0])
    assert np.abs(columns[:, :, 1]).max() > 0.1


def link_behind(
    robot: RobotSignals, model: IdentificationModel, joint: str, behind: np.ndarray
) -> tuple[Motion, Motion]:
    """The motion as logged, and with one link behind its motor, differentiated by splines."""
    at = list(robot.joints).index(joint)
    shifted = [robot.position.copy(), robot.velocity.copy(), robot.acceleration.copy()]
    curve = CubicSpline(robot.time, behind)
    for order, part in enumerate(shifted):
        part[:, at] -= curve(robot.time, order)
    return robot.tree, motion_of(model.geometry, robot.time, *shifted)


def inertia_at(robot: RobotSignals, model: IdentificationModel, present: PresentModel) -> np.ndarray:
    """The inertia (N,) that the second motor turns."""
    pushed = robot.acceleration + np.eye(len(robot.joints))[1]
    faster = motion_of(model.geometry, robot.time, robot.position, robot.velocity, pushed)
    return (rigid_torque(model, present, model.geometry, faster) - robot.torque())[:, 1]


def way_through_play(time: np.ndarray, pushed: np.ndarray, play: float) -> np.ndarray:
    """What a link lags when nothing but its load moves it between two flanks, in steps of a fiftieth of a sample."""
    fine = np.linspace(time[0], time[-1], 50 * (len(time) - 1) + 1)
    step, curve = fine[1] - fine[0], CubicSpline(time, pushed)(fine)
    side = np.sign(curve[0])
    place, speed, lag = 0.5 * play * side, 0.0, np.empty(len(fine))
    for i, push in enumerate(curve):
        touching = abs(place) >= 0.5 * play
        speed = 0.0 if touching and push * place > 0.0 else speed + step * push
        place = float(np.clip(place + step * speed, -0.5 * play, 0.5 * play))
        if abs(place) >= 0.5 * play and speed * place > 0.0:
            speed = 0.0
        lag[i] = place
    return lag[::50]


@pytest.mark.parametrize(
    ("robot_name", "size", "swinging"), [("five_bar", 0.3, 1e-3), ("orthoglide", 0.15, 5e-3)]
)
def test_encoder_offset_flexibility_and_backlash_move_the_link(
    robot_name: str, size: float, swinging: float, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    robot, model, _, present = moving_robot(robot_name, tmp_path, samples=2001, size=size)
    joint = list(robot.joints)[1]
    torque = robot.torque()[:, 1]
    compliance = 2e-3 / np.abs(torque).max()
    smoothed = columns_at(robot, "drive_flexibility", joint, C=compliance)[200:-200, :, 0]
    monkeypatch.setattr("bench.effects.laws.drive_flexibility.motion_cutoff", lambda robot, joint: None)
    whole = columns_at(robot, "drive_flexibility", joint, C=compliance)[200:-200, :, 0]
    assert np.sqrt(np.mean((smoothed - whole) ** 2) / np.mean(whole**2)) < 0.01
    inertia = inertia_at(robot, model, present)
    for name, value, behind, share in (
        ("encoder_offset", 0.004, np.full(len(torque), 0.004), 1e-4),
        ("drive_flexibility", compliance, compliance * torque, swinging),
        ("backlash", 0.002, way_through_play(robot.time, torque / inertia, 0.002), 0.05),
    ):
        logged, real = link_behind(robot, model, joint, behind)
        if name == "drive_flexibility":  # the link swings on the spring, see test_effects_on_spring.py
            interval = float(np.diff(robot.time).mean())
            swung = deflection(value * torque[:, None], interval, value * inertia, 0.06)[:, 0]
            logged, real = link_behind(robot, model, joint, swung)
        expected = rigid_torque(model, present, model.geometry, real)
        expected -= rigid_torque(model, present, model.geometry, logged)
        parameter = CATALOGUE[name].parameters[0].name
        found = columns_at(robot, name, joint, **{parameter: value})[:, :, 0] * value
        scale = np.abs(expected[200:-200]).max()
        assert found[200:-200] == pytest.approx(expected[200:-200], abs=share * scale), name


@pytest.mark.parametrize("robot_name", ["five_bar", "orthoglide"])
@pytest.mark.parametrize(("size", "share"), [(1e-5, 0.005), (1e-3, 0.01)])
def test_a_transmission_error_moves_the_link_with_its_wave(
    robot_name: str, size: float, share: float, tmp_path: Path
) -> None:
    robot, model, _, present = moving_robot(robot_name, tmp_path, samples=2001, size=0.15)
    joint = list(robot.joints)[1]
    turn = 1.0 if robot.joints[joint].rotates else 2 * np.pi
    values, logged = np.array([2.0, -1.0]) * size, robot.position[:, 1]
    true = logged
    for _ in range(30):
        true = logged - values[0] * np.cos(20.0 * true) - values[1] * np.sin(20.0 * true)
    before, real = link_behind(robot, model, joint, logged - true)
    expected = rigid_torque(model, present, model.geometry, real)
    expected -= rigid_torque(model, present, model.geometry, before)
    about = {"a": values[0], "b": values[1]}
    found = columns_at(robot, "transmission_error", joint, periods=20.0 / turn, **about) @ values
    scale = np.abs(expected[200:-200]).max()
    assert found[200:-200] == pytest.approx(expected[200:-200], abs=share * scale)


def test_a_wrong_mass_of_the_payload_is_its_share_of_the_payload_s_torque(tmp_path: Path) -> None:
    robot, *_ = moving_robot("five_bar", tmp_path, "disc")
    columns = columns_at(robot, "payload_mass_error", "disc")[:, :, 0]
    heavier, *_ = moving_robot("five_bar", tmp_path, "disc")
    assert columns * PAYLOAD[0] == pytest.approx(heavier.payload_torque)
    empty, model, _, present = moving_robot("five_bar", tmp_path)
    carried = robot.torque() - rigid_torque(model, present, model.geometry, empty.tree)
    assert robot.payload_torque == pytest.approx(carried, abs=1e-9)
    assert not np.any(columns_at(empty, "payload_mass_error", "disc"))


@pytest.mark.parametrize("name", LINEARISED)
def test_columns_linearised_about_zero_are_the_limit_of_those_about_small_values(
    name: str, tmp_path: Path
) -> None:
    robot, *_ = moving_robot("five_bar", tmp_path)
    place = "" if name == "base_tilt" else "left"
    parameter = LINEARISED[name]
    size = {"drive_flexibility": 1e-3 / np.abs(robot.coarse.torque[:, 0]).max()}.get(name, 2e-3)
    zero, small = columns_at(robot, name, place), columns_at(robot, name, place, **{parameter: size})
    close(small, zero, 0.05)
    huge = columns_at(robot, name, place, **{parameter: 1e6})  # a fit gone astray
    assert np.isfinite(huge).all()


def test_effects_are_refused_where_they_cannot_sit(tmp_path: Path) -> None:
    places = places_in(read_geometry(robot_named("emps", tmp_path)), ())
    for request, message in (
        ("passive_viscous_friction", "no joint without a motor"),
        ("payload_mass_error", "no payload of known mass"),
        ("platform_force:axis", "only the robot as a whole"),
        ("viscous_friction:elbow", "no joint 'elbow'.*there are: axis"),
        ("glue", "unknown effect 'glue'; known: asymmetric"),
    ):
        with pytest.raises(BenchError, match=message):
            select_effects([request], places)
    with pytest.raises(BenchError, match="no body of the robot has a length"):
        select_effects(["geometric_error"], replace(places, body=()))
    with pytest.raises(BenchError, match="given twice"):
        select_effects(["viscous_friction", "viscous_friction:axis"], places)


def test_the_opened_tree_is_not_changed_by_a_changed_length(tmp_path: Path) -> None:
    geometry = read_geometry(robot_named("five_bar", tmp_path))
    before = build_tree(geometry).jointPlacements[2].translation.copy()
    with_length(geometry, lengths(geometry)["left_crank"], 0.01)
    assert np.array_equal(build_tree(geometry).jointPlacements[2].translation, before)


@pytest.mark.parametrize("name", ["drive_flexibility", "backlash"])
def test_the_rotor_does_not_follow_its_link(name: str, tmp_path: Path) -> None:
    """A motor that drives a slide with a rotor and nothing else moves the same, whatever is behind it."""
    robot, *_ = moving_robot("emps", tmp_path, samples=2001, size=0.3)
    joint = next(iter(robot.joints))
    torque = np.abs(robot.coarse.torque).max()
    about = {
        "drive_flexibility": {"C": 1e-3 / torque, "CIa": 1e-3 / torque * 1e9},
        "backlash": {"b": 1e-3, "Ia": 1e9},
    }
    rigid = {"drive_flexibility": {"C": 1e-3 / torque}, "backlash": {"b": 1e-3}}
    free = np.abs(columns_at(robot, name, joint, **about[name])[200:-200, :, 0]).max()
    held = np.abs(columns_at(robot, name, joint, **rigid[name])[200:-200, :, 0]).max()
    assert free < 1e-3 * held


def test_friction_of_a_bearing_goes_by_the_size_of_its_force(tmp_path: Path) -> None:
    robot, *_ = moving_robot("five_bar", tmp_path, "disc")
    mu, mum = 0.002, 0.003
    reaction = robot.joint_reaction("left_elbow", robot.every)
    force = np.hypot(*(reaction.force + mum / mu * reaction.of_mass).T)
    index = robot.geometry.joints[robot.geometry.joint_index("left_elbow")].v.start
    friction = mu * robot.refined(force) * np.sign(robot.tree.v[:, index])
    expected = robot.tree.jacobian[:, index] * friction[:, None]
    found = columns_at(robot, "passive_load_friction", "left_elbow", mu=mu, mum=mum) @ np.array([mu, mum])
    close(found, expected, 1e-6)
    plain = columns_at(robot, "passive_load_friction", "left_elbow") @ np.array(
        [1.0, reaction.mass]
    )  # as bars have it
    force = np.hypot(*(reaction.force + reaction.mass * reaction.of_mass).T)
    friction = robot.refined(force) * np.sign(robot.tree.v[:, index])
    close(plain, robot.tree.jacobian[:, index] * friction[:, None], 1e-6)


def test_friction_of_a_bearing_counts_what_friction_presses_on_it(tmp_path: Path) -> None:
    _, model, measured, present = moving_robot("five_bar", tmp_path, "disc")
    effects = (
        (EffectInstance(CATALOGUE["passive_coulomb_friction"], "right_elbow", "other"), np.array([0.5])),
        (EffectInstance(CATALOGUE["passive_load_friction"], "left_elbow", "own"), np.array([0.02, 0.03])),
    )
    robot = robot_signals(model, measured, replace(present, effects=effects))
    torques = robot.in_joints()
    assert set(torques) == {"left_elbow", "right_elbow"}
    reaction = robot.joint_reaction("left_elbow", robot.every)
    force = robot.refined(reaction.force + 1.5 * reaction.of_mass)
    force += sum(robot.refined(reaction.by_torque(name))[:, :, 0] * torques[name] for name in torques)
    index = robot.geometry.joints[robot.geometry.joint_index("left_elbow")].v.start
    friction = 0.02 * np.hypot(*force.T) * np.sign(robot.tree.v[:, index])
    close(torques["left_elbow"], friction[:, None], 5e-3)  # a few rounds of what presses on itself
    found = columns_at(robot, "passive_load_friction", "left_elbow", mu=0.02, mum=0.03) @ np.array(
        [0.02, 0.03]
    )
    close(found, robot.tree.jacobian[:, index] * friction[:, None], 1e-9)


@pytest.mark.parametrize(("most", "kept"), [(10**9, {0, 1, 2}), (0, {1})])
def test_large_rows_of_other_motions_make_no_room_for_themselves(tmp_path, monkeypatch, most, kept):
    monkeypatch.setattr(perturbed_observation, "TOLERANCES", with_bounds("memory", force_bytes=most))
    robot, model, measured, _ = moving_robot("delta", tmp_path)
    shifted = robot.position + 0.01, robot.velocity, robot.acceleration
    heavier = Changed(gravity=model.geometry.gravity * 1.1)
    sizes = [measured.perturbed.nbytes]
    for changed in (UNCHANGED, heavier, Changed(motion=shifted)):
        torque = robot.torque(changed)
        assert np.isfinite(torque).all()
        sizes.append(measured.perturbed.nbytes)
    assert {i for i, more in enumerate(np.diff(sizes)) if more} == kept
