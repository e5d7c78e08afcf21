"""Effects that the model has already take part in a diagnosis: they stay, give way to others, or leave."""

import json

import pytest

from bench.cli import main
from bench.dataset.dataset import Dataset, load_dataset
from bench.diagnosis.as_json import diagnosis_json
from bench.diagnosis.result import Diagnosis, Superfluous
from bench.diagnosis.summary import summary_sentences
from bench.diagnosis.with_catalogue import diagnose_with_catalogue
from bench.identification.problem import problem_of
from tests.workbench_kit import RECORDINGS, write_dataset

DELAYS = ("current_loop_lag", "current_delay")
PUBLISHED = ("viscous_friction", "coulomb_friction", "constant_offset")


@pytest.fixture(scope="module")
def dataset(tmp_path_factory) -> Dataset:
    """With Coulomb and viscous friction at the left motor."""
    return load_dataset(
        write_dataset(tmp_path_factory.mktemp("starting") / "data", recordings=RECORDINGS[:3])
    )


@pytest.fixture(scope="module")
def burdened(dataset: Dataset) -> Diagnosis:
    """Beside one of the two, from a model with an effect that is not there."""
    return diagnose_with_catalogue(problem_of(dataset, ("viscous_friction:left", "constant_offset")))


def test_what_is_not_there_leaves_and_what_lacks_is_found(burdened: Diagnosis) -> None:
    assert burdened.missing == ("coulomb_friction",)
    assert burdened.superfluous == (Superfluous("constant_offset", None),)
    assert set(burdened.after.effects) == {"viscous_friction:left", "coulomb_friction:left"}
    assert burdened.before.effects == ("viscous_friction:left", "constant_offset")


def test_errors_are_those_of_the_model_as_it_was_and_as_it_is(burdened: Diagnosis) -> None:
    first, last = burdened.ladder
    assert (first.effects, last.effects) == ((), ("coulomb_friction",))
    assert first.validate == burdened.before.error.validate
    assert last.validate == burdened.after.error.validate
    assert last.validate < 1.1 * burdened.unexplained.noise_floor


def test_only_what_the_model_may_lack_is_ranked(burdened: Diagnosis) -> None:
    ranked = {one.effect: one for one in burdened.ranking}
    assert ranked["coulomb_friction"].actuators == ("left",)
    assert not {"constant_offset", "viscous_friction"} & set(ranked)
    assert {one.verdict for one in burdened.ranking if one.effect not in burdened.missing} <= {
        "not supported",
        "absorbed",
    }


def test_it_is_said(burdened: Diagnosis) -> None:
    said = (
        "Of the effects in the given model, constant offset is superfluous: the error is no larger without."
    )
    assert said in summary_sentences(burdened)
    content = json.loads(json.dumps(diagnosis_json(burdened)))
    assert content["superfluous"] == [{"effect": "constant_offset", "replaced_by": None}]


def test_a_model_that_has_all_keeps_it(dataset: Dataset) -> None:
    found = diagnose_with_catalogue(problem_of(dataset, ("viscous_friction:left", "coulomb_friction:left")))
    assert (found.missing, found.superfluous) == ((), ())
    assert set(found.after.effects) == {"viscous_friction:left", "coulomb_friction:left"}


def test_both_ways_lead_to_the_same_set_on_measured_data(measured_data, tmp_path) -> None:
    log = measured_data / "emps" / "DATA_EMPS.mat"
    if not log.is_file():
        pytest.skip("the measured EMPS data are not here (set PARABENCH_DATA)")
    columns = ["--map", "position.axis=qm", "--map", "current.axis=vir", "--map", "time=t"]
    assert main(["import", str(log), "--robot", "emps", *columns, "-o", str(tmp_path / "emps")]) == 0
    data = load_dataset(tmp_path / "emps")
    bare, published = (
        diagnose_with_catalogue(problem_of(data)),
        diagnose_with_catalogue(problem_of(data, PUBLISHED)),
    )

    def names(found: Diagnosis) -> set[str]:
        return set(found.after.effect_parameters)

    assert names(published) == names(bare) == {"asymmetric_viscous_friction", "coulomb_friction"}
    delays = [verdict for verdict in bare.ranking if verdict.effect in DELAYS]
    assert [verdict.verdict for verdict in delays] == ["not supported", "not supported"]
    assert delays[0].evidence == pytest.approx(delays[1].evidence, abs=0.5), "0.7 ms at 1 kHz: hardly apart"
    assert published.after.error.validate == pytest.approx(bare.after.error.validate, rel=1e-3)
    assert published.superfluous == (
        Superfluous("viscous_friction", "asymmetric_viscous_friction"),
        Superfluous("constant_offset", None),
    )
