"""Exported MJCF, URDF and tables say what was identified, and keep the rest of the user's file."""

import csv
import json
import shutil
from dataclasses import replace
from pathlib import Path

import mujoco
import numpy as np
import pinocchio as pin
import pytest
import yaml

from bench.basics.errors import BenchError
from bench.cli import main
from bench.cli.next_steps import after_export
from bench.dataset.catalogue import built_in_robots
from bench.dataset.dataset import load_dataset
from bench.dataset.robot import load_robot
from bench.effects import CATALOGUE
from bench.effects.select import EffectInstance
from bench.export.bodies import cad_prior
from bench.export.identified import EffectValues, load_identified
from bench.export.mjcf import mjcf_text, write_mjcf
from bench.export.physical import physical_set
from bench.export.placed import RULES, not_placed_lines, placed_effects
from bench.export.urdf import urdf_text
from bench.identification.identify import identify
from bench.identification.model_file import save_model
from bench.identification.prepare import prepare
from bench.identification.problem import problem_of
from bench.model.geometry import read_geometry
from bench.model.motion import Motion
from bench.model.regressor import projected_regressor
from tests.export_kit import identified, identified_file, robot_with
from tests.test_export_physical import base_of

EFFECTS = ("coulomb_friction:left", "viscous_friction:left")


def with_effects(model, *effects):
    """The model with effects of these values: (name, place, values)."""
    made = [EffectValues(EffectInstance(CATALOGUE[n], place, n), values) for n, place, values in effects]
    return replace(model, effects=tuple(made))


@pytest.mark.parametrize("name", ["five_bar", "two_link"])
def test_the_exported_file_has_the_base_parameters_and_keeps_the_rest(name, tmp_path):
    model = identified(name)
    physical = physical_set(model)
    write_mjcf(tmp_path / "out.xml", physical)
    robot = robot_with(tmp_path / "robot", tmp_path / "out.xml", name)
    geometry, prior = read_geometry(robot), cad_prior(read_geometry(robot))
    base = model.model.base
    assert base.grouping @ prior.parameters + base.rotors @ prior.rotors == pytest.approx(
        base_of(physical), rel=1e-6, abs=1e-9
    )
    before, after = model.robot.mjcf_model(), robot.mjcf_model()
    for what in (
        "body_pos",
        "jnt_pos",
        "jnt_axis",
        "jnt_range",
        "site_pos",
        "geom_size",
        "geom_pos",
        "key_qpos",
    ):
        assert getattr(after, what) == pytest.approx(getattr(before, what), rel=1e-5, abs=1e-6), what
    assert after.opt.timestep == before.opt.timestep
    assert (after.nq, after.neq, after.ngeom, after.nsite) == (
        before.nq,
        before.neq,
        before.ngeom,
        before.nsite,
    )
    assert geometry.home == pytest.approx(model.model.geometry.home, abs=1e-15)
    assert after.nu == len(model.robot.joints)
    assert after.actuator_gainprm[:, 0] == pytest.approx(physical.model.gains, rel=1e-15)


def test_friction_springs_and_offsets_stand_in_joints_and_motors(tmp_path):
    model = with_effects(
        identified("five_bar"),
        ("viscous_friction", "left", {"Fv": 0.1}),
        ("quadratic_drag", "left", {"c": 0.02}),
        ("coulomb_friction", "left", {"Fc": 0.2}),
        ("passive_coulomb_friction", "right_elbow", {"Fc": 0.05}),
        ("passive_rotor_inertia", "right_elbow", {"Ia": 0.002}),
        ("joint_spring", "right", {"k": 2.0, "kq0": -0.6}),
        ("constant_offset", "right", {"c": 0.3}),
        ("rotor_inertia", "left", {"Ia": 0.003}),
        ("cogging_torque", "left", {"a": 0.1, "b": 0.2}),
        ("viscous_friction", "right", {"Fv": -0.1}),
    )
    physical = physical_set(model)
    exported = write_mjcf(tmp_path / "out.xml", physical)
    assert [one.effect.name for one in exported.placed.not_placed] == ["cogging_torque", "viscous_friction"]
    assert "negative" in exported.placed.not_placed[1].why
    made = mujoco.MjModel.from_xml_path(str(tmp_path / "out.xml"))
    data = mujoco.MjData(made)
    velocity = np.array([-2.0, 0.5, 1.5, -0.4])
    data.qpos[:], data.qvel[:] = made.key_qpos[0], velocity
    mujoco.mj_forward(made, data)
    right = made.joint("right").dofadr[0]
    assert data.qfrc_passive[made.joint("left").dofadr[0]] == pytest.approx(0.1 * 2.0 + 0.02 * 4.0)
    assert data.qfrc_passive[right] == pytest.approx(-(2.0 * made.key_qpos[0][right] + 0.6))
    assert made.dof_frictionloss[made.joint("left").dofadr[0]] == pytest.approx(0.2)
    assert made.dof_frictionloss[made.joint("right_elbow").dofadr[0]] == pytest.approx(0.05)
    assert made.dof_armature[0] == pytest.approx(0.003 + physical.rotors[0])
    assert made.dof_armature[made.joint("right_elbow").dofadr[0]] == pytest.approx(0.002)
    assert data.qfrc_actuator[right] == pytest.approx(-0.3)  # at no current: the motor has to overcome it
    text = (tmp_path / "out.xml").read_text()
    assert "cogging_torque at left (periods = 12, a = 0.1, b = 0.2)" in text


def test_every_effect_of_the_catalogue_is_placed_or_listed():
    model = identified("five_bar")
    places = {
        "actuator": "left",
        "passive": "left_elbow",
        "bearing": "left_elbow",
        "body": "left_rod",
        "payload": "disc",
        "robot": "",
    }
    effects = [
        (name, places[one.place], {parameter.name: 0.01 for parameter in one.parameters})
        for name, one in CATALOGUE.items()
    ]
    placed = placed_effects(physical_set(with_effects(model, *effects)))
    lines = not_placed_lines(placed.not_placed)
    assert len(lines) == len(CATALOGUE) - len(RULES) - 1  # a tilt is gravity's
    assert all(line.startswith(one.effect.name) for line, one in zip(lines, placed.not_placed, strict=True))


def test_what_the_file_says_and_the_model_does_not_is_told(tmp_path):
    source = built_in_robots()["five_bar"]
    text = (source / "five_bar.xml").read_text(encoding="utf-8")
    text = text.replace('<joint name="left_elbow"/>', '<joint name="left_elbow" stiffness="1.5"/>')
    text = text.replace(
        'fullinertia="3.1e-4 8.93e-3 9.02e-3 -4.7e-5 8.8e-5 -5e-6"',
        'diaginertia="3e-4 9e-3 9e-3" euler="0 .1 0"',
    )
    text = text.replace('<joint type="hinge" axis', '<joint type="hinge" damping="0.3" axis')
    text = text.replace(
        "</mujoco>",
        '<actuator><motor name="old" joint="left" gear="2" ctrlrange="-8 8"/>'
        '<position name="servo" joint="right" kp="50"/></actuator></mujoco>',
    )
    (tmp_path / "robot").mkdir()
    (tmp_path / "robot" / "five_bar.xml").write_text(text, encoding="utf-8")
    shutil.copy(source / "robot.toml", tmp_path / "robot")
    model = load_identified(identified_file("five_bar", True, EFFECTS), tmp_path / "robot")
    exported = write_mjcf(tmp_path / "out.xml", physical_set(model))
    assert any("left_elbow: stiffness 1.5" in line for line in exported.changed)
    assert (
        sum("damping 0.3" in line for line in exported.changed) == 3
    )  # all but the joint with an identified one
    assert any("servo" in line for line in exported.changed)
    made = mujoco.MjModel.from_xml_path(str(tmp_path / "out.xml"))
    assert made.body("left_rod").mass[0] == pytest.approx(0.914, rel=0.2)
    assert made.dof_damping[1:] == pytest.approx(np.zeros(3))
    assert made.dof_damping[0] == pytest.approx(0.1, rel=0.1)
    assert [made.actuator(i).name for i in range(made.nu)] == ["old", "servo"]
    left, right = model.gains
    assert made.actuator_gainprm[:, 0] * made.actuator_gear[:, 0] == pytest.approx([left, right])
    assert made.actuator_ctrlrange[0] == pytest.approx([-16.0 / left, 16.0 / left])
    assert (made.actuator_biastype == int(mujoco.mjtBias.mjBIAS_AFFINE)).all()
    assert made.actuator_biasprm[:, :3] == pytest.approx(np.zeros((2, 3)))


def test_motors_on_tendons_keep_their_rotors(tmp_path):
    write_mjcf(tmp_path / "out.xml", physical_set(identified("wrist")))
    made = mujoco.MjModel.from_xml_path(str(tmp_path / "out.xml"))
    assert {made.actuator(i).name for i in range(made.nu)} == {"motor_4", "motor_5", "motor_6"}


def test_a_servo_of_the_file_on_the_tendon_of_a_motor_is_replaced(tmp_path):
    """At a control of zero it would pull the tendon to zero."""
    folder = shutil.copytree(built_in_robots()["wrist"], tmp_path / "wrist")
    text = (folder / "wrist.xml").read_text(encoding="utf-8")
    servo = '<actuator><position name="servo" tendon="motor_4" kp="100"/></actuator></mujoco>'
    (folder / "wrist.xml").write_text(text.replace("</mujoco>", servo), encoding="utf-8")
    model = replace(identified("wrist"), robot=load_robot(folder))
    exported = mjcf_text(physical_set(model), folder)
    assert exported.actuators == ("motor_4", "motor_5", "motor_6")
    assert mujoco.MjModel.from_xml_string(exported.text).nu == 3
    assert "actuator 'servo' is gone: the motor at joint motor_4 replaces it" in exported.changed


def test_meshes_are_found_from_where_the_file_lies(tmp_path):
    source = built_in_robots()["five_bar"]
    folder = tmp_path / "robot"
    (folder / "meshes").mkdir(parents=True)
    corners = [(x, y, z) for x in (0, 0.02) for y in (0, 0.02) for z in (0, 0.02)]
    vertices = "\n".join(f"v {x} {y} {z}" for x, y, z in corners)
    (folder / "meshes" / "block.obj").write_text(vertices + "\nf 1 2 3\nf 2 4 3\nf 5 6 7\nf 1 5 6\n")
    text = (source / "five_bar.xml").read_text(encoding="utf-8")
    text = text.replace("<asset>", '<asset><mesh name="block" file="block.obj"/>')
    text = text.replace('<compiler angle="radian"', '<compiler meshdir="meshes" angle="radian"')
    text = text.replace(
        '<site name="left_tip"', '<geom name="m" type="mesh" mesh="block"/><site name="left_tip"'
    )
    (folder / "five_bar.xml").write_text(text, encoding="utf-8")
    shutil.copy(source / "robot.toml", folder)
    model = load_identified(identified_file("five_bar"), folder)
    write_mjcf(tmp_path / "elsewhere" / "out.xml", physical_set(model))
    assert mujoco.MjModel.from_xml_path(str(tmp_path / "elsewhere" / "out.xml")).nmesh == 1


def test_urdf_moves_as_the_model_does(tmp_path):
    physical = physical_set(identified("two_link"))
    urdf = urdf_text(physical)
    tree = pin.buildModelFromXML(urdf.text)
    tree.armature = physical.rotors.copy()
    geometry, base = physical.model.model.geometry, physical.model.model.base
    random = np.random.default_rng(3)
    q, v, a = random.uniform(-1.0, 1.0, (3, 20, 2))
    still = np.zeros((20, 2, 2)) + np.eye(2)
    rows = projected_regressor(geometry, Motion(np.arange(20.0), q, v, a, still), base.columns)
    modelled = rows @ physical.model.base
    data = tree.createData()
    assert [tree.names[i] for i in (1, 2)] == list(physical.model.robot.joints)
    tau = np.array([pin.rnea(tree, data, *one) for one in zip(q, v, a, strict=True)])
    assert tau == pytest.approx(modelled, rel=1e-9, abs=1e-9)
    assert any("drive gain of elbow" in line for line in urdf.not_held)


def test_urdf_has_no_loops():
    with pytest.raises(BenchError, match="URDF has no loops"):
        urdf_text(physical_set(identified("five_bar")))


def test_the_command_writes_every_format_and_tells_what_is_lost(tmp_path, capsys):
    model = str(identified_file("two_link"))
    assert main(["export", model, "--to", "mjcf", "-o", str(tmp_path / "arm.xml")]) == 0
    assert main(["export", model, "--to", "urdf", "-o", str(tmp_path / "arm.urdf")]) == 0
    told = capsys.readouterr().out
    assert "Not held: drive gain of shoulder" in told
    assert "next: " not in told  # the model does not say which recordings it is from
    step = after_export(arm_of(model, tmp_path), "mjcf", tmp_path / "arm.xml", ())
    assert step[0].startswith(f"next: bench replay {tmp_path} --model {tmp_path / 'arm.json'}    ")
    assert main(["export", model, "--to", "csv", "-o", str(tmp_path / "arm.csv"), "--no-cad"]) == 0
    assert main(["export", model, "--to", "yaml", "-o", str(tmp_path / "arm.yaml")]) == 0
    beside = json.loads((tmp_path / "arm.twin.json").read_text())
    assert [motor["joint"] for motor in beside["motors"]] == ["shoulder", "elbow"]
    with (tmp_path / "arm.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    saved = json.loads(Path(model).read_text())
    (gain,) = [float(row["value"]) for row in rows if row["kind"] == "drive gain" and row["place"] == "elbow"]
    assert gain == saved["drive_gains"]["elbow"]["value"]
    table = yaml.safe_load((tmp_path / "arm.yaml").read_text())
    assert table["drive gain"]["elbow"]["gain"]["value"] == gain
    assert table["body"]["forearm"]["m"]["unit"] == "kg"
    assert table["base parameter"]["mx(forearm)"]["std"] > 0.0


def arm_of(model, dataset):
    """The same model, from the recordings of a dataset."""
    path = dataset / "arm.json"
    path.write_text(json.dumps({**json.loads(Path(model).read_text()), "dataset": str(dataset)}))
    return path


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--to", "urdf"], "no loops"),
        (["--to", "mjcf", "--robot", "two_link"], "motors"),
        (["--to", "mjcf", "--payload", "brick"], "payload 'brick'"),
        (["--to", "csv", "--payload", "disc"], "--payload needs"),
        (["--to", "stl"], "stl"),
    ],
)
def test_bad_input_is_one_line_and_leaves_nothing(words, said, tmp_path, capsys):
    model = str(identified_file("five_bar"))
    assert main(["export", model, *words, "-o", str(tmp_path / "out.xml")]) == 2
    told = capsys.readouterr()
    assert told.err.count("\n") == 1
    assert said in told.err
    assert told.out == ""
    assert not list(tmp_path.iterdir())


def test_a_contradiction_is_refused_unless_asked_for(tmp_path, capsys):
    content = json.loads(identified_file("two_link").read_text())
    for one in content["parameters"]:
        if one["name"] == "Iyy(forearm)":
            one["value"] = -0.01
    (tmp_path / "bad.json").write_text(json.dumps(content))
    words = ["export", str(tmp_path / "bad.json"), "--to", "mjcf", "-o", str(tmp_path / "out.xml")]
    assert main(words) == 2
    told = capsys.readouterr().err
    assert "forearm" in told
    assert "standard errors" in told
    assert not (tmp_path / "out.xml").exists()
    assert main([*words, "--nearest"]) == 0
    assert (tmp_path / "out.xml").exists()


def test_a_measured_arm_gets_real_bodies(measured_data, tmp_path, capsys):
    model = tmp_path / "ur10e.json"
    effects = ["coulomb_friction", "viscous_friction", "constant_offset"]
    data = load_dataset(measured_data / "ur10e")
    save_model(identify(prepare(problem_of(data, effects))), model, data.folder)
    assert main(["export", str(model), "--to", "mjcf", "-o", str(tmp_path / "arm.xml")]) == 0
    assert "standard errors from the identified base parameters" in capsys.readouterr().out
    made = mujoco.MjModel.from_xml_path(str(tmp_path / "arm.xml"))
    assert (made.dof_frictionloss > 0.0).all()
    moving = made.body_mass[1:]
    assert (moving[moving > 0.0] > 0.1).all()
