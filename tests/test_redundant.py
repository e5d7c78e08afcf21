"""More motors than degrees of freedom: of all their torques the motion tells the powers, and that is enough."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from bench.api.diagnose import diagnose
from bench.basics.errors import BenchError
from bench.dataset.dataset import Dataset, load_dataset
from bench.dataset.recording import Recording
from bench.dataset.robot import load_robot
from bench.excitation.experiment.plan import nominal_machine
from bench.excitation.experiment.request import ExperimentTable
from bench.export.identified import load_identified
from bench.identification.estimators import ESTIMATORS
from bench.identification.finding import Code, Finding
from bench.identification.identify import fitted_currents, identify
from bench.identification.model_file import apply_model, load_model, save_model
from bench.identification.model_json import from_json, to_json
from bench.identification.nonlinear import converged
from bench.identification.perturbations import Nearby
from bench.identification.prepare import prepare
from bench.identification.problem import problem_of
from bench.identification.result import Identification
from bench.robot_check.check import check_robot
from bench.robot_check.outcome import CheckCode
from bench.robot_check.words import detail_of
from bench.scenario.scenario import load_scenario
from bench.truth.dataset import as_dataset, write_simulation
from bench.truth.machine import true_gains
from bench.truth.simulate import Simulation, simulate
from tests.hidden_kit import STEP
from tests.redundant_kit import TRUE, by_hand, with_third_motor

SHORT = {"optimise": False, "duration": 6.0, "span": 0.2}
NOISE = 0.01


@pytest.fixture(scope="module")
def third_motor(project_root: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return with_third_motor(project_root, tmp_path_factory.mktemp("robots"))


@pytest.fixture(scope="module")
def friction() -> Dataset:
    """A DualV with viscous friction at its redundant motor."""
    hidden = [{"effect": "viscous_friction", "joint": "motor_4", "Fv": 0.05}]
    return as_dataset(simulate(load_scenario("dualv", {"design": SHORT, "hidden": hidden, "step": STEP})))


@pytest.fixture(scope="module")
def found_by_hand(third_motor: Path) -> Identification:
    return identify(prepare(problem_of(by_hand(third_motor, NOISE))))


@pytest.fixture(scope="module")
def simulated() -> Simulation:
    return simulate(load_scenario("dualv", {"design": SHORT, "step": STEP}))


def test_the_motors_that_the_others_determine_are_redundant(third_motor: Path) -> None:
    robot = load_robot(third_motor)
    assert robot.joints == ("left", "right")
    assert [one.joint for one in robot.redundant] == ["left_elbow"]
    assert robot.driven == tuple(TRUE)


def test_the_range_of_a_redundant_motor_is_not_called_that_of_a_passive_joint(
    project_root: Path, tmp_path: Path
) -> None:
    folder = with_third_motor(project_root, tmp_path)
    file = folder / "five_bar.xml"
    file.write_text(
        file.read_text().replace('<joint name="left_elbow"/>', '<joint name="left_elbow" range="1.4 1.6"/>')
    )
    notes = [
        detail_of(check)
        for check in check_robot(load_robot(folder)).checks
        if check.code is CheckCode.PASSIVE_RANGE_LEFT
    ]
    assert len(notes) == 1
    assert "the other motors" in notes[0]
    assert "'left_elbow' (redundant motor, " in notes[0]


def test_all_gains_follow_from_the_motors_powers_whatever_the_internal_force(third_motor: Path) -> None:
    """The third motor's current has nothing to do with the motion; nothing of the robot is known but its geometry."""
    found = identify(prepare(problem_of(by_hand(third_motor))))
    for joint, true in TRUE.items():
        assert found.drive_gains[joint].value == pytest.approx(true, rel=3e-4), joint
    assert float(found.error.validate or 1.0) < 3e-4


def test_with_noise_gains_are_within_their_deviations(found_by_hand: Identification) -> None:
    for joint, true in TRUE.items():
        gain = found_by_hand.drive_gains[joint]
        assert abs(gain.value - true) < 4 * gain.std, joint
        assert gain.std < 0.003 * true, joint
    gains = [one.place for one in found_by_hand.covariance_rows if one.kind == "gain"]
    assert sorted(gains) == sorted(TRUE)


@pytest.mark.parametrize("method", sorted({*ESTIMATORS} - {"oe"}))
def test_every_estimator_finds_the_gains_of_redundant_motors(third_motor: Path, method: str) -> None:
    found = identify(prepare(problem_of(by_hand(third_motor, NOISE))), method=method)
    for joint, true in TRUE.items():
        gain = found.drive_gains[joint]
        assert abs(gain.value - true) < 4 * gain.std, joint


def test_without_a_weighed_payload_all_gains_stay_nominal(third_motor: Path) -> None:
    found = identify(prepare(problem_of(by_hand(third_motor), fit_gains=False)))
    assert {joint: gain.value for joint, gain in found.drive_gains.items()} == {
        "left": 3.0,
        "right": 3.0,
        "left_elbow": 1.0,
    }


def test_the_model_is_written_and_applied_with_all_gains(
    third_motor: Path, found_by_hand: Identification, tmp_path: Path
) -> None:
    answer = json.loads(json.dumps(to_json(found_by_hand)))
    assert list(answer["drive_gains"]) == list(TRUE)
    assert answer["redundant"] == ["left_elbow"]
    assert list(answer["error"]["by_actuator"]) == ["left", "right"]
    assert from_json(answer).joints == ("left", "right")
    data = by_hand(third_motor, NOISE)
    save_model(found_by_hand, tmp_path / "model.json", data.folder)
    again = apply_model(problem_of(data), load_model(tmp_path / "model.json"))
    assert again.error.validate == pytest.approx(found_by_hand.error.validate, rel=1e-9)


def test_a_simulated_log_holds_every_motor(simulated: Simulation, tmp_path: Path) -> None:
    write_simulation(simulated, tmp_path / "data")
    given, read = as_dataset(simulated), load_dataset(tmp_path / "data")
    for one, other in zip(given.recordings, read.recordings, strict=True):
        assert one.position.shape == (len(one.time), 3)
        np.testing.assert_array_equal(one.current, other.current)
        np.testing.assert_array_equal(one.redundant_current, other.redundant_current)
        assert other.redundant_current.shape == (len(one.time), 1)
    table = (tmp_path / "data" / "unloaded.csv").read_text().replace("current.motor_4", "current.unknown")
    (tmp_path / "data" / "unloaded.csv").write_text(table)
    with pytest.raises(BenchError, match=r"unloaded\.csv: no column current\.motor_4"):
        load_dataset(tmp_path / "data")


def test_redundant_motors_follow_their_references_and_share_the_load(simulated: Simulation) -> None:
    for one in simulated.recordings:
        assert np.abs(one.motion.reference - one.position).max() < 0.02
        assert (np.sqrt((one.motion.torque**2).mean(axis=0)) > 0.01).all(), "every motor works"


def test_gains_of_a_simulated_dualv(simulated: Simulation) -> None:
    found = identify(prepare(problem_of(as_dataset(simulated))))
    for true, (joint, gain) in zip(true_gains(simulated.scenario), found.drive_gains.items(), strict=True):
        assert abs(gain.value - true) < 5 * gain.std, joint
        assert gain.value == pytest.approx(true, rel=0.02), joint


def test_friction_at_a_redundant_motor_is_an_effect_like_any_other(friction: Dataset) -> None:
    found = identify(prepare(problem_of(friction, ["viscous_friction"]))).effect_parameters[
        "viscous_friction"
    ]
    assert list(found) == ["motor_1", "motor_2", "motor_3", "motor_4"]
    for place, values in found.items():
        true = 0.05 if place == "motor_4" else 0.0
        assert abs(values["Fv"].value - true) < 5 * values["Fv"].std, place
        assert values["Fv"].std < 0.005


def test_a_diagnosis_compares_the_gains_of_every_motor() -> None:
    """With two effects, each is asked which drive gains it moves."""
    hidden = [{"effect": "viscous_friction", "Fv": 0.05}, {"effect": "coulomb_friction", "Fc": 0.1}]
    changes = {"design": SHORT, "hidden": hidden, "step": STEP}
    data = as_dataset(simulate(load_scenario("dualv", changes)))
    answer = diagnose(data, discover=False)
    assert {"viscous_friction", "coulomb_friction"} <= set(answer.missing)
    effects = ["viscous_friction", "coulomb_friction"]
    _, gains = fitted_currents(converged(prepare(problem_of(data, effects))))
    assert gains == pytest.approx({joint: gain.value for joint, gain in answer.after.drive_gains.items()})


def test_changes_nearby_are_those_worked_out_whole_with_redundant_motors(friction: Dataset) -> None:
    """What another gravity or position does to the torque, redundant motors' powers included."""
    prepared = prepare(problem_of(friction))
    near = Nearby(prepared.model, prepared.measured).signals(prepared.present, prepared.signals)[1]
    whole = prepared.signals[1]
    shift = np.zeros((3, *whole.coarse.position.shape))
    shift[0, :, 1] = 1e-3
    tilted = whole.geometry.gravity + np.array([0.5, 0.0, 0.0])
    for seen in ({"shift": shift}, {"gravity": tilted}):
        expected, found = whole.coarse_change(**seen), near.coarse_change(**seen)
        off = np.sqrt(((found - expected)[5:-5] ** 2).mean())
        assert off < 0.1 * np.sqrt((expected[5:-5] ** 2).mean())


@pytest.mark.parametrize("what", ["export", "plan"])
def test_what_needs_every_motors_torque_refuses_the_robot(
    what: str, third_motor: Path, found_by_hand: Identification, tmp_path: Path
) -> None:
    save_model(found_by_hand, tmp_path / "model.json")
    with pytest.raises(BenchError, match=r"does not support redundant motors \(left_elbow\)"):
        if what == "export":
            load_identified(tmp_path / "model.json", third_motor)
        else:
            nominal_machine(load_robot(third_motor), ExperimentTable(), (), {})


def test_an_encoder_that_the_loop_closures_deny_is_told(simulated: Simulation, tmp_path: Path) -> None:
    """A redundant motor's position follows from the others': a zero that is off shows without any current."""
    write_simulation(simulated, tmp_path / "data")
    given = load_dataset(tmp_path / "data")
    assert _denied(given) == []
    turned, moved = (
        replace(given, recordings=tuple(map(change, given.recordings))) for change in (_mirrored, _shifted)
    )
    (found,) = _denied(turned)
    assert found.names[0] == "motor_4"
    assert found.numbers["difference"] > 0.1 * found.numbers["travel"]
    (found,) = _denied(moved)
    assert found.names[0] == "motor_4"
    assert found.numbers["mean"] == pytest.approx(found.numbers["difference"], rel=0.01)
    assert 0.002 < found.numbers["difference"] < 0.05
    assert "The position of motor_4 from the loop closures differs from its encoder" in "\n".join(
        identify(prepare(problem_of(moved))).notes
    )
    unlogged = [replace(one, extra={}) for one in moved.recordings]
    assert _denied(replace(moved, recordings=tuple(unlogged))) == []


def _denied(dataset: Dataset) -> list[Finding]:
    return [one for one in prepare(problem_of(dataset)).contradicted if one.code is Code.CLOSURE_CONTRADICTED]


def _mirrored(recording: Recording) -> Recording:
    """As with the sign of the redundant motor's encoder reversed."""
    return replace(recording, extra={"position.motor_4": -recording.extra["position.motor_4"]})


def _shifted(recording: Recording) -> Recording:
    """As with the zero of another motor's encoder 0.01 rad off."""
    return replace(recording, position=recording.position + np.array([0.01, 0.0, 0.0]))


def test_a_part_of_a_recording_has_its_samples_of_every_motor(simulated: Simulation) -> None:
    one = as_dataset(simulated).recordings[0]
    part = one.part(slice(10, 30))
    for values in (part.time, part.position, part.current, part.redundant_current, *part.extra.values()):
        assert len(values) == 20
    assert set(part.extra) == {"position.motor_4"}
    np.testing.assert_array_equal(part.redundant_current, one.redundant_current[10:30])
