"""Whether a found effect shows at a joint: size and shape can go together."""

from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest

from bench.diagnosis.showing import shows
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
    assert shows(result, THINNING) is there
