"""The band of the fit, checked by what the parameters do in half of it."""

from dataclasses import replace

import numpy as np
import pytest

from bench.basics.chi_squared import WITHIN_95
from bench.benchmarks.measured.machines import MACHINES
from bench.benchmarks.measured.repeats import COMPARED, repeats_markdown, repeats_of
from bench.identification import bandwidth
from bench.identification.chosen_band import prepare_checked
from bench.identification.finding import Code, Unknown
from bench.identification.identify import fit, identify
from bench.identification.model_averaged import estimates
from bench.identification.model_json import from_json, to_json
from bench.identification.prepare import prepare
from bench.identification.problem import problem_of
from bench.page.section_parameters import band_figure
from bench.scenario.scenario import load_scenario
from bench.truth.dataset import as_dataset
from bench.truth.simulate import simulate

JITTER = 4e-3  # s, between when a position was measured and its stamp


@pytest.fixture(scope="module")
def clean():
    return as_dataset(simulate(load_scenario("two_link", {"design": {"optimise": False, "duration": 10.0}})))


def jittered(recording, seed):
    """The recording by a controller that reads its encoders up to JITTER before the stamp, ten rows alike."""
    random = np.random.default_rng(seed)
    late = np.repeat(random.uniform(0.0, JITTER, len(recording.time) // 10 + 1), 10)[: len(recording.time)]
    position = [np.interp(recording.time - late, recording.time, column) for column in recording.position.T]
    return replace(recording, position=np.stack(position, axis=1))


@pytest.fixture(scope="module")
def with_jitter(clean):
    return replace(clean, recordings=tuple(jittered(each, i) for i, each in enumerate(clean.recordings)))


def test_a_band_that_holds_jitter_is_narrowed(clean, with_jitter):
    """By noise that grows with the speed, which no floor of the spectrum shows."""
    problem = problem_of(with_jitter)
    plain, checked = prepare(problem), prepare_checked(problem)
    assert checked.settings.decimation >= 2 * plain.settings.decimation
    assert checked.rejected[0] == plain.settings
    answer, before = identify(checked), fit(plain)
    true = estimates(fit(prepare(problem_of(clean))))

    def off(result):
        there = estimates(result)
        return np.array([(there[u].value - true[u].value) / there[u].std for u in true if there[u].std > 0.0])

    assert (np.abs(off(before)) < WITHIN_95).mean() < 0.75
    assert (np.abs(off(answer)) < WITHIN_95).all()
    for joint, gain in answer.drive_gains.items():
        at_first = before.drive_gains[joint].value
        value = true[Unknown("gain", "gain", joint)].value
        assert abs(gain.value - value) < 0.1 * abs(at_first - value)
    assert Code.BAND_NARROWED in {finding.code for finding in answer.findings}
    assert [point.band for point in answer.bandwidths] == sorted(
        (point.band for point in answer.bandwidths), reverse=True
    )
    assert answer.settings.position_cutoff in {point.position_cutoff for point in answer.bandwidths}


def test_a_clean_log_stays_as_it_is(clean):
    problem = problem_of(clean)
    checked = prepare_checked(problem)
    assert checked.settings == prepare(problem).settings
    plain, answer = fit(checked), identify(checked)
    assert not {Code.BAND_NARROWED, Code.BAND_MATTERS} & {finding.code for finding in answer.findings}
    wider = [estimates(answer)[u].std / each.std for u, each in estimates(plain).items() if each.std > 0.0]
    assert max(wider) < 1.5
    assert np.median(wider) == pytest.approx(1.0)


def test_filters_that_are_given_stay_and_are_doubted(with_jitter):
    given = prepare(problem_of(with_jitter)).settings
    prepared = prepare_checked(problem_of(with_jitter, filters=given))
    assert prepared.settings == given
    answer = identify(prepared)
    assert Code.BAND_MATTERS in {finding.code for finding in answer.findings}
    assert answer.std_from == "bandwidth"


def test_the_curve_is_kept(clean):
    answer = identify(prepare_checked(problem_of(clean)))
    assert len(answer.bandwidths) == 2
    assert from_json(to_json(answer)).bandwidths == answer.bandwidths
    assert all(Unknown("gain", "gain", joint) in answer.bandwidths[0].values for joint in answer.drive_gains)


def test_the_report_draws_the_curve(clean):
    answer = identify(prepare_checked(problem_of(clean)))
    (figure,) = band_figure(answer)
    errors, changes = figure.variants[""].charts[0].spec["panels"]
    bands = sorted(point.band for point in answer.bandwidths)
    fitted, held_out, chosen = errors["series"]
    assert fitted["x"] == held_out["x"] == pytest.approx(bands, rel=1e-2)
    assert chosen["at"] == pytest.approx(answer.settings.band(clean.recordings[0].rate), rel=1e-3)
    assert all(0.0 in line["y"] for line in changes["series"][:-1]), (
        "in the band of the answer nothing changes"
    )
    assert band_figure(replace(answer, bandwidths=answer.bandwidths[:1])) == []


def test_equations_of_half_of_the_band_are_made_once(clean, monkeypatch):
    prepared = prepare_checked(problem_of(clean))
    expected = identify(prepared)
    again = replace(prepared, halved=None)
    assert to_json(identify(again)) == to_json(expected)
    monkeypatch.setattr(bandwidth, "prepare", None)
    assert identify(prepared).bandwidths == expected.bandwidths


@pytest.mark.parametrize(
    "compared", [each for each in COMPARED if each[0] in ("mtm", "psm1", "emps", "psm", "ur10e")]
)
def test_measured_logs_of_a_machine_agree(measured_data, tmp_path, compared):
    """Values from one log each, or half of all, over their stated errors."""
    name, kind, logs = compared
    folder = MACHINES[name](measured_data / name, tmp_path)
    repeats = repeats_of(name, folder, kind, logs)
    assert repeats.reached, repeats
    assert f"| {name} |" in repeats_markdown([repeats], {"commit": "abc"})


def test_a_band_that_cannot_be_checked_is_named(clean, monkeypatch):
    prepared = prepare_checked(problem_of(clean))
    assert Code.BAND_UNCHECKED not in {finding.code for finding in identify(prepared).findings}
    monkeypatch.setattr(bandwidth, "narrower", lambda _: None)
    assert Code.BAND_UNCHECKED in {finding.code for finding in identify(prepared).findings}
