"""The exported twin needs the recorded currents, in MuJoCo alone; what the file does not hold is added or named."""

import io
import json
import re
import shutil
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest
from rich.console import Console

from bench.basics.errors import BenchError
from bench.cli import main
from bench.cli.replay_report import replay_report
from bench.dataset.dataset import load_dataset
from bench.dataset.payload import Payload
from bench.dataset.robot import load_robot
from bench.export.identified import declaring, load_identified
from bench.export.mjcf import write_mjcf
from bench.export.physical import physical_set
from bench.export.placed import still_determined
from bench.export.replay.causes import PossibleBodies, SoftLoops
from bench.export.replay.replay import replay
from bench.export.replay.words import cause_sentence
from bench.identification.identify import identify
from bench.identification.model_file import apply_model, load_model, save_model
from bench.identification.prepare import prepare
from bench.identification.problem import problem_of
from bench.model.model import build_model
from bench.truth.dataset import as_dataset, write_simulation
from tests.broken_robots import edit
from tests.export_kit import FRICTION
from tests.hidden_kit import run
from tests.rrd_reader import columns, verified

LADDER = ((), ("coulomb_friction:left",), ("coulomb_friction:left", "viscous_friction:left"))
BRIEF = {"optimise": False, "duration": 3.0, "ramp": 0.5}
BRIEFER = {**BRIEF, "duration": 2.0}  # where a twin is beside its model alone
CURVED = {"effect": "stribeck_friction", "joint": "left", "Fc": 0.15, "Fs": 0.15, "vs": 0.3}


@pytest.fixture(scope="module")
def recorded(tmp_path_factory):
    """A five-bar with friction at one motor, one recording without payload and one with."""
    folder = tmp_path_factory.mktemp("recorded") / "data"
    write_simulation(run("five_bar", *FRICTION, design=BRIEF), folder)
    return folder


@pytest.fixture(scope="module")
def models(recorded):
    """A model file for each step of the ladder."""
    files = []
    for number, effects in enumerate(LADDER):
        files.append(recorded.parent / f"model_{number}.json")
        save_model(identify(prepare(problem_of(load_dataset(recorded), effects))), files[-1], recorded)
    return files


@pytest.fixture(scope="module")
def replays(recorded, models):
    """The twin of each, beside the recordings."""
    return [
        replay(problem_of(load_dataset(recorded)), physical_set(load_identified(model))) for model in models
    ]


def test_the_twin_is_as_near_as_the_model_is(replays):
    for one in replays:
        assert one.left_out == ()
        assert one.twin.error.identify == pytest.approx(one.model.error.identify, rel=0.05)
    assert (replays[-1].off < 1e-3).all()
    assert 0.0 < replays[-1].opened < 1e-5


def test_its_error_falls_step_by_step_as_effects_are_added(replays):
    errors = [one.twin.error.identify for one in replays]
    assert errors[1] < 0.7 * errors[0]
    assert errors[2] < 0.3 * errors[1]


def test_a_load_of_which_only_the_mass_is_known_is_replayed_where_the_rest_moves_nothing(tmp_path):
    dataset = as_dataset(run("delta", design=BRIEFER))
    block = Payload("block", mass=dataset.payloads["block"].mass)  # the platform does not turn
    dataset = replace(dataset, payloads={"block": block})
    save_model(identify(prepare(problem_of(dataset))), tmp_path / "model.json")
    identified = declaring(load_identified(tmp_path / "model.json"), dataset.payloads)
    assert identified.payloads == {"block": {}}
    found = replay(problem_of(dataset), physical_set(identified))
    assert found.twin.error.identify == pytest.approx(found.model.error.identify, rel=0.1)


def test_a_report_shows_machine_model_and_twin(recorded, models, tmp_path, capsys):
    words = ["replay", str(recorded), "--model", str(models[-1]), "-o", str(tmp_path / "page")]
    assert main(words) == 0
    page = (tmp_path / "page" / "report.html").read_text(encoding="utf-8")
    assert "Simulated by MuJoCo along 2 recorded motions" in page
    assert "error of the twin" in page
    assert "Thin lines: the simulated twin" in page
    assert re.search(r'"simulated":\s*\[\s*\{', page)
    assert f"wrote {tmp_path / 'page' / 'report.html'} (report)" in capsys.readouterr().out


def test_a_script_of_mujoco_and_numpy_alone_finds_the_same(recorded, models, project_root, tmp_path):
    model = models[-1]
    write_mjcf(tmp_path / "twin.xml", physical_set(load_identified(model)))
    dataset = load_dataset(recorded)
    ours = apply_model(problem_of(dataset), load_model(model)).error.by_recording
    name = dataset.recordings[0].name
    settings = load_model(model).settings
    words = [tmp_path / "twin.xml", recorded / name, 0.4 * dataset.recordings[0].rate / settings.decimation]
    script = project_root / "tests" / "replay_script.py"
    done = subprocess.run(
        [sys.executable, str(script), *map(str, words)], capture_output=True, text=True, check=True
    )
    assert float(done.stdout) == pytest.approx(ours[name], rel=0.2)


def test_effects_that_mjcf_cannot_hold_act_in_the_twin(tmp_path):
    folder = tmp_path / "data"
    write_simulation(run("five_bar", CURVED, design=BRIEFER), folder)
    dataset = load_dataset(folder)
    save_model(
        identify(prepare(problem_of(dataset, ["stribeck_friction:left", "torque_ripple:right"]))),
        tmp_path / "model.json",
    )
    identified = load_identified(tmp_path / "model.json")
    found = replay(problem_of(dataset), physical_set(identified))
    assert found.left_out == ()
    assert found.twin.error.identify == pytest.approx(found.model.error.identify, rel=0.1)
    bare = replay(
        problem_of(dataset), replace(physical_set(identified), model=replace(identified, effects=()))
    )
    assert bare.twin.error.identify > 3.0 * found.twin.error.identify


def test_values_of_single_recordings_are_theirs_in_a_replay_and_a_mean_in_a_file(recorded, tmp_path, capsys):
    effects = [*LADDER[-1], "constant_offset:right@recording"]
    save_model(
        identify(prepare(problem_of(load_dataset(recorded), effects))), tmp_path / "model.json", recorded
    )
    identified = load_identified(tmp_path / "model.json")
    one, other = (e.values["c"] for e in identified.effects if e.name == "constant_offset")
    (mean,) = (e.values["c"] for e in identified.effects_in() if e.name == "constant_offset")
    assert mean == pytest.approx(0.5 * (one + other), abs=1e-12)
    logs = [e.instance.recording for e in identified.effects if e.name == "constant_offset"]
    (own,) = (e.values["c"] for e in identified.effects_in(logs[1]) if e.name == "constant_offset")
    assert own == pytest.approx(other, abs=1e-12)
    found = replay(problem_of(load_dataset(recorded)), physical_set(identified))
    assert found.twin.error.identify == pytest.approx(found.model.error.identify, rel=0.05)
    words = ["export", str(tmp_path / "model.json"), "--to", "mjcf", "-o", str(tmp_path / "x.xml")]
    assert main(words) == 0
    assert "Mean of the values of the recordings: constant_offset:right@recording" in capsys.readouterr().out


def test_a_tilted_base_is_gravity_where_the_data_tell_all_that_it_moves(tmp_path):
    tilt = {"effect": "base_tilt", "about_y": 0.05}
    dataset = as_dataset(run("five_bar", tilt, design=BRIEFER))
    save_model(identify(prepare(problem_of(dataset, ["base_tilt"]))), tmp_path / "model.json")
    identified = load_identified(tmp_path / "model.json")
    found = replay(problem_of(dataset), physical_set(identified))
    assert found.left_out == ()
    assert found.twin.error.identify == pytest.approx(found.model.error.identify, rel=0.1)
    turning = replace(
        identified, model=build_model(load_robot("palletiser"))
    )  # its turret never felt gravity
    assert still_determined(turning, np.array([0.0, 0.0, -9.0]))
    assert not still_determined(turning, np.array([0.5, 0.0, -9.8]))


def test_an_effect_that_no_simulation_holds_is_named(recorded, tmp_path, capsys):
    save_model(
        identify(prepare(problem_of(load_dataset(recorded), ["encoder_offset:left"]))),
        tmp_path / "model.json",
        recorded,
    )
    words = ["replay", str(recorded), "--model", str(tmp_path / "model.json")]
    assert main(words) == 0
    assert "Not simulated, so its part of the current is missing: encoder_offset at left" in (
        " ".join(capsys.readouterr().out.split())
    )


PAD = '<geom name="{name}" pos="0.25 0 0" size="0.034" contype="1" conaffinity="1" solref="{solref}"/>'


@pytest.fixture(scope="module")
def replay_of_other_file(recorded, models, tmp_path_factory):
    """The twin that is exported into a changed MJCF of the same five-bar; arguments: texts and what replaces them."""

    def replayed(*changes):
        folder = tmp_path_factory.mktemp("changed") / "five_bar"
        robot = shutil.copytree(load_robot("five_bar").folder, folder)
        edit(robot / "five_bar.xml", *changes)
        identified = replace(load_identified(models[-1]), robot=load_robot(robot))
        return replay(problem_of(load_dataset(recorded)), physical_set(identified))

    return replayed


def pads(solref):
    """Changes of the five-bar: a sphere at each rod, which touch at home."""
    sites = (f'<site name="{side}_tip"' for side in ("left", "right"))
    return (
        ('<flag contact="disable"/>', ""),
        *(
            (site, PAD.format(name=name, solref=solref) + site)
            for site, name in zip(sites, ("left_pad", "right_pad"), strict=True)
        ),
    )


def printed_shortcomings(result):
    console = Console(record=True, width=900, file=io.StringIO())
    replay_report(result, console)
    return console.export_text()


SOFT = ('<equality solref="0.002 1" solimp="0.9999 0.99999 0.001"/>', '<equality solref="0.2 1"/>')


def test_soft_loops_are_named_with_what_closes_them(replays, replay_of_other_file):
    assert replays[-1].causes == ()
    assert "soft" not in printed_shortcomings(replays[-1])
    soft = replay_of_other_file(SOFT)
    (cause,) = soft.causes
    assert isinstance(cause, SoftLoops)
    assert cause.opened == soft.opened > 1e-4
    assert cause.error == pytest.approx(soft.model.error.identify, rel=0.1)
    assert 'write solref="0.0005 1" solimp="0.9999 0.99999 0.001"' in printed_shortcomings(soft)


def test_geoms_that_touch_are_named_before_loops_that_they_open(replay_of_other_file):
    touching = replay_of_other_file(*pads("0.1 1"), SOFT)
    contacts, soft = touching.causes
    assert [pair.geoms for pair in contacts.pairs] == [("left_pad", "right_pad")]
    assert [pair.bodies for pair in contacts.pairs] == [("left_rod", "right_rod")]
    assert isinstance(soft, SoftLoops)
    assert soft.error == pytest.approx(touching.model.error.identify, rel=0.1)
    text = printed_shortcomings(touching)
    assert "Geoms touch: 'left_pad' of left_rod and 'right_pad' of right_rod. " in text
    assert '<exclude body1="left_rod" body2="right_rod"/>' in text
    assert text.index("Geoms touch") < text.index("Loops open")
    (only,) = replay_of_other_file(*pads("0.1 1")).causes
    assert only.error == pytest.approx(touching.model.error.identify, rel=0.1)


def test_a_twin_that_contacts_stop_is_refused_with_the_geoms(replay_of_other_file):
    with pytest.raises(BenchError, match=r"is lost at t = .* s\. Geoms touch: 'left_pad' of left_rod and"):
        replay_of_other_file(*pads("-1e9 -1"))


def test_possible_bodies_far_from_the_estimate_are_named(recorded, models):
    """The values of the model are moved as if no real bodies had them."""
    identified = load_identified(models[-1])
    physical = physical_set(identified)
    moved = replace(physical, distance=7.0, model=identified.moved(1.05 * identified.estimated))
    result = replay(problem_of(load_dataset(recorded)), moved)
    (cause,) = result.causes
    assert isinstance(cause, PossibleBodies)
    assert cause.distance == 7.0
    assert cause.error > 1.3 * result.model.error.identify
    assert "7.0 standard errors away, and the model with them has an error of" in cause_sentence(cause)


def test_the_command_tells_one_number_a_motor_and_writes_files(recorded, models, tmp_path, capsys):
    answer, film = tmp_path / "replay.json", tmp_path / "replay.rrd"
    words = ["replay", str(recorded), "--model", str(models[-1]), "--json", str(answer), "--rrd", str(film)]
    assert main(words) == 0
    told = capsys.readouterr().out
    assert "the model itself" in told
    assert told.splitlines()[-1].startswith(f"next: rerun {film}    ")
    content = json.loads(answer.read_text())
    assert set(content["error"]["by_actuator"]) == {"left", "right"}
    assert content["error"]["identify"] == pytest.approx(content["error_of_model"]["identify"], rel=0.05)
    assert np.array(content["recordings"][0]["off"]).shape == (2,)
    assert verified(film)
    _, machine = columns(film, "/free/robot/bodies/left_crank")
    _, twin = columns(film, "/free/robot/simulated/left_crank")
    machine, twin = (np.array([list(row[0]) for row in poses["quaternion"]]) for poses in (machine, twin))
    assert machine.shape == twin.shape
    assert 0.0 < np.abs(machine - twin).max() < 1e-3


def test_a_model_of_another_robot_is_one_line(recorded, tmp_path, capsys):
    content = json.loads((recorded.parent / "model_0.json").read_text())
    content["drive_gains"] = {"shoulder": content["drive_gains"]["left"]}
    (tmp_path / "other.json").write_text(json.dumps(content))
    answer = tmp_path / "replay.json"
    words = ["replay", str(recorded), "--model", str(tmp_path / "other.json"), "--json", str(answer)]
    assert main(words) == 2
    assert capsys.readouterr().err.count("\n") == 1
    assert not answer.exists()
