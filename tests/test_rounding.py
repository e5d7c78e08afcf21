"""What hangs on rounding shows on one processor and not on another: the inputs are shaken, and no answer may move.

A few units in the last place of every position and current are what another processor's arithmetic amounts to.
"""

import json
from dataclasses import replace

import numpy as np
import pytest

from bench.dataset.dataset import load_dataset
from bench.diagnosis.with_catalogue import diagnose_with_catalogue
from bench.effects import CATALOGUE
from bench.identification.identify import identify
from bench.identification.partial_regression import PartialRegression
from bench.identification.prepare import prepare
from bench.identification.problem import Problem, problem_of
from bench.page.workbench import page_data as page_module
from bench.page.workbench.page_data import page_data
from tests.workbench_kit import diagnosis_of, write_dataset
from tests.workbench_sets import Carried

HIDDEN = (
    {"effect": "coulomb_friction", "joint": "left", "Fc": 0.2},
    {"effect": "viscous_friction", "joint": "left", "Fv": 0.1},
    {"effect": "cogging_torque", "joint": "right", "a": 0.0, "b": 0.2, "period": 0.3},
)
FOUND = ("coulomb_friction:left", "cogging_torque:right", "viscous_friction:left")
SETS = (
    (),
    FOUND,
    ("coulomb_friction", "stribeck_friction", "viscous_friction"),
    ("coulomb_friction:left", "drive_flexibility:left"),
    ("geometric_error:left_rod", "presliding_hysteresis"),
)
SEARCHED = ("backlash", "cogging_torque", "coulomb_friction", "geometric_error", "stribeck_friction")
UNITS = 4  # in the last place
SAME = 1e-9  # relative, of errors and gains
SURE = 1e-6  # of a parameter's standard deviation
# Of an effect that is not there, no data determine the shape: it is found to 1e-4, from noise, and the error on
# recordings that were not fitted follows it. Under OpenBLAS's Prescott kernel it moved by 4e-9, the evidence by 1e-6.
FLAT, NATS = 1e-7, 1e-4
CARRIED = {
    "exact": 2e-6,
    "short": 5e-5,
}  # relative, of errors on the page: of its numbers of 32 and of 16 bits


def shaken(dataset, seed):
    random = np.random.default_rng(seed)

    def moved(values):
        return values + random.integers(-UNITS, UNITS + 1, size=values.shape) * np.spacing(np.abs(values))

    recordings = (
        replace(one, position=moved(one.position), current=moved(one.current)) for one in dataset.recordings
    )
    return replace(dataset, recordings=tuple(recordings))


@pytest.fixture(scope="module")
def dataset(tmp_path_factory):
    return load_dataset(write_dataset(tmp_path_factory.mktemp("rounding") / "data", hidden=HIDDEN))


@pytest.fixture(scope="module")
def again(dataset):
    return shaken(dataset, seed=11)


def assert_same(one, other):
    for use in ("identify", "validate"):
        assert getattr(other.error, use) == pytest.approx(getattr(one.error, use), rel=SAME)
    for joint, gain in one.drive_gains.items():
        assert other.drive_gains[joint].value == pytest.approx(gain.value, rel=SAME)
    assert other.effect_parameters.keys() == one.effect_parameters.keys()
    for effect, places in one.effect_parameters.items():
        for place, values in places.items():
            for name, known in values.items():
                value = other.effect_parameters[effect][place][name].value
                near = SURE * known.std if np.isfinite(known.std) else 0.0
                assert value == pytest.approx(known.value, rel=SAME, abs=near), (effect, place, name)


def test_shaken_is_not_the_same_and_hardly_different(dataset, again):
    for one, other in zip(dataset.recordings, again.recordings, strict=True):
        assert (one.position != other.position).any()
        np.testing.assert_allclose(other.position, one.position, rtol=1e-14)
        np.testing.assert_allclose(other.current, one.current, rtol=1e-14)


@pytest.mark.parametrize("requests", SETS, ids=lambda one: "+".join(one) or "nothing")
def test_identify_does_not_hang_on_rounding(dataset, again, requests):
    assert_same(
        identify(prepare(problem_of(dataset, requests))), identify(prepare(problem_of(again, requests)))
    )


def test_diagnose_does_not_hang_on_rounding(dataset, again):
    catalogue = {name: CATALOGUE[name] for name in (*SEARCHED, "viscous_friction")}
    one, other = (diagnose_with_catalogue(Problem(each, catalogue)) for each in (dataset, again))
    assert set(one.missing) == {name.partition(":")[0] for name in FOUND}
    assert other.missing == one.missing
    assert_same(one.before, other.before)
    assert_same(one.after, other.after)
    for verdict, known in zip(other.ranking, one.ranking, strict=True):
        words = ("effect", "verdict", "actuators", "alternatives", "why")
        assert [getattr(verdict, word) for word in words] == [getattr(known, word) for word in words]
        flat = known.effect not in one.missing and any(
            not free.discrete for free in CATALOGUE[known.effect].shape
        )
        assert verdict.error_after == pytest.approx(known.error_after, rel=FLAT if flat else SAME)
        assert verdict.evidence == pytest.approx(known.evidence, rel=SAME, abs=NATS)
    assert other.unexplained.significant == one.unexplained.significant
    assert other.unexplained.noise_floor == pytest.approx(one.unexplained.noise_floor, rel=SAME)


@pytest.mark.parametrize("digits", CARRIED)
def test_the_workbench_does_not_hang_on_rounding(dataset, again, digits, monkeypatch):
    if digits == "short":
        monkeypatch.setattr(page_module, "MOST_BYTES", 0)
    names = ("cogging_torque", "coulomb_friction", "stribeck_friction", "viscous_friction")
    solvers = [
        Carried(json.loads(json.dumps(page_data(problem_of(each), diagnosis_of(each, FOUND, names)))))
        for each in (dataset, again)
    ]
    for requests in ((), FOUND, names):
        fits = [one.fit(one.keys(requests)) for one in solvers]
        assert fits[1].fitted == pytest.approx(fits[0].fitted, rel=CARRIED[digits])
        assert fits[1].held_out == pytest.approx(fits[0].held_out, rel=CARRIED[digits])
        np.testing.assert_allclose(fits[1].gains, fits[0].gains, rtol=CARRIED[digits])


def test_what_rounding_leaves_of_a_column_explains_nothing():
    random = np.random.default_rng(3)
    rows, model = 120, random.normal(size=(120, 4))
    orthonormal, triangle = np.linalg.qr(model)
    target = random.normal(size=rows)
    left = PartialRegression(
        model.reshape(-1, 2, 4).transpose(1, 0, 2),
        np.linalg.inv(triangle),
        (target - orthonormal @ (orthonormal.T @ target)).reshape(-1, 2),
        np.ones(2),
        np.ones((rows // 2, 2), bool),
    )
    new = random.normal(size=rows)
    alone, explained = left.explained(new.reshape(-1, 2, 1))
    taken_up = model @ random.normal(size=4)  # but for rounding
    both, with_it = left.explained(np.column_stack((taken_up, new)).reshape(-1, 2, 2))
    np.testing.assert_allclose(both, [0.0, alone[0]], rtol=1e-12)
    assert abs(with_it / explained - 1.0) < 1e-12
