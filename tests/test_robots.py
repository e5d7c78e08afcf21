"""The built-in robots: every one loads, is assembled at home, and has the published dimensions."""

import re
from pathlib import Path

import mujoco
import numpy as np
import pytest

from bench.dataset.catalogue import built_in_robots
from bench.dataset.robot import load_robot

ROBOTS = tuple(built_in_robots())
LOOPS = {
    "crank_slide": 2,
    "delta": 6,
    "dualv": 3,
    "emps": 0,
    "five_bar": 1,
    "orthoglide": 6,
    "palletiser": 3,
    "stewart": 6,
    "three_rrr": 2,
    "two_link": 0,
    "wrist": 0,
}
COUPLINGS = {"wrist": 3}
TREE_DOF = {
    "crank_slide": 6,
    "delta": 21,
    "dualv": 9,
    "emps": 1,
    "five_bar": 4,
    "orthoglide": 21,
    "palletiser": 10,
    "stewart": 24,
    "three_rrr": 7,
    "two_link": 2,
    "wrist": 6,
}


def compiled(name: str) -> mujoco.MjModel:
    return load_robot(name).mjcf_model()


def at_home(model: mujoco.MjModel) -> mujoco.MjData:
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key("home").id)
    mujoco.mj_forward(model, data)
    return data


def loop_gaps(model: mujoco.MjModel, data: mujoco.MjData) -> np.ndarray:
    """Distance of the two sites of every connect, m; all equalities but couplings are such."""
    loops = model.eq_type != mujoco.mjtEq.mjEQ_TENDON
    assert (model.eq_type[loops] == mujoco.mjtEq.mjEQ_CONNECT).all()
    assert (model.eq_objtype[loops] == mujoco.mjtObj.mjOBJ_SITE).all()
    apart = data.site_xpos[model.eq_obj1id[loops]] - data.site_xpos[model.eq_obj2id[loops]]
    return np.linalg.norm(apart, axis=-1)


def distance(data: mujoco.MjData, first: str, second: str) -> float:
    return float(np.linalg.norm(data.body(first).xpos - data.body(second).xpos))


@pytest.mark.parametrize("name", ROBOTS)
def test_loads_by_name_and_by_path(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    robot = load_robot(name)
    assert robot.name == robot.folder.name == name
    assert robot.nominal_gains.shape == (len(robot.joints),)
    assert load_robot(robot.folder) == robot
    assert load_robot(robot.folder / "robot.toml") == robot
    assert load_robot(name, relative_to=robot.folder) == robot
    assert load_robot(f"../{name}", relative_to=robot.folder) == robot


@pytest.mark.parametrize("name", ROBOTS)
def test_home_is_assembled(name: str) -> None:
    model = compiled(name)
    assert (model.neq, model.nv) == (LOOPS[name] + COUPLINGS.get(name, 0), TREE_DOF[name])
    assert loop_gaps(model, at_home(model)).max(initial=0) < 1e-9


@pytest.mark.parametrize("name", ROBOTS)
def test_driven_joints_have_ranges_that_hold_home(name: str) -> None:
    model = compiled(name)
    data = at_home(model)
    for joint in load_robot(name).driven:
        assert model.joint(joint).limited[0]
        low, high = model.joint(joint).range
        assert low < data.joint(joint).qpos[0] < high


@pytest.mark.parametrize("name", ROBOTS)
def test_nothing_is_hidden_in_the_mjcf(name: str) -> None:
    model = compiled(name)
    assert model.nu == 0
    assert not model.dof_damping.any()
    assert not model.dof_frictionloss.any()
    assert not model.jnt_stiffness.any()
    assert (model.opt.density, model.opt.viscosity) == (0, 0)
    assert not model.geom_contype.any()
    assert not model.geom_conaffinity.any()
    assert model.opt.jacobian == mujoco.mjtJacobian.mjJAC_DENSE
    assert model.opt.integrator == mujoco.mjtIntegrator.mjINT_EULER


@pytest.mark.parametrize("name", [name for name in ROBOTS if name not in COUPLINGS])
def test_loops_stay_closed_in_motion(name: str) -> None:
    """A second under a joint controller, faster than a usual trajectory, at the step of the MJCF."""
    model = compiled(name)
    data = at_home(model)
    driven = [model.joint(joint) for joint in load_robot(name).joints]
    q = np.array([joint.qposadr[0] for joint in driven])
    v = np.array([joint.dofadr[0] for joint in driven])
    middle = data.qpos[q].copy()
    low, high = np.array([joint.range for joint in driven]).T
    swing = 0.3 * np.minimum(middle - low, high - middle)
    mass = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, mass)
    stiffness = np.full(len(q), 60.0**2) * np.maximum(mass[v, v], 0.01)
    worst = 0.0
    for _ in range(round(1 / model.opt.timestep)):
        aim = middle + swing * min(data.time, 0.5) * np.sin(9 * data.time + np.arange(len(q)))
        data.qfrc_applied[v] = stiffness * (aim - data.qpos[q]) - stiffness / 30 * data.qvel[v]
        mujoco.mj_step(model, data)
        worst = max(worst, loop_gaps(model, data).max(initial=0))
    assert np.abs(data.qpos[q] - middle).max() > 0.01 * swing.max(), "the controller moves nothing"
    assert worst < 5e-6


def test_five_bar_has_the_dimensions_of_its_description() -> None:
    model = compiled("five_bar")
    data = at_home(model)
    assert distance(data, "left_crank", "right_crank") == pytest.approx(0.12, abs=1e-12)
    tool = data.site("tool").xpos
    for side in ("left", "right"):
        assert distance(data, f"{side}_crank", f"{side}_rod") == pytest.approx(0.20, abs=1e-12)
        assert np.linalg.norm(tool - data.body(f"{side}_rod").xpos) == pytest.approx(0.30, abs=1e-12)
        assert model.body(f"{side}_crank").mass[0] == pytest.approx(1.2, rel=0.03)
        assert model.body(f"{side}_rod").mass[0] == pytest.approx(0.9, rel=0.03)
    assert tool[2] < -0.3
    axes = data.xaxis
    assert np.abs(axes @ model.opt.gravity).max() == 0, "gravity acts in the plane of motion"


def test_delta_has_the_dimensions_of_an_rl5_1450() -> None:
    model = compiled("delta")
    data = at_home(model)
    for leg in (1, 2, 3):
        arm = data.body(f"arm_{leg}")
        assert np.linalg.norm(arm.xpos) == pytest.approx(0.330, abs=1e-12)
        assert model.body(f"arm_{leg}").mass[0] == 3.696
        assert model.body(f"elbow_pin_{leg}").mass[0] == 0.226
        assert distance(data, f"arm_{leg}", f"elbow_pin_{leg}") == pytest.approx(0.420, abs=1e-12)
        assert model.joint(f"motor_{leg}").armature[0] == pytest.approx(55**2 * 2.07e-4, rel=1e-12)
        sockets = []
        for rod in (f"{leg}a", f"{leg}b"):
            socket = data.site(f"socket_{rod}").xpos
            assert np.linalg.norm(socket - data.body(f"rod_{rod}").xpos) == pytest.approx(1.055, abs=1e-12)
            assert model.body(f"rod_{rod}").mass[0] == 0.525
            assert model.body(f"rod_{rod}").jntnum[0] == 2
            sockets.append(socket)
        middle = np.mean(sockets, axis=0) - data.body("platform").xpos
        assert np.linalg.norm(middle) == pytest.approx(0.125, abs=1e-12)
    platform = model.body("platform")
    assert platform.mass[0] == 2.916
    assert platform.parentid[0] == 0
    assert model.joint("platform").type[0] == mujoco.mjtJoint.mjJNT_FREE
    assert -0.85 <= data.body("platform").xpos[2] <= -0.75


def test_palletiser_has_the_dimensions_of_an_irb_460() -> None:
    model = compiled("palletiser")
    data = at_home(model)
    assert data.body("arm").xpos == pytest.approx([0.260, 0, 0.745], abs=1e-12)
    assert distance(data, "arm", "forearm") == pytest.approx(0.945, abs=1e-12)
    assert distance(data, "forearm", "head") == pytest.approx(1.025, abs=1e-12)
    assert data.body("flange").xpos - data.body("head").xpos == pytest.approx([0.225, 0, -0.2515], abs=1e-12)
    assert data.body("head").xmat == pytest.approx(np.eye(3).ravel(), abs=1e-12), "the linkage keeps it level"


def test_wrist_has_the_gears_and_the_coupling_of_a_tx40() -> None:
    robot = load_robot("wrist")
    assert [actuator.drives for actuator in robot.actuators] == ["tendon"] * 3
    model = compiled("wrist")
    data = at_home(model)
    data.joint("joint_4").qpos[0], data.joint("joint_5").qpos[0], data.joint("joint_6").qpos[0] = (
        0.2,
        0.3,
        0.5,
    )
    mujoco.mj_fwdPosition(model, data)
    lengths = [data.ten_length[model.tendon(name).id] for name in robot.joints]
    assert lengths == pytest.approx([-48 * 0.2, 45 * 0.3, 32 * (0.3 + 0.5)])


def test_stewart_has_the_dimensions_of_its_description() -> None:
    model = compiled("stewart")
    data = at_home(model)
    platform = data.body("platform").xpos
    assert platform == pytest.approx([0, 0, 0.65], abs=1e-12)
    for leg in range(1, 7):
        foot, ball = data.body(f"leg_{leg}").xpos, data.site(f"socket_{leg}").xpos
        assert np.linalg.norm(foot) == pytest.approx(0.40, abs=1e-12)
        assert np.linalg.norm(ball - platform) == pytest.approx(0.22, abs=1e-12)
        along = data.joint(f"axis_{leg}").xaxis
        assert along == pytest.approx((ball - foot) / np.linalg.norm(ball - foot), abs=1e-12)
        assert model.joint(f"axis_{leg}").armature[0] == 12


def test_three_rrr_has_the_dimensions_of_its_description() -> None:
    model = compiled("three_rrr")
    data = at_home(model)
    middle = data.site("tool").xpos[:2]
    assert middle == pytest.approx([0, 0], abs=1e-12)
    ends = [data.body("platform").xpos, data.site("socket_2").xpos, data.site("socket_3").xpos]
    for leg, end in enumerate(ends, start=1):
        assert np.linalg.norm(data.body(f"crank_{leg}").xpos) == pytest.approx(0.30, abs=1e-12)
        assert distance(data, f"crank_{leg}", f"rod_{leg}") == pytest.approx(0.18, abs=1e-12)
        assert np.linalg.norm(end - data.body(f"rod_{leg}").xpos) == pytest.approx(0.25, abs=1e-12)
        assert np.linalg.norm(end[:2]) == pytest.approx(0.12, abs=1e-12)
    assert (data.xaxis == [0, 0, 1]).all(), "gravity acts along the hinges"


def test_dualv_has_the_dimensions_of_its_description() -> None:
    model = compiled("dualv")
    data = at_home(model)
    ends = data.site("left_end").xpos, data.site("right_end").xpos
    assert np.linalg.norm(ends[0] - ends[1]) == pytest.approx(0.18, abs=1e-12)
    assert (ends[0] + ends[1])[:2] == pytest.approx([0, 0], abs=1e-12)
    for leg in range(1, 5):
        assert np.abs(data.body(f"crank_{leg}").xpos) == pytest.approx([0.27, 0.27, 0], abs=1e-12)
        assert distance(data, f"crank_{leg}", f"rod_{leg}") == pytest.approx(0.18, abs=1e-12)
        reach = np.linalg.norm(ends[leg > 2] - data.body(f"rod_{leg}").xpos)
        assert reach == pytest.approx(0.28, abs=1e-12)
    robot = load_robot("dualv")
    assert robot.driven == ("motor_1", "motor_2", "motor_3", "motor_4")
    assert [one.joint for one in robot.redundant] == ["motor_4"]


def test_emps_has_the_published_gain() -> None:
    robot = load_robot("emps")
    assert robot.nominal_gains.tolist() == [35.15065]
    assert robot.actuators[0].gain_unit == "N/V"
    assert compiled("emps").body("carriage").mass[0] == pytest.approx(95, abs=0.5)


def test_the_table_of_the_readme_names_every_robot_in_order(project_root: Path) -> None:
    folder = project_root / "robots"
    table = re.findall(
        r"^\| \[`(\w+)`\].*?src=\"(\S+)\".*?\| (\d) \w+ \| (\d+) \| (\w+)",
        (folder / "README.md").read_text(encoding="utf-8"),
        re.MULTILINE,
    )
    expected = [
        (
            name,
            f"{name}/{name}.png",
            str(len(load_robot(name).driven)),
            str(TREE_DOF[name]),
            str(LOOPS[name] or COUPLINGS.get(name) or "none"),
        )
        for name in ROBOTS
    ]
    assert table == expected
    for _, picture, *_ in table:
        assert 0 < (folder / picture).stat().st_size < 60_000
