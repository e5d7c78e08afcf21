"""`bench excite`: motions that keep every limit at all times, and forecasts that come true."""

import csv
import json
import tomllib
from dataclasses import replace

import numpy as np
import pytest

from bench.basics.errors import BenchError
from bench.cli import main
from bench.dataset.robot import load_robot
from bench.excitation.bounds import SEARCH
from bench.excitation.experiment import search
from bench.excitation.experiment.between_samples import derivative_bound, extremes
from bench.excitation.experiment.files import scenario_text
from bench.excitation.experiment.forecast import forecast
from bench.excitation.experiment.plan import Aim, plan_experiment
from bench.excitation.experiment.request import ExperimentTable, assumed_units, by_unit, with_units
from bench.excitation.experiment.room import outside, room_of, tool_positions
from bench.excitation.experiment.sentences import limiting
from bench.identification.prepare import prepare
from bench.identification.problem import problem_of
from bench.model.geometry import read_geometry
from bench.model.motion import motion_of
from bench.scenario.scenario import load_scenario, resolve_trajectories
from bench.scenario.trajectory import random_trajectory
from bench.studies.excite_figures import by_chance, monte_carlo, planned_scenario, with_other_currents
from bench.truth.dataset import as_dataset
from bench.truth.resense import sense_again
from bench.truth.simulate import simulate

pytestmark = pytest.mark.pictures

BALL = {"mass": 1.0, "center_of_mass": [0.0, 0.0, 0.03], "inertia": [4e-4, 4e-4, 4e-4, 0, 0, 0]}
QUICK = {"duration": 6.0, "harmonics": 4, "velocity": 4.0, "acceleration": 40.0}


def table(**changes):
    return ExperimentTable.model_validate({**QUICK, **changes})


@pytest.fixture(scope="module")
def arm():
    return plan_experiment(load_robot("two_link"), table(payload=BALL), Aim(steps=12))


@pytest.fixture(scope="module")
def told(arm):
    return forecast(arm, 0.002)


@pytest.mark.parametrize("seed", range(6))
def test_bounds_hold_at_all_times_and_are_near(seed):
    trajectory = random_trajectory(seed, [0.3, -0.2], 0.7, 4.0, harmonics=6, duration=8.0, ramp=0.8)
    reach = extremes(trajectory)
    time = np.linspace(0.0, trajectory.duration, 200_001)
    position, velocity, acceleration = trajectory.evaluate(time)
    assert np.all(reach.low <= position.min(axis=0))
    assert np.all(reach.high >= position.max(axis=0))
    for bound, values in ((reach.velocity, velocity), (reach.acceleration, acceleration)):
        largest = np.abs(values).max(axis=0)
        assert np.all(bound >= largest)
        assert np.all(bound <= 1.05 * largest)


@pytest.mark.parametrize("order", [1, 2])
def test_derivatives_never_exceed_their_bounds(order):
    trajectory = random_trajectory(3, [0.0], 1.0, 4.0, harmonics=5, duration=6.0)
    time = np.linspace(0.0, 6.0, 60_001)
    values = np.abs(trajectory.evaluate(time)[order])
    ramps = (time <= trajectory.ramp) | (time >= 6.0 - trajectory.ramp)
    assert np.all(values[ramps] <= derivative_bound(trajectory, order, blended=True))
    assert np.all(values[~ramps] <= derivative_bound(trajectory, order, blended=False))


def test_motions_start_and_end_at_rest_at_home_inside_all_limits(arm):
    for one in arm.motions:
        for x, at_ends in zip(one.trajectory.evaluate([0.0, 6.0]), (arm.room.home, 0.0, 0.0), strict=True):
            np.testing.assert_allclose(x, np.broadcast_to(at_ends, x.shape), atol=1e-12)
        position, velocity, acceleration = one.trajectory.evaluate(np.linspace(0.0, 6.0, 120_001))
        assert np.all(position >= arm.room.joint.low - 1e-9)
        assert np.all(position <= arm.room.joint.high + 1e-9)
        assert np.abs(velocity).max() <= 4.0 + 1e-8
        assert np.abs(acceleration).max() <= 40.0 + 1e-7


def test_own_ranges_boxes_and_currents_are_kept():
    robot = load_robot("two_link")
    box = {"low": [-0.1, -1.0, -0.6], "high": [0.75, 1.0, 0.3]}
    plan = plan_experiment(
        robot,
        table(position={"shoulder": [-1.2, 0.0]}, workspace=[box], current={"shoulder": 4.0, "elbow": 2.0}),
        Aim(steps=6),
    )
    geometry = plan.nominal.model.geometry
    for one in plan.motions:
        time = np.linspace(0.0, 6.0, 20_001)
        states = one.trajectory.evaluate(time)
        motion = motion_of(geometry, time, *states)
        assert states[0][:, 0].min() >= -1.2
        assert states[0][:, 0].max() <= 0.0
        assert outside(plan.room.boxes[0], tool_positions(geometry, motion)).max() < 0.0


def test_better_than_motions_at_random(arm):
    assert arm.value < arm.random["best"] < arm.random["median"]


def test_the_same_seed_gives_the_same_motion(arm):
    again = plan_experiment(load_robot("two_link"), table(payload=BALL), Aim(steps=12))
    assert [one.trajectory for one in again.motions] == [one.trajectory for one in arm.motions]


def test_forecasts_come_true(arm, told):
    trial = monte_carlo(arm, told, 40)
    assert len(trial.ratios) == len(told.unknowns)
    assert 1.0 <= trial.independent <= len(trial.ratios)
    assert 0.8 < trial.pooled < 1.2
    low, high = trial.every_by_chance
    assert all(low < ratio < high for ratio in trial.ratios.values())


def test_logged_again_the_equations_are_those_of_a_new_log(arm):
    scenario = planned_scenario(arm, 0)
    simulation = simulate(scenario)
    first, second = (
        as_dataset(
            sense_again(
                simulation, replace(scenario, settings=scenario.settings.model_copy(update={"seed": seed}))
            )
        )
        for seed in (0, 1)
    )
    expected, found = prepare(problem_of(second)), with_other_currents(prepare(problem_of(first)), second)
    assert found is not None
    for anew, whole in zip(found.observations, expected.observations, strict=True):
        np.testing.assert_allclose(anew.current, whole.current, rtol=1e-12, atol=1e-12)
        np.testing.assert_array_equal(anew.rigid, whole.rigid)
    assert found.settings == expected.settings
    np.testing.assert_array_equal(found.bands.current_noise, expected.bands.current_noise)
    moved = replace(second.recordings[0], position=second.recordings[0].position + 1e-6)
    assert with_other_currents(found, replace(second, recordings=(moved, *second.recordings[1:]))) is None


def test_how_far_chance_takes_a_standard_deviation():
    draws = np.random.default_rng(1).normal(size=(4000, 120, 5)).std(axis=1, ddof=1)
    low, high = by_chance(120)
    assert np.mean((draws > low) & (draws < high)) == pytest.approx(0.95, abs=0.01)
    low, high = by_chance(120, at_once=5)
    assert np.mean(((draws > low) & (draws < high)).all(axis=1)) == pytest.approx(0.95, abs=0.01)
    pooled = np.sqrt((draws**2).mean(axis=1))
    low, high = by_chance(120, independent=5.0)
    assert np.mean((pooled > low) & (pooled < high)) == pytest.approx(0.95, abs=0.01)


def test_closed_loops_keep_their_distance_from_singular_poses():
    plan = plan_experiment(load_robot("five_bar"), table(payload={"mass": 0.5}), Aim(steps=3))
    geometry = plan.nominal.model.geometry
    for one in plan.motions:
        time = np.linspace(0.0, 6.0, 4001)
        motion = motion_of(geometry, time, *one.trajectory.evaluate(time))
        assert np.abs(motion.jacobian).max() <= plan.room.joint.amplification
    unknown = forecast(plan).unknowns
    assert {one.kind for one in unknown} == {"parameter", "payload", "gain"}
    assert all(one.std is not None for one in unknown)


def test_a_heavier_payload_or_more_time_is_told(arm, told):
    gains = max(one.relative for one in told.unknowns if one.kind == "gain")
    assert told.enough.expected == pytest.approx(gains)
    strict = forecast(arm, gains / 1.5).enough
    assert strict.seconds == pytest.approx(1.5**2 * 6.0)
    assert strict.mass is None or strict.mass > 1.0
    assert forecast(arm, 2.0 * gains).enough.mass < 1.0


def test_without_a_payload_it_says_what_stays_open():
    plan = plan_experiment(load_robot("two_link"), table(), Aim(steps=0))
    said = forecast(plan, 0.005)
    assert plan.names == ("unloaded",)
    assert any("scale together" in note and "Weigh a payload" in note for note in limiting(plan, said))
    assert said.enough.mass is not None


def test_effects_that_nothing_tells_apart_are_named():
    plan = plan_experiment(
        load_robot("two_link"), table(), Aim(("viscous_friction",), steps=0), ["rotor_inertia:shoulder"]
    )
    said = forecast(plan)
    assert ("Iyy(upper_arm)", "rotor_inertia:shoulder.Ia") in said.together
    aimed = [said.unknowns[i].name for i in plan.targets]
    assert aimed == ["viscous_friction:shoulder.Fv", "viscous_friction:elbow.Fv"]
    assert all(said.unknowns[i].std is not None for i in plan.targets)


def test_the_scenario_is_one(arm, tmp_path):
    for one in arm.recordings:
        lines = [f"{key} = {value!r}" for key, value in one.trajectory.to_dict().items()]
        (tmp_path / f"{one.name}.toml").write_text("\n".join(lines))
    (tmp_path / "scenario.toml").write_text(scenario_text(arm))
    scenario = load_scenario(tmp_path / "scenario.toml")
    found = resolve_trajectories(scenario)
    assert found == {one.name: one.trajectory for one in arm.recordings}
    uses = {one.name: (one.use, one.payload) for one in scenario.settings.recordings}
    assert uses == {
        "unloaded": ("identify", None),
        "loaded": ("identify", "payload"),
        "unloaded_check": ("validate", None),
        "loaded_check": ("validate", "payload"),
    }


def test_motions_to_judge_on_are_others_inside_the_same_limits(arm):
    fitted, judged = arm.recordings[:2], arm.recordings[2:]
    time = np.linspace(0.0, 6.0, 20_001)
    for one in judged:
        states = one.trajectory.evaluate(time)
        for other in fitted:
            moved = states[0] - arm.room.home, other.trajectory.evaluate(time)[0] - arm.room.home
            alike = np.sum(moved[0] * moved[1], axis=0) / np.prod(np.linalg.norm(moved, axis=1), axis=0)
            assert np.all(np.abs(alike) < 0.9)
        assert np.ptp(states[0], axis=0).min() > 0.2
        assert np.all(states[0] >= arm.room.joint.low - 1e-9)
        assert np.all(states[0] <= arm.room.joint.high + 1e-9)
        assert np.abs(states[1]).max() <= 4.0 + 1e-8
        assert np.abs(states[2]).max() <= 40.0 + 1e-7


def test_the_command_writes_everything(tmp_path, capsys):
    folder = tmp_path / "planned"
    words = ["excite", "two_link", "-o", str(folder), "--duration", "5", "--steps", "5", "-q"]
    assert (
        main([*words, "--payload-mass", "1", "--velocity", "4", "--acceleration", "40", "--seed", "3"]) == 0
    )
    answer = json.loads((folder / "answer.json").read_text())
    assert answer["seed"] == 3
    assert {one["kind"] for one in answer["unknowns"]} >= {"gain", "parameter"}
    with (folder / "loaded.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 5001
    home = tomllib.loads((folder / "loaded.toml").read_text())["center"]
    for row in (rows[0], rows[-1]):
        assert [float(row["position.shoulder"]), float(row["position.elbow"])] == pytest.approx(home)
        assert float(row["velocity.elbow"]) == pytest.approx(0.0, abs=1e-12)
    assert [(name, one["use"]) for name, one in answer["recordings"].items()] == [
        ("unloaded", "identify"),
        ("loaded", "identify"),
        ("unloaded_check", "validate"),
        ("loaded_check", "validate"),
    ]
    assert (folder / "loaded_check.csv").read_text() != (folder / "loaded.csv").read_text()
    assert "--name loaded_check.csv --use validate --payload payload" in (folder / "README.md").read_text()
    assert (folder / "motions.png").stat().st_size > 10_000
    assert (folder / "motions.rrd").stat().st_size > 10_000
    assert capsys.readouterr().out == ""


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("[position]\nsholder = [-1, 0]", "did you mean 'shoulder'?"),
        ("[position]\nshoulder = [0.5, 1.0]", "home, -0.75"),
        ("[velocity]\nshoulder = 3.0", "velocity: joint 'elbow' is missing"),
        ("velocity = -3.0", "greater than 0"),
        ("[[workspace]]\nlow = [5, 5, 5]\nhigh = [6, 6, 6]", "workspace[0]: the tool is at"),
        ("current = 0.01", "current or torque of shoulder: 0.01 A leaves no room, standing at home takes"),
        ("speed = 3.0", "speed: unknown key"),
        ("duration = 1.0", "too short for two ramps"),
        ("[payload]\ncenter_of_mass = [0, 0, 0.1]", "its mass is missing"),
        ("[sensors]\ncurrent_noise = 0.0", "without noise nothing has a standard error"),
    ],
)
def test_bad_limits_are_refused_in_one_line(tmp_path, capsys, text, said):
    limits, folder = tmp_path / "limits.toml", tmp_path / "planned"
    limits.write_text(text)
    assert main(["excite", "two_link", "-o", str(folder), "--limits", str(limits), "-q"]) == 2
    error = capsys.readouterr().err
    assert said in error
    assert error.count("\n") == 1
    assert not folder.exists()


def test_where_limits_leave_no_room_the_one_in_the_way_is_named(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(search, "SEARCH", replace(SEARCH, tries=1, shrinks=3))
    limits = tmp_path / "limits.toml"
    limits.write_text("[[workspace]]\nlow = [0.6053, -0.046, -0.2101]\nhigh = [0.6073, -0.044, -0.208]")
    assert main(["excite", "two_link", "-o", str(tmp_path / "planned"), "--limits", str(limits), "-q"]) == 2
    assert "the smallest that was tried does not keep workspace[0] at t = " in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--for", "viscos_friction"], "did you mean 'viscous_friction'?"),
        (["--for", "gains"], "payload of known mass"),
        (["--for", "stribeck_friction"], "not linear"),
        (["--gain-accuracy", "half"], "is not a share"),
    ],
)
def test_bad_words_are_refused_in_one_line(tmp_path, capsys, words, said):
    assert main(["excite", "two_link", "-o", str(tmp_path / "planned"), "-q", *words]) == 2
    error = capsys.readouterr().err
    assert said in error
    assert error.count("\n") == 1
    assert list(tmp_path.iterdir()) == []


def test_a_folder_with_something_else_is_left_alone(tmp_path):
    (tmp_path / "mine.txt").write_text("mine")
    with pytest.raises(BenchError, match="holds something else"):
        from bench.excitation.discrimination.files import check_folder
        from bench.excitation.experiment.files import MARKS

        check_folder(tmp_path, *MARKS)


@pytest.mark.parametrize(
    ("robot", "given", "said"),
    [
        ("crank_slide", ["3rad/s"], "velocity: joint 'carriage' is in m/s: add --velocity NUMBERm/s"),
        ("crank_slide", ["3rad/s", "0.3"], "velocity: 0.3 has no unit: write 0.3m/s"),
        ("emps", ["3rad/s"], "velocity: 3 in rad/s: no joint of 'emps' takes it"),
        ("emps", ["3m/s2"], "'3m/s2' is no positive number, alone or in rad/s or m/s"),
    ],
)
def test_a_speed_of_hinges_and_slides_has_its_unit(robot, given, said, tmp_path, capsys):
    words = [word for speed in given for word in ("--velocity", speed)]
    assert main(["excite", robot, *words, "-o", str(tmp_path / "plan")]) == 2
    err = capsys.readouterr().err
    assert said in err
    assert err.count("\n") == 1
    assert not (tmp_path / "plan").exists()


def test_speeds_are_given_by_unit_or_as_one_number():
    both = load_robot("crank_slide")
    assert by_unit("velocity", [], both) is None
    assert by_unit("velocity", [(0.3, "m/s"), (3.0, "rad/s")], both) == {"crank": 3.0, "carriage": 0.3}
    assert by_unit("velocity", [(0.3, "")], load_robot("emps")) == 0.3
    assert assumed_units("velocity", 0.3, load_robot("emps")) == ["velocity 0.3: m/s"]
    assert assumed_units("velocity", 0.3, load_robot("five_bar")) == []
    assert assumed_units("acceleration", {"crank": 3.0, "carriage": 0.3}, both) == []
    assert assumed_units("acceleration", 20.0, both) == ["acceleration 20: rad/s2 at hinges, m/s2 at slides"]


def test_assumed_speeds_have_numbers_and_units():
    both = load_robot("crank_slide")
    assert with_units("velocity", np.array([3.0, 0.3]), both) == "crank 3 rad/s, carriage 0.3 m/s"
    assert with_units("acceleration", np.array([20.0, 20.0]), load_robot("five_bar")) == "20 rad/s2"
    table = ExperimentTable.model_validate({"duration": 5.0, "velocity": 0.3})
    room = room_of(read_geometry(load_robot("emps")), table)
    assert room.assumed == ("velocity 0.3: m/s", "acceleration: the largest speed within 0.1 s (3 m/s2)")
