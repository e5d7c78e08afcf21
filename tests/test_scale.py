"""Whether the declared payloads fix the drive gains: by geometry and motion, never by noise."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from bench.basics.errors import BenchError
from bench.cli import main
from bench.dataset.dataset import Dataset
from bench.dataset.payload import Payload
from bench.dataset.robot import Robot, load_robot
from bench.diagnosis.summary import summary_of
from bench.diagnosis.with_catalogue import diagnose_with_catalogue
from bench.document.diagnosis import gains_before_after
from bench.document.identification import gains_table
from bench.document.markdown.tables import markdown
from bench.identification.finding import Code, Finding
from bench.identification.finding_words import note, sentence
from bench.identification.findings import runaway, with_findings
from bench.identification.fixed_scale import random_states, scale_of
from bench.identification.identify import identify
from bench.identification.model_json import from_json, to_json
from bench.identification.prepare import prepare
from bench.identification.problem import problem_of
from bench.identification.result import DriveGain, Identification
from bench.identification.scale import Scale, ScaleCase
from bench.identification.scale_words import CODES, REASONS, SHORT, why_nominal
from bench.model.model import build_model
from bench.page.section_effects import gains_section
from bench.page.verdict import gains_sentence, identification_tiles, identification_verdict
from bench.residuals.residuals import WhereItFails
from bench.scenario.scenario import load_scenario, scenario_from_dict
from bench.truth.dataset import as_dataset
from bench.truth.simulate import simulate
from tests.small_robots import write_robot

BALL = [4e-4, 4e-4, 4e-4, 0.0, 0.0, 0.0]

# An arm that turns about one vertical axis, with a tool on the axis or off it.
VERTICAL = """<mujoco><compiler angle="radian"/><worldbody><body name="arm"><joint name="turn" axis="0 0 1"/>
  <geom type="capsule" fromto="0 0 0 .3 0 0" size=".02"/><site name="tool" pos="{tool} 0 .1"/></body>
</worldbody></mujoco>"""

# A vertical slide that carries the tool, and a wheel beside it that the tool's load does not reach.
APART = """<mujoco><compiler angle="radian"/><worldbody>
  <body name="carriage"><joint name="lift" type="slide" axis="0 0 1" range="-.3 .3"/>
    <geom type="box" size=".05 .05 .05"/><site name="tool"/></body>
  <body name="wheel" pos="1 0 0"><joint name="spin" axis="0 1 0" range="-2 2"/>
    <geom type="capsule" fromto="0 0 0 .2 0 0" size=".03"/></body>
</worldbody></mujoco>"""

# A horizontal table of two slides with a turntable that is balanced about its axis.
TABLE = """<mujoco><compiler angle="radian"/><worldbody>
  <body name="along"><joint name="x" type="slide" axis="1 0 0" range="-.3 .3"/><geom type="box" size=".1 .1 .02"/>
    <body name="across"><joint name="y" type="slide" axis="0 1 0" range="-.3 .3"/><geom type="box" size=".1 .1 .02"/>
      <body name="disc"><joint name="turn" axis="0 0 1" range="-2 2"/>
        <geom type="cylinder" size=".1 .02"/><site name="tool"/></body></body></body>
</worldbody></mujoco>"""


def vertical(folder: Path, tool: float) -> Robot:
    return write_robot(folder, VERTICAL.format(tool=tool), {"turn": "N*m/A"}, "tool")


def declared(**values: object) -> Payload:
    return Payload("ball", **{key: np.array(value, dtype=float)[()] for key, value in values.items()})


def decided(robot: Robot, payload: Payload, loaded: tuple[str | None, ...] = (None, "ball")) -> Scale:
    model = build_model(robot)
    return scale_of(model, {"ball": payload}, random_states(model, loaded))


def cures(scale: Scale) -> set[str]:
    return {"+".join(remedies) for remedies in scale.remedies}


@pytest.mark.parametrize("name", ["wrist", "/foreign/spm"])
def test_a_payload_that_turns_about_a_fixed_point_needs_its_centre(name: str, measured_data: Path) -> None:
    if name.startswith("/") and not (measured_data / name[1:]).is_dir():
        pytest.skip(f"no measured data: {measured_data / name[1:]} is not there")
    robot = load_robot(measured_data / name[1:] if name.startswith("/") else name)
    weighed = decided(robot, declared(mass=1.0))
    assert weighed.case is ScaleCase.NOT_FIXED
    assert weighed.open == weighed.held == robot.joints
    assert cures(weighed) == {"center_of_mass"}
    assert set(weighed.remedies.values()) == {3}
    unknown = decided(robot, declared())
    assert unknown.case is ScaleCase.MASS_UNKNOWN
    assert cures(unknown) == {"mass+center_of_mass"}
    centred = declared(mass=1.0, center_of_mass=[0.02, 0.03, 0.06])
    assert decided(robot, centred).case is ScaleCase.FIXED
    assert cures(decided(robot, centred, ("ball",))) == {"unloaded"}


@pytest.mark.parametrize("name", ["five_bar", "two_link", "delta", "dualv", "emps"])
def test_a_payload_that_is_carried_about_needs_nothing_but_its_mass(name: str) -> None:
    assert decided(load_robot(name), declared(mass=0.3)).case is ScaleCase.FIXED


@pytest.mark.parametrize("mass", [1e-3, 1e3])
def test_how_heavy_a_payload_is_decides_nothing(tmp_path: Path, mass: float) -> None:
    assert decided(load_robot("wrist"), declared(mass=mass)).case is ScaleCase.NOT_FIXED
    inertia = [moment * mass for moment in BALL]
    whole = declared(mass=mass, center_of_mass=[0.0, 0.0, 0.0], inertia=inertia)
    assert decided(vertical(tmp_path / "arm", 0.2), whole).case is ScaleCase.FIXED


@pytest.mark.parametrize(
    ("tool", "values", "remedies"),
    [
        (0.2, {"mass": 1.0}, {"center_of_mass+inertia"}),  # about the axis it has an inertia, unknown
        (0.2, {"mass": 1.0, "center_of_mass": [0, 0, 0]}, {"inertia"}),
        (0.2, {"mass": 1.0, "center_of_mass": [0, 0, 0], "inertia": [0.0] * 6}, None),
        (0.0, {"mass": 1.0, "center_of_mass": [0, 0, 0], "inertia": [0.0] * 6}, {"elsewhere"}),
        (0.0, {"mass": 1.0, "center_of_mass": [0, 0, 0], "inertia": BALL}, None),
        (1e-3, {"mass": 1.0, "center_of_mass": [0, 0, 0], "inertia": [0.0] * 6}, None),  # however weakly
    ],
)
def test_about_one_vertical_axis_only_a_known_inertia_fixes_the_gain(
    tmp_path: Path, tool: float, values: dict[str, object], remedies: set[str] | None
) -> None:
    scale = decided(vertical(tmp_path / "arm", tool), declared(**values))
    assert (scale.case is ScaleCase.FIXED) == (remedies is None)
    assert cures(scale) == (remedies or set())


RECORDINGS = [
    {"name": "free", "use": "identify", "design": {"seed": 1}},
    {"name": "held", "use": "identify", "payload": "ball", "design": {"seed": 2}},
    {"name": "check", "use": "validate", "payload": "ball", "design": {"seed": 3}},
]
QUICK = {"step": 0.0005, "seed": 1, "recordings": RECORDINGS}
QUIET = {"encoder_resolution": 1e-6, "current_noise_ratio": 0.005}


def with_ball(dataset: Dataset, **values: object) -> Dataset:
    return replace(dataset, payloads={"ball": declared(**values)})


def answer(dataset: Dataset, method: str = "current") -> Identification:
    return identify(prepare(problem_of(dataset)), method=method)


def gain_errors(result: Identification, true: dict[str, float]) -> dict[str, float]:
    return {
        joint: result.drive_gains[joint].value / result.drive_gains[joint].nominal / (1.0 + error) - 1.0
        for joint, error in true.items()
    }


def scale_finding(result: Identification) -> Finding:
    (found,) = [each for each in result.findings if each.code in CODES.values()]
    return found


WRIST = {"motor_4": 0.10, "motor_5": -0.08, "motor_6": 0.06}
CENTER = [0.02, 0.03, 0.06]


@pytest.fixture(scope="module")
def wrist() -> Dataset:
    ball = {"mass": 1.2, "center_of_mass": CENTER, "inertia": [1.5e-3, 1.3e-3, 1.0e-3, 1e-4, -5e-5, 8e-5]}
    changes = {**QUICK, "payloads": {"ball": ball}, "design": {"optimise": False, "duration": 5.0}}
    return as_dataset(simulate(load_scenario("wrist", changes), threads=1))


def test_without_its_centre_no_gain_is_given_and_the_answer_says_what_to_declare(wrist: Dataset) -> None:
    """With the first moment that the known mass can stand for left out, gains of -0.65 came out, known to 1 %."""
    result = answer(with_ball(wrist, mass=1.2))
    assert not result.gains_fitted
    assert all((gain.value, gain.std) == (gain.nominal, 0.0) for gain in result.drive_gains.values())
    assert {"mx(ball)", "my(ball)", "mz(ball)", "Izz(ball)"} <= {one.name for one in result.parameters}
    found = scale_finding(result)
    assert (found.code, found.names) == (Code.GAINS_NOT_FIXED, ("ball",))
    assert [unknown.place for unknown in found.of] == list(WRIST)
    assert found.numbers == {"center_of_mass": 3.0}
    said = note(found)
    assert said.endswith("Declare its centre of mass.")
    assert "No fitted recording" not in " ".join(result.notes)
    for written in (gains_section(result, None).lead, gains_sentence(result)):
        assert written == said
    content = json.loads(json.dumps(to_json(result)))
    kept = {"value": 0.12, "std": 0.0, "unit": "N*m/A", "nominal": 0.12, "fitted": False, "determined": False}
    assert content["drive_gains"] == dict.fromkeys(WRIST, kept)
    assert scale_finding(from_json(content)) == found


def test_with_its_centre_declared_the_gains_are_found(wrist: Dataset) -> None:
    result = answer(with_ball(wrist, mass=1.2, center_of_mass=CENTER))
    assert result.gains_fitted
    assert why_nominal(result) is None
    assert max(map(abs, gain_errors(result, WRIST).values())) < 0.01


@pytest.mark.parametrize("method", ["tls", "wtls"])
def test_methods_that_need_the_scale_are_refused_with_the_reason(wrist: Dataset, method: str) -> None:
    with pytest.raises(
        BenchError, match=rf"'{method}'.* the payload ball, as .* Declare its centre of mass\."
    ):
        answer(with_ball(wrist, mass=1.2), method)


def test_gains_that_are_asked_for_are_refused_with_the_reason(wrist: Dataset) -> None:
    with pytest.raises(BenchError, match=r"the payload ball, as .* Declare its centre of mass\."):
        prepare(problem_of(with_ball(wrist, mass=1.2), fit_gains=True))


def test_a_motion_that_does_not_show_the_load_fixes_nothing(wrist: Dataset) -> None:
    """What all motions could tell, these recordings do not: the loaded one stands still."""
    (free, held, *_) = wrist.recordings
    still = replace(held, position=np.repeat(held.position[:1], len(held.time), axis=0))
    standing = replace(wrist, recordings=(free, still))
    prepared = prepare(problem_of(with_ball(standing, mass=1.2, center_of_mass=CENTER)))
    assert prepared.scale.case is ScaleCase.NOT_FIXED
    assert cures(prepared.scale) == {"motion"}


APART_GAINS = {"lift": 0.10, "spin": -0.08}


@pytest.fixture(scope="module")
def apart(tmp_path_factory: pytest.TempPathFactory) -> Dataset:
    """A slide with a weighed payload, and a wheel that it does not reach."""
    robot = write_robot(
        tmp_path_factory.mktemp("apart") / "robot", APART, {"lift": "N/A", "spin": "N*m/A"}, "tool"
    )
    span, velocity = {"lift": 0.2, "spin": 1.5}, {"lift": 1.0, "spin": 8.0}
    content = {
        **QUICK,
        "robot": str(robot.folder),
        "gains": {"error": APART_GAINS},
        "sensors": QUIET,
        "payloads": {"ball": {"mass": 3.0, "declared": {"mass": 3.0}}},
        "design": {"duration": 5.0, "ramp": 0.5, "span": span, "velocity_limit": velocity},
        "hidden": [{"effect": "viscous_friction", "joint": "lift", "Fv": 4.0}],
    }
    return as_dataset(simulate(scenario_from_dict(content, "apart"), threads=1))


@pytest.mark.parametrize("method", ["current", "robust", "iv", "wls", "ls"])
def test_a_motor_that_the_load_does_not_reach_stays_nominal_and_the_other_is_fitted(
    apart: Dataset, method: str
) -> None:
    result = identify(prepare(problem_of(apart, ["viscous_friction"])), method=method)
    assert result.gains_fitted
    lift, spin = result.drive_gains["lift"], result.drive_gains["spin"]
    assert lift.fitted
    assert abs(gain_errors(result, APART_GAINS)["lift"]) < 0.01
    assert (spin.value, spin.std) == (spin.nominal, 0.0)
    assert result.rank == result.unknowns
    found = scale_finding(result)
    assert (found.code, found.names) == (Code.GAINS_FIXED_FOR_SOME, ("ball",))
    assert [unknown.place for unknown in found.of] == ["spin"]
    assert sentence(found).startswith(
        "The drive gain of spin stays at its nominal value, because the payload ball"
    )
    assert "Declaring more about a payload" in sentence(found)
    content = to_json(result)["drive_gains"]
    assert {joint: gain["fitted"] for joint, gain in content.items()} == {"lift": True, "spin": False}
    assert "lift" in gains_sentence(result)
    assert sentence(found) in gains_sentence(result)


def test_the_held_gain_moves_nothing_of_the_fitted_one(apart: Dataset) -> None:
    spin = apart.robot.actuators[1]
    other = replace(
        apart,
        robot=replace(
            apart.robot, actuators=(apart.robot.actuators[0], replace(spin, gain=20.0 * spin.gain))
        ),
    )
    first, second = (answer(dataset).drive_gains["lift"].value for dataset in (apart, other))
    assert second == pytest.approx(first, rel=1e-6)


def test_a_diagnosis_holds_the_same_gain(apart: Dataset) -> None:
    found = diagnose_with_catalogue(problem_of(apart))
    assert "viscous_friction" in found.missing
    assert abs(gain_errors(found.after, APART_GAINS)["lift"]) < 0.01
    assert found.after.drive_gains["spin"].std == 0.0
    assert summary_of(found).nominal.startswith("The drive gain of spin is nominal, because the payload ball")


def test_methods_that_fit_all_gains_are_refused_where_one_is_held(apart: Dataset) -> None:
    with pytest.raises(
        BenchError, match="'tls' fits all drive gains: the drive gain of spin cannot be fitted"
    ):
        answer(apart, "tls")


@pytest.fixture(scope="module")
def balanced(tmp_path_factory: pytest.TempPathFactory) -> Dataset:
    """A turntable that is balanced under its payload: rank sees it shake the slides."""
    units = {"x": "N/A", "y": "N/A", "turn": "N*m/A"}
    robot = write_robot(tmp_path_factory.mktemp("table") / "robot", TABLE, units, "tool")
    span, velocity = {"x": 0.2, "y": 0.2, "turn": 1.5}, {"x": 1.0, "y": 1.0, "turn": 8.0}
    content = {
        **QUICK,
        "robot": str(robot.folder),
        "sensors": QUIET,
        "payloads": {"ball": {"mass": 3.0, "inertia": [4e-3] * 3 + [0.0] * 3}},
        "design": {"duration": 5.0, "ramp": 0.5, "span": span, "velocity_limit": velocity},
    }
    return as_dataset(simulate(scenario_from_dict(content, "table"), threads=1))


@pytest.mark.parametrize("method", ["current", "robust", "wls"])
def test_a_gain_that_is_fixed_by_what_the_machine_lacks_is_not_given(balanced: Dataset, method: str) -> None:
    prepared = prepare(problem_of(with_ball(balanced, mass=3.0, center_of_mass=[0.0, 0.0, 0.0])))
    assert prepared.scale.case is ScaleCase.FIXED  # as for any turntable that is not balanced
    result = identify(prepared, method=method)
    turn = result.drive_gains["turn"]
    assert not turn.determined
    (found,) = [each for each in result.findings if each.code is Code.GAIN_NOT_DETERMINED]
    assert [unknown.place for unknown in found.of] == ["turn"]
    assert "turn not determined" in repr(result)


def test_a_gain_less_sure_than_itself_is_not_determined_and_no_number_is_told(apart: Dataset) -> None:
    result = answer(apart)
    weak = replace(result.drive_gains["lift"], value=-2e-12, std=4.6e-11)
    told = with_findings(replace(result, drive_gains={**result.drive_gains, "lift": weak}), ())
    assert not weak.determined
    tables = markdown(gains_table(told)) + markdown(gains_before_after(told, told))
    nowhere = WhereItFails("robot", ())
    page = " ".join(identification_verdict(told, nowhere, 0.01)) + str(identification_tiles(told, 0.01))
    page += str(gains_section(told, None))
    for words in (repr(told), " ".join(told.notes), tables, page):
        assert "e-12" not in words
        assert "0.00000" not in words
        assert "-100" not in words
    assert "not determined" in tables
    assert "not determined" in page
    assert Code.GAIN_NOT_DETERMINED in {each.code for each in told.findings}
    assert not {Code.GAIN_RUNAWAY, Code.GAIN_NEGATIVE, Code.GAIN_FAR} & {each.code for each in told.findings}
    assert DriveGain(3.0, 2.0, "N*m/A", 3.0).determined


@pytest.mark.parametrize(
    ("effects", "said", "unsaid"),
    [
        (["viscous_friction"], "Declare more of the payload", "bench diagnose"),
        ([], "so the model lacks an effect: `bench diagnose` first", "Declare more"),
    ],
)
def test_a_gain_that_missing_friction_hides_is_diagnosed_first(
    apart: Dataset, effects: list[str], said: str, unsaid: str
) -> None:
    result = identify(prepare(problem_of(apart, effects)))
    weak = replace(result.drive_gains["lift"], value=-2e-12, std=4.6e-11)
    doubt = runaway(replace(result, drive_gains={**result.drive_gains, "lift": weak}))
    assert doubt is not None
    assert said in sentence(doubt)
    assert unsaid not in sentence(doubt)


def test_every_case_has_its_words() -> None:
    assert set(CODES) == set(ScaleCase) - {ScaleCase.FIXED}
    assert set(REASONS) == set(SHORT) == set(CODES.values())


@pytest.mark.parametrize(
    ("recordings", "wanted", "code"),
    [
        (("free.csv",), None, Code.GAINS_NOMINAL),
        (("free.csv", "held.csv"), False, Code.GAINS_NOT_WANTED),
    ],
)
def test_that_no_payload_was_weighed_is_said_only_where_it_is_so(
    apart: Dataset, recordings: tuple[str, ...], wanted: bool | None, code: Code
) -> None:
    some = replace(apart, recordings=tuple(one for one in apart.recordings if one.name in recordings))
    result = identify(prepare(problem_of(some, fit_gains=wanted)))
    assert scale_finding(result).code is code
    said = " ".join(result.notes)
    assert ("No fitted recording" in said or "no fitted recording" in said) == (code is Code.GAINS_NOMINAL)


def test_a_payload_that_was_not_weighed_is_named(apart: Dataset) -> None:
    found = scale_finding(answer(with_ball(apart)))
    assert (found.code, found.names, found.numbers) == (Code.PAYLOAD_NOT_WEIGHED, ("ball",), {"mass": 1.0})
    assert "the mass of the payload ball is not declared" in sentence(found)
    assert sentence(found).endswith("Declare its mass. That fixes 1 of 2.")


def test_an_experiment_with_a_load_that_fixes_nothing_says_so(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """It is planned for the parameters alone; asked for the gains, it is refused."""
    limits = tmp_path / "limits.toml"
    limits.write_text("[payload]\nmass = 1.0\n")
    words = ["excite", "wrist", "-o", str(tmp_path / "planned"), "--limits", str(limits), "--steps", "2"]
    assert main([*words, "--duration", "4"]) == 0
    said = " ".join(capsys.readouterr().out.split())
    assert "The drive gains stay at their nominal values, because the payload payload" in said
    assert "Declare its centre of mass." in said
    assert main([*words, "--for", "gains", "-q"]) == 2
    error = capsys.readouterr().err
    assert "Declare its centre of mass." in error
    assert error.count("\n") == 1


@pytest.mark.parametrize("mass", [1e-3, 1e-6])
def test_a_payload_that_hardly_shows_leaves_gains_unsure_and_the_model_right(mass: float) -> None:
    """From the gains of least squares, which fall to zero, the search did not come back."""
    inertia = [2e-3 * mass, 2e-3 * mass, 4e-3 * mass, 0.0, 0.0, 0.0]
    changes = {
        "step": 0.0005,
        "payloads": {"disc": {"mass": mass, "inertia": inertia, "declared": {"mass": mass}}},
        "design": {"optimise": False, "duration": 6.0},
    }
    result = answer(as_dataset(simulate(load_scenario("five_bar", changes), threads=1)))
    assert result.error.identify < 0.005  # noise leaves 0.0025
    for joint, true in (("left", 3.3), ("right", 2.76)):
        gain = result.drive_gains[joint]
        assert abs(gain.value - true) < 3.0 * gain.std
        assert gain.determined == (mass == 1e-3)
