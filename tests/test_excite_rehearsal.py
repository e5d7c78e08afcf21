"""A planned scenario is tried before it is written: the command that a plan prints next works."""

import json
import shutil

import numpy as np
import pytest

from bench.api.simulate import simulation_of
from bench.basics.errors import BenchError
from bench.basics.progress import SILENT
from bench.cli import main
from bench.dataset.robot import load_robot
from bench.excitation.experiment import plan as plan_module
from bench.excitation.experiment import proof
from bench.excitation.experiment.enclosed_loops import begins_at_home
from bench.excitation.experiment.plan import Aim, plan_experiment
from bench.excitation.experiment.request import ExperimentTable
from bench.excitation.experiment.simulated import FIRST, SimulatedDrive
from bench.scenario.scenario import load_scenario
from bench.studies.rehearsal import rehearsal_sentence, rehearse, scenario_of
from bench.truth.simulate import simulate
from tests.small_robots import write_robot

# A heavy tool on light links: where they are stretched, the elbow hardly moves it, and what is left to move is light.
HEAVY_TOOL = """<mujoco>
  <compiler angle="radian"/>
  <option gravity="0 0 0"/>
  <worldbody>
    <body name="upper">
      <joint name="shoulder" axis="0 0 1" range="-2 2"/>
      <geom type="capsule" fromto="0 0 0 .3 0 0" size=".02" mass=".2"/>
      <body name="fore" pos=".3 0 0">
        <joint name="elbow" axis="0 0 1" range="-1 1"/>
        <geom type="capsule" fromto="0 0 0 .3 0 0" size=".02" mass=".2"/>
        <geom type="sphere" pos=".3 0 0" size=".02" mass="400"/>
        <site name="tool" pos=".3 0 0"/>
      </body>
    </body>
  </worldbody>
  <keyframe><key name="home" qpos="0 0.4"/></keyframe>
</mujoco>
"""
QUICK = {"duration": 3.0, "harmonics": 3, "velocity": 2.0, "acceleration": 20.0}


@pytest.fixture(scope="module")
def heavy_tool(tmp_path_factory):
    joints = {"shoulder": "N*m/A", "elbow": "N*m/A"}
    return write_robot(tmp_path_factory.mktemp("heavy") / "robot", HEAVY_TOOL, joints, "tool")


def planned(robot, **changes):
    return plan_experiment(robot, ExperimentTable.model_validate(QUICK | changes), Aim(steps=0))


def test_a_drive_that_diverges_gives_way_and_the_written_scenario_simulates(heavy_tool, tmp_path, capfd):
    folder = tmp_path / "planned"
    words = ["excite", str(heavy_tool.folder), "-o", str(folder), "--payload-mass", "0.2", "--steps", "0"]
    limits = ["--duration", "3", "--velocity", "2", "--acceleration", "20"]
    assert main([*words, *limits]) == 0
    said = capfd.readouterr()
    assert "because a controller of 30 Hz in steps of 0.25 ms fails" in said.out
    assert "next: " in said.out
    assert "WARNING" not in said.err
    settings = load_scenario(folder / "scenario.toml").settings
    drive = SimulatedDrive(settings.controller.natural_frequency, settings.step)
    assert drive != FIRST
    simulation = simulation_of(folder / "scenario.toml", None, SILENT)
    assert [one.name for one in simulation.recordings] == list(
        json.loads((folder / "answer.json").read_text())["recordings"]
    )


def test_where_none_runs_the_plan_says_what_fails(heavy_tool):
    rehearsal = rehearse(planned(heavy_tool), (FIRST,))
    assert not rehearsal.runs
    assert rehearsal.drive == FIRST
    sentence = rehearsal_sentence(rehearsal)
    assert "cannot be simulated" in sentence
    assert "diverged" in sentence
    assert "\n" not in sentence


def test_what_runs_at_once_stays_as_it_is():
    plan = planned(load_robot("two_link"), payload={"mass": 0.5})
    rehearsal = rehearse(plan)
    assert rehearsal.drive == FIRST
    assert rehearsal.runs
    assert rehearsal_sentence(rehearsal) == ""
    assert len(simulate(scenario_of(plan)).recordings) == 4


@pytest.mark.parametrize("rate", [300.0, 1000.0, 1500.0, 4000.0, 8000.0])
def test_a_sample_takes_a_whole_number_of_steps(rate):
    for largest in (0.00025, 0.0001):
        step = SimulatedDrive(30.0, largest).step_at(rate)
        assert step <= largest * (1.0 + 1e-9)
        assert 1.0 / (rate * step) == pytest.approx(round(1.0 / (rate * step)), abs=1e-9)
        assert (
            scenario_of(planned(load_robot("two_link"), rate=rate), SimulatedDrive(30.0, largest)).log_every
            >= 1
        )


def with_home(folder, values):
    """The five-bar with another home, or with what its file says rounded."""
    shutil.copytree(load_robot("five_bar").folder, folder)
    path = folder / "five_bar.xml"
    path.write_text(path.read_text().replace("1.5113606206690187", values, 1))
    return load_robot(folder)


def test_a_home_that_a_file_rounds_is_home(tmp_path):
    """Loops that are open by 1e-7 there are closed where a motion begins; the elbow on the other side is not there."""
    plan = planned(with_home(tmp_path / "rounded", "1.5113606"))
    geometry, reach = plan.nominal.model.geometry, np.full((1, 4), 1e-9)
    start = plan.motions[0].motion.q[:1]
    assert np.abs(start - geometry.home).max() < 1e-9  # taken up where the robot is read
    assert begins_at_home(geometry, start, reach)
    assert not begins_at_home(geometry, start + np.array([0.0, 1e-6, 0.0, 0.0]), reach)


def test_where_nothing_is_proven_at_home_nothing_is_searched(monkeypatch):
    def never(*_, **__):
        raise AssertionError("motions were tried")

    monkeypatch.setattr(plan_module, "random_candidates", never)
    monkeypatch.setattr(proof, "begins_at_home", lambda *_: False)
    with pytest.raises(
        BenchError, match="of no motion from home it could be proven that it keeps the loops; "
    ):
        planned(load_robot("five_bar"))


def test_closures_that_repeat_one_another_and_disagree_a_little_can_be_simulated(tmp_path):
    """A second connect at the same pin, 0.1 µm off: the loops cannot all be closed to rounding."""
    folder = tmp_path / "twice"
    shutil.copytree(load_robot("five_bar").folder, folder)
    path = folder / "five_bar.xml"
    text = path.read_text().replace(
        '<site name="right_tip"', '<site name="again" pos="0.3000001 0 0"/><site name="right_tip"'
    )
    path.write_text(
        text.replace("</equality>", '<connect name="again" site1="left_tip" site2="again"/></equality>')
    )
    plan = planned(load_robot(folder))
    assert rehearse(plan).runs
