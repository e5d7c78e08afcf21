"""`identify --physical`: parameters that real bodies can have, where noise alone would make them impossible."""

import numpy as np
import pytest

from bench.api.identify import identify
from bench.basics.errors import BenchError
from bench.export.physical import physically_consistent
from bench.identification.finding import Code
from bench.identification.problem import problem_of
from tests.export_kit import simulated


@pytest.fixture(scope="module")
def noisy():
    return simulated.__wrapped__("five_bar", sensors={"current_noise_ratio": 0.6, "encoder_bits": 20})


def values_of(result):
    return {one.name: one.value for one in result.parameters}


def test_noise_that_makes_an_inertia_negative_is_kept_to_real_bodies(noisy):
    free, real = identify(noisy), identify(noisy, physical=True)
    assert values_of(free)["Iyy(left_rod)"] < 0.0 < values_of(real)["Iyy(left_rod)"]
    finding = next(one for one in real.findings if one.code == Code.PHYSICAL)
    assert 0.0 < finding.numbers["distance"] < finding.numbers["expected"]
    std = {one.name: one.std for one in free.parameters}
    moved = {name: (values_of(real)[name] - value) / std[name] for name, value in values_of(free).items()}
    assert max(map(abs, moved.values())) <= finding.numbers["distance"] + 1e-3
    assert np.array_equal(real.covariance, free.covariance)
    assert (
        0.0 < real.error.identify / free.error.identify - 1.0 < 1e-3
    )  # the errors are those of these values
    again = physically_consistent(real, problem_of(noisy))
    assert again.findings[-1].numbers == {"distance": 0.0}  # it is real now
    assert values_of(again) == values_of(real)


def test_what_real_bodies_have_stays_as_it_is():
    dataset = simulated("five_bar")
    free, real = (
        identify(dataset, ["viscous_friction"]),
        identify(dataset, ["viscous_friction"], physical=True),
    )
    assert values_of(real) == values_of(free)
    assert real.effect_parameters == free.effect_parameters
    assert real.drive_gains == free.drive_gains


def test_effects_and_gains_move_along(noisy):
    effects = ["viscous_friction", "coulomb_friction:left"]
    free, real = identify(noisy, effects), identify(noisy, effects, physical=True)
    assert real.findings[-1].numbers["distance"] > 0.0
    for before, after in ((free.drive_gains, real.drive_gains),):
        assert all(after[joint].value != one.value for joint, one in before.items())
        assert all(abs(after[joint].value - one.value) < one.std for joint, one in before.items())
    friction = free.effect_parameters["coulomb_friction"]["left"]["Fc"]
    assert (
        0.0
        < abs(real.effect_parameters["coulomb_friction"]["left"]["Fc"].value - friction.value)
        < friction.std
    )


def test_essential_parameters_cannot_be_kept_to_real_bodies(noisy):
    with pytest.raises(BenchError, match="--essential"):
        identify(noisy, essential=True, physical=True)
