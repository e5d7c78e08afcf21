"""Whether a found effect shows at a joint: size and shape can go together."""

from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest

from bench.diagnosis.significance import is_significant
from bench.effects import CATALOGUE, EffectInstance
from bench.identification.finding import Unknown
from bench.identification.result import Identification, Quantity

THINNING = EffectInstance(CATALOGUE["shear_thinning_friction"], "left", "shear_thinning_friction:left")


def found(value: float, std: float, correlation: float, of_shape: float = 0.4) -> Identification:
    """A friction Fa of this size with a velocity va, that its data tell together."""
    values = {"Fa": Quantity(value, std, "N*m"), "va": Quantity(0.9, of_shape, "rad/s")}
    across = correlation * std * of_shape
    return cast(
        "Identification",
        SimpleNamespace(
            effect_parameters={"shear_thinning_friction": {"left": values}},
            covariance=np.array([[std**2, across], [across, of_shape**2]]),
            covariance_rows=tuple(
                Unknown("effect", one, "left", "shear_thinning_friction") for one in ("Fa", "va")
            ),
        ),
    )


@pytest.mark.parametrize(
    ("value", "std", "correlation", "of_shape", "there"),
    [
        (2.0, 0.84, 0.0, 0.4, False),  # what it is by itself
        (2.0, 0.84, 0.95, 0.4, True),  # nearly a straight line: Fa/va is known
        (2.0, 0.84, 0.95, 0.0, False),  # a shape that was given
        (2.0, 0.5, 0.0, 0.4, True),
        (-2.0, 0.5, 0.0, 0.4, False),  # it would drive
        (2.0, np.inf, 0.0, 0.4, False),  # the data say nothing of it
    ],
)
def test_an_effect_shows(value: float, std: float, correlation: float, of_shape: float, there: bool) -> None:
    with np.errstate(invalid="ignore"):
        result = found(value, std, correlation, of_shape)
    assert is_significant(result, THINNING) is there


@pytest.mark.parametrize(("chi_squared", "there"), [(28.0, False), (36.0, True)])
def test_a_wave_shows_where_it_is_more_than_the_best_of_all_periods_is_by_chance(
    chi_squared: float, there: bool
) -> None:
    """Seen: 0.02 % of a torque, of two to three motors without cogging, at the period that fits their noise best."""
    cogging = EffectInstance(CATALOGUE["cogging_torque"], "left", "cogging_torque:left")
    size, std = float(np.sqrt(chi_squared)), 1.0
    values = {
        "a": Quantity(size, std, "N*m"),
        "b": Quantity(0.0, std, "N*m"),
        "periods": Quantity(777.4, 2.6, "1/turn"),
    }
    rows = tuple(Unknown("effect", name, "left", "cogging_torque") for name in values)
    result = SimpleNamespace(
        effect_parameters={"cogging_torque": {"left": values}},
        covariance=np.diag([std**2, std**2, 2.6**2]),
        covariance_rows=rows,
    )
    assert is_significant(cast("Identification", result), cogging) is there
