"""Held-out rows that the fitted motions do not determine are not judged."""

from dataclasses import replace

import numpy as np
import pytest

from bench.api.diagnose import diagnose
from bench.dataset.dataset import Dataset
from bench.diagnosis.extrapolated import leverage, without_extrapolation
from bench.identification.compressed import stack_observations
from bench.identification.finding import Code, Finding
from bench.identification.prepare import Prepared, prepare
from bench.identification.problem import problem_of
from bench.identification.solve_only import identifiable, solved_quickly
from bench.identification.tolerances import TOLERANCES
from bench.scenario.scenario import load_scenario
from bench.truth.dataset import as_dataset
from bench.truth.simulate import simulate


@pytest.fixture(scope="module")
def whole() -> Dataset:
    """Of a serial arm of two links."""
    changes = {"design": {"optimise": False, "duration": 6.0}, "hidden": []}
    return as_dataset(simulate(load_scenario("two_link", changes)))


def fitted_at_first(whole: Dataset, seconds: float) -> Dataset:
    """Fitted only where the arm sets out, so that the held-out recordings go further."""
    recordings = tuple(
        recording.part(slice(0, round(seconds * recording.rate)))
        if recording.use == "identify"
        else recording
        for recording in whole.recordings
    )
    return replace(whole, recordings=recordings)


@pytest.fixture(scope="module")
def short(whole: Dataset) -> Dataset:
    return fitted_at_first(whole, 0.6)


def leverages(prepared: Prepared, use: str) -> np.ndarray:
    stack, solution = solved_quickly(prepared)
    asked = stack_observations(
        [seen for seen in prepared.observations if seen.use == use],
        prepared.layout,
        prepared.dataset.payloads,
    )
    return leverage(stack, asked, solution, identifiable(prepared, stack))


def test_fitted_rows_have_no_leverage_above_one_and_together_that_of_the_unknowns(short: Dataset) -> None:
    prepared = prepare(problem_of(short))
    fitted = leverages(prepared, "identify")
    stack, solution = solved_quickly(prepared)
    unknowns = (
        len(identifiable(prepared, stack))
        + np.broadcast_to(solution.gains_fitted, solution.gains.shape).sum()
    )
    assert fitted.max() <= TOLERANCES.statistics.leverage + 1e-9
    assert fitted.sum() == pytest.approx(unknowns)


def test_leverage_is_the_variance_of_what_the_model_gives(short: Dataset) -> None:
    """With as much noise at every motor: the scatter of the held-out torque over fits to fresh noise."""
    prepared = replace(prepare(problem_of(short, fit_gains=False)))
    stack, solution = solved_quickly(prepared)
    solution = replace(solution, weights=np.ones_like(solution.weights))
    kept = identifiable(prepared, stack)
    checked = [seen for seen in prepared.observations if seen.use == "validate"]
    asked = stack_observations(checked, prepared.layout, prepared.dataset.payloads)
    expected = leverage(stack, asked, solution, kept)
    by_gain = solution.gains[:, None]
    fitted, wanted = ((each.phi / by_gain)[:, :, kept].reshape(-1, len(kept)) for each in (stack, asked))
    noise = np.random.default_rng(1).standard_normal((len(fitted), 4000))
    given = wanted @ np.linalg.lstsq(fitted, noise, rcond=None)[0]
    assert given.var(axis=1) == pytest.approx(expected.ravel(), rel=0.2, abs=1e-12)


def test_where_the_held_out_motions_stay_within_the_fitted_ones_all_is_judged(whole: Dataset) -> None:
    prepared = prepare(problem_of(whole))
    judged, found = without_extrapolation(prepared)
    assert found == ()
    for before, after in zip(prepared.observations, judged.observations, strict=True):
        assert np.array_equal(before.moving, after.moving)


def test_rows_beyond_what_was_fitted_are_not_judged_and_the_answer_says_so(short: Dataset) -> None:
    prepared = prepare(problem_of(short))
    beyond = leverages(prepared, "validate") > TOLERANCES.statistics.leverage
    judged, found = without_extrapolation(prepared)
    before, after = (
        np.concatenate([seen.moving for seen in each.observations if seen.use == "validate"])
        for each in (prepared, judged)
    )
    few = beyond.mean(axis=0) > 0.5
    assert few.tolist() == [False, True]
    assert np.array_equal(after, before & (few | ~beyond))
    assert {each.code for each in found} == {Code.EXTRAPOLATED, Code.JUDGED_BEYOND}
    assert found[0].numbers["share"] == pytest.approx(1.0 - after.sum() / before.sum())
    answer = diagnose(short, discover=False)
    assert {Code.EXTRAPOLATED} <= {each.code for each in answer.after.findings}
    assert answer.missing == ()


def test_motors_that_are_hardly_anywhere_within_are_judged_everywhere_and_named(whole: Dataset) -> None:
    prepared = prepare(problem_of(fitted_at_first(whole, 0.4)))
    judged, found = without_extrapolation(prepared)
    assert found == (Finding(Code.JUDGED_BEYOND, tuple(prepared.dataset.robot.joints)),)
    for before, after in zip(prepared.observations, judged.observations, strict=True):
        assert np.array_equal(before.moving, after.moving)
