"""A current or position of the wrong sign is named before anything is searched; a missing effect is not suspected."""

from dataclasses import replace

import numpy as np
import pytest

from bench.api.diagnose import diagnose
from bench.basics.errors import BenchError
from bench.dataset.dataset import load_dataset
from bench.dataset.logs.units import UNITS
from bench.dataset.robot import load_robot
from bench.identification.finding import (
    CAUSES,
    MEND_FIRST,
    NEGATIVE,
    UNBELIEVABLE,
    Code,
    Finding,
    mended_first,
    to_mend,
)
from bench.identification.finding_words import sentence
from bench.identification.identify import identify
from bench.identification.mistaken import mistaken, refuse_signs
from bench.identification.prepare import prepare
from bench.identification.problem import problem_of
from bench.identification.reversed_columns import changes
from bench.identification.tolerances import TOLERANCES
from bench.scenario.scenario import load_scenario, resolve_trajectories
from bench.truth.dataset import as_dataset
from bench.truth.simulate import simulate
from tests.hidden_kit import STEP
from tests.workbench_kit import FRICTION, write_dataset


@pytest.fixture(scope="module")
def lacking(tmp_path_factory):
    strong = [one | {"Fc": 2.0} if "Fc" in one else one for one in FRICTION]
    return load_dataset(write_dataset(tmp_path_factory.mktemp("lacking") / "d", hidden=strong))


def turned(data, signs, name=""):
    recordings = tuple(
        replace(one, current=one.current * np.array(signs)) if name in ("", one.name) else one
        for one in data.recordings
    )
    return replace(data, recordings=recordings)


@pytest.mark.parametrize(
    ("signs", "name", "said"),
    [
        ([1.0, -1.0], "", "The sign of current.right is probably reversed"),
        ([-1.0, 1.0], "", "The sign of current.left is probably reversed"),
        ([1.0, -1.0], "held.csv", "The sign of current.right in held.csv is probably reversed"),
    ],
)
def test_it_is_named_though_friction_is_missing_and_refused_by_a_diagnosis(lacking, signs, name, said):
    wrong = turned(lacking, signs, name)
    (finding,) = mistaken(problem_of(wrong), identify(prepare(problem_of(wrong))))
    assert sentence(finding).startswith(said)
    joint = "right" if signs[1] < 0 else "left"
    assert f"`--scale current.{joint}=-1 --replace`" in sentence(finding)
    with pytest.raises(BenchError, match=said):
        diagnose(wrong)


def exchanged(data):
    """The same recordings, each with the other one's load."""
    loads = sorted({one.payload for one in data.recordings}, key=str)
    other = dict(zip(loads, reversed(loads), strict=True))
    return replace(
        data, recordings=tuple(replace(one, payload=other[one.payload]) for one in data.recordings)
    )


def test_exchanged_loads_are_told_from_reversed_signs_of_all_currents(lacking):
    """Both make all drive gains negative with the same error; friction takes power from the motors in one only."""
    wrong = exchanged(lacking)
    (finding,) = mistaken(problem_of(wrong), identify(prepare(problem_of(wrong))))
    assert finding.code is Code.LOADS_EXCHANGED
    with pytest.raises(BenchError, match="are probably exchanged"):
        diagnose(wrong)
    wrong = turned(lacking, [-1.0, -1.0])
    findings = mistaken(problem_of(wrong), identify(prepare(problem_of(wrong))))
    assert [finding.code for finding in findings] == [Code.CURRENT_REVERSED, Code.CURRENT_REVERSED]


def test_nothing_is_suspected_of_a_missing_effect(lacking):
    result = identify(prepare(problem_of(lacking)))
    assert result.error.identify > TOLERANCES.findings.large_error
    assert mistaken(problem_of(lacking), result) == ()


def test_a_negative_gain_of_a_model_that_explains_the_currents_is_refused(lacking):
    before = identify(prepare(problem_of(lacking)))
    negative = replace(before, findings=(Finding(Code.SIGN_REVERSED, ("left",)),))
    refuse_signs(lacking.folder, (), negative)
    explained = replace(negative, error=replace(before.error, identify=0.01))
    with pytest.raises(BenchError, match="drive gain of left is negative"):
        refuse_signs(lacking.folder, (), explained)


def test_signs_are_mended_first():
    findings = [Finding(Code.SHORT, ("a.csv",)), Finding(Code.SIGN_REVERSED, ("left",))]
    assert [finding.code for finding in mended_first(findings)] == [Code.SIGN_REVERSED, Code.SHORT]
    assert NEGATIVE < UNBELIEVABLE < MEND_FIRST
    assert Code.CURRENT_REVERSED in CAUSES


@pytest.mark.parametrize(
    ("code", "error_left", "mended"),
    [
        (Code.GAIN_RUNAWAY, True, False),  # a diagnosis names the effect that is missing
        (Code.GAIN_RUNAWAY, False, True),
        (Code.CURRENT_REVERSED, True, True),
        (Code.GAINS_ALIKE, True, True),
        (Code.POORLY_DETERMINED, False, False),
    ],
)
def test_gains_that_a_missing_effect_moves_are_a_matter_for_a_diagnosis(code, error_left, mended):
    assert to_mend([Finding(code, ("left",))], error_left=error_left) is mended


SCENARIO = """
robot = "crank_slide"
step = {step}
[payloads.weight]
mass = 1.0
[design]
span = {{ crank = 0.6, carriage = 0.08 }}
velocity_limit = {{ crank = 4.0, carriage = 0.5 }}
acceleration_limit = {{ crank = 40.0, carriage = 6.0 }}
duration = 5
[[recordings]]
name = "empty"
use = "identify"
design = {{ seed = 1 }}
[[recordings]]
name = "loaded"
use = "identify"
payload = "weight"
design = {{ seed = 2 }}
"""


def test_an_encoder_that_counts_backwards_is_named_and_refused(tmp_path):
    (tmp_path / "scenario.toml").write_text(SCENARIO.format(step=STEP))
    scenario = load_scenario(tmp_path / "scenario.toml")
    data = as_dataset(simulate(scenario, resolve_trajectories(scenario), threads=1))
    recordings = tuple(replace(one, position=one.position * [-1.0, 1.0]) for one in data.recordings)
    with pytest.raises(
        BenchError, match=r"The sign of position.crank is probably reversed.*position.crank=-1"
    ):
        diagnose(replace(data, recordings=recordings))


@pytest.mark.parametrize("scale", [1.0, UNITS["deg"].factor / UNITS["mm"].factor])
def test_angle_and_travel_are_exchanged_in_the_units_that_a_log_states(scale):
    right = np.array([[-1.7, 0.45], [-1.6, 0.47]])
    wrong = right[:, ::-1] * [scale, 1.0 / scale]
    exchanged = [change for change in changes(load_robot("crank_slide")) if len(change.joints) > 1]
    assert {change.code for change in exchanged} == {Code.POSITIONS_SWAPPED}
    assert any(np.allclose(change.of(wrong), right) for change in exchanged)


def test_a_wrong_mass_is_no_undeclared_load(lacking):
    disc = replace(lacking.payloads["disc"], mass=1.75 * lacking.payloads["disc"].mass)
    wrong = replace(lacking, payloads={"disc": disc})
    assert mistaken(problem_of(wrong), identify(prepare(problem_of(wrong)))) == ()


def test_a_load_that_nobody_declares_is_named_with_its_mass(lacking):
    recordings = tuple(replace(one, payload=None) for one in lacking.recordings)
    wrong = replace(lacking, recordings=recordings, payloads={})
    (finding,) = mistaken(problem_of(wrong), identify(prepare(problem_of(wrong))))
    assert (finding.code, finding.names) == (Code.LOAD_UNDECLARED, ("held.csv",))
    assert finding.numbers["mass"] == pytest.approx(lacking.payloads["disc"].mass, rel=0.2)
    assert sentence(finding).startswith("held.csv probably carries a load that is not declared")
