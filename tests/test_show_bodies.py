"""Shapes and poses of any robot: what MuJoCo would draw, where it would draw it."""

import mujoco
import numpy as np
import pytest
import rerun as rr

from bench.dataset.recording import Recording
from bench.model.geometry import from_mujoco, read_geometry, to_mujoco
from bench.model.motion import motion_of
from bench.signals.settings import FilterSettings
from bench.viewer.body_motion import DARKEST, body_motion, placed, shapes, visible_geoms
from tests.mechanisms import NAMES, movement, robot_named

SHAPES = """
<mujoco>
  <compiler angle="degree"/>
  <asset>
    <mesh name="roof" vertex="0 0 0  0.2 0 0  0 0.1 0  0 0 0.3"/>
    <material name="coal" rgba="0.02 0.02 0.02 1"/>
    <material name="glass" rgba="0.1 0.9 0.9 0"/>
  </asset>
  <worldbody>
    <geom name="floor" type="plane" size="1 1 0.1"/>
    <geom name="wall" type="box" size="0.1 0.2 0.3" pos="1 2 3" rgba="0.2 0.4 0.6 0.5"/>
    <body name="post" pos="0 0 1"><geom name="post" type="cylinder" size="0.05 0.4"/>
      <body name="arm" pos="0 0 0.4"><joint name="arm" axis="0 1 0"/>
        <geom name="link" type="capsule" fromto="0.1 0.2 0.3 0.5 0.2 0.7" size="0.03" material="coal"/>
        <geom name="knob" type="sphere" size="0.04" pos="0.1 0 0"/>
        <geom name="egg" type="ellipsoid" size="0.01 0.02 0.03" euler="10 20 30"/>
        <geom name="roof" type="mesh" mesh="roof" pos="0.3 0.2 0.1" euler="30 40 50"/>
        <geom name="collision" type="box" size="1 1 1" group="3"/>
        <geom name="pane" type="box" size="1 1 1" material="glass"/>
      </body>
    </body>
  </worldbody>
</mujoco>
"""


@pytest.fixture(scope="module")
def model():
    return mujoco.MjModel.from_xml_string(SHAPES)


@pytest.fixture(scope="module")
def drawn(model):
    return {(model.body(one.body).name, one.name): one.archetypes for one in shapes(model)}


def values(batch):
    return np.array(batch.as_arrow_array().to_pylist(), dtype=float)


def test_what_is_hidden_is_not_drawn(model, drawn):
    assert {model.geom(int(i)).name for i in visible_geoms(model)} == {
        "wall",
        "post",
        "link",
        "knob",
        "egg",
        "roof",
    }
    assert set(drawn) == {
        ("world", "boxes"),
        ("post", "cylinders"),
        ("arm", "capsules"),
        ("arm", "ellipsoids"),
        ("arm", "mesh_0"),
    }


def test_a_capsule_lies_between_its_ends(drawn):
    (capsule,) = drawn["arm", "capsules"]
    assert isinstance(capsule, rr.Capsules3D)
    (start,), (length,) = values(capsule.translations), values(capsule.lengths)
    (x, y, z, w), rotation = values(capsule.quaternions)[0], np.empty(9)
    mujoco.mju_quat2Mat(rotation, np.array([w, x, y, z]))
    end = start + rotation.reshape(3, 3) @ [0.0, 0.0, length]
    ends = sorted([start.tolist(), end.tolist()])
    np.testing.assert_allclose(ends, [[0.1, 0.2, 0.3], [0.5, 0.2, 0.7]], atol=1e-6)
    np.testing.assert_allclose(values(capsule.radii), [0.03])


def test_boxes_cylinders_and_balls_have_their_sizes(drawn):
    (box,), (cylinder,), (balls,) = (
        drawn["world", "boxes"],
        drawn["post", "cylinders"],
        drawn["arm", "ellipsoids"],
    )
    np.testing.assert_allclose(values(box.half_sizes), [[0.1, 0.2, 0.3]])
    np.testing.assert_allclose(values(cylinder.lengths), [0.8])
    np.testing.assert_allclose(values(cylinder.radii), [0.05])
    np.testing.assert_allclose(values(balls.half_sizes), [[0.04] * 3, [0.01, 0.02, 0.03]], rtol=1e-6)


def test_a_mesh_has_its_corners_where_the_file_puts_them(drawn):
    mesh, transform = drawn["arm", "mesh_0"]
    points = values(mesh.vertex_positions)
    (x, y, z, w), rotation = values(transform.quaternion)[0], np.empty(9)
    mujoco.mju_quat2Mat(rotation, np.array([w, x, y, z]))
    placed_points = values(transform.translation)[0] + points @ rotation.reshape(3, 3).T
    turn = np.empty(4)
    mujoco.mju_euler2Quat(turn, np.radians([30.0, 40.0, 50.0]), "xyz")
    mujoco.mju_quat2Mat(rotation, turn)
    corners = np.array([[0, 0, 0], [0.2, 0, 0], [0, 0.1, 0], [0, 0, 0.3]])
    expected = [0.3, 0.2, 0.1] + corners @ rotation.reshape(3, 3).T
    distance = np.linalg.norm(placed_points[:, None] - expected, axis=2)
    assert distance.min(axis=1).max() < 1e-6
    assert distance.min(axis=0).max() < 1e-6
    assert len(points) == 12  # four sides, corners not shared
    normals = values(mesh.vertex_normals)
    np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1.0, atol=1e-6)


def test_dark_colours_are_lifted_and_others_kept(drawn):
    (box,), (capsule,) = drawn["world", "boxes"], drawn["arm", "capsules"]
    assert rgba(box) == [(51, 102, 153, 128)]
    ((red, green, blue, _),) = rgba(capsule)
    assert (0.2126 * red + 0.7152 * green + 0.0722 * blue) / 255.0 >= DARKEST - 0.01


def rgba(archetype):
    packed = archetype.colors.as_arrow_array().to_pylist()
    return [tuple(value >> shift & 255 for shift in (24, 16, 8, 0)) for value in packed]


@pytest.mark.parametrize("name", NAMES)
def test_positions_go_to_mujoco_and_back(name, tmp_path):
    robot = robot_named(name, tmp_path)
    geometry = read_geometry(robot)
    model = robot.mjcf_model()
    qpos = np.random.default_rng(1).normal(size=(5, model.nq))
    np.testing.assert_allclose(
        to_mujoco(geometry.joints, from_mujoco(geometry.joints, qpos)), qpos, rtol=0, atol=1e-15
    )


@pytest.mark.parametrize("name", NAMES)
def test_mujoco_finds_the_loops_closed_and_the_motors_where_they_were_logged(name, tmp_path):
    robot = robot_named(name, tmp_path)
    geometry = read_geometry(robot)
    model = robot.mjcf_model()
    time, position, velocity, acceleration = movement(geometry, samples=41)
    tree = motion_of(geometry, time, position, velocity, acceleration)
    qpos = to_mujoco(geometry.joints, tree.q)
    motors = [model.joint(joint).qposadr[0] for joint in robot.joints]
    np.testing.assert_allclose(qpos[:, motors], position, atol=1e-12)
    data = mujoco.MjData(model)
    gap = 0.0
    for pose in qpos:
        data.qpos[:] = pose
        mujoco.mj_forward(model, data)
        if data.ne:
            gap = max(gap, float(np.abs(data.efc_pos[: data.ne]).max()))
    assert gap < 1e-8
    motion = placed(model, robot.tool_site, time, qpos)
    np.testing.assert_allclose(motion.positions[-1], data.xpos, atol=1e-12)
    np.testing.assert_allclose(motion.quaternions[-1], np.roll(data.xquat, -1, axis=1), atol=1e-12)
    if robot.tool_site:
        assert motion.tool_position is not None
        np.testing.assert_allclose(motion.tool_position[-1], data.site(robot.tool_site).xpos, atol=1e-12)
    assert (motion.high > motion.low).all()


def test_the_box_holds_every_shape(model):
    motion = placed(model, None, np.zeros(2), np.array([[0.0], [np.pi]]))
    np.testing.assert_allclose(motion.high, [1.1, 2.2, 3.3], atol=1e-6)
    assert motion.low[2] == pytest.approx(0.6)  # the post stands on 1 - 0.4
    assert -0.6 < motion.low[0] <= -0.53  # the link, turned to the other side
    assert motion.tool_position is None


def test_frames_come_at_fifty_hertz_whatever_the_rate(tmp_path):
    robot = robot_named("serial", tmp_path)
    geometry = read_geometry(robot)
    model = robot.mjcf_model()
    for rate, step in ((1000.0, 20), (100.0, 2), (40.0, 1)):
        time = np.arange(round(4.0 * rate)) / rate
        position = 0.1 * np.sin(time)[:, None] + np.zeros(len(robot.joints))
        settings = FilterSettings(position_cutoff=0.2 * rate, decimation=1, border=(5, 5))
        motion = body_motion(
            model, geometry, Recording("a", "identify", None, time, position, position), settings
        )
        np.testing.assert_array_equal(motion.time, time[5:-5][::step])
