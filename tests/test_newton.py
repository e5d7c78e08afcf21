"""Steps of Gauss and Newton of what is not linear in a model's effects."""

from dataclasses import replace

import numpy as np
import pytest

from bench.effects import CATALOGUE, EffectInstance
from bench.identification.joint_samples import joint_samples
from bench.identification.newton import stepped
from bench.identification.partial_regression import partial_regression
from bench.identification.prepare import Prepared, prepare, with_effects
from bench.identification.problem import problem_of
from bench.identification.solve_only import candidate_columns, reshaped, solved_quickly, spread
from bench.truth.dataset import as_dataset
from bench.truth.simulate import Simulation

TRUE, BEGUN = 0.03, 0.05  # rad


def at_left(name: str, **shape: float) -> EffectInstance:
    return reshaped(EffectInstance(CATALOGUE[name], "left", name), shape)


@pytest.fixture(scope="module")
def lowest(five_bar_simulation: Simulation) -> tuple[Prepared, float]:
    """A five-bar with presliding friction, and a shear-thinning one faster than its speed is searched for: a model with
    both, that speed at its lower end.
    """
    plain = prepare(problem_of(as_dataset(five_bar_simulation)))
    thinning = at_left("shear_thinning_friction")
    lacks = partial_regression(*solved_quickly(plain)).lacks
    brackets = thinning.effect.brackets_near(thinning.effect.shape[0], joint_samples(plain, thinning, lacks))
    low = min(one[0] for one in brackets)
    hidden = [at_left("presliding_hysteresis", x0=TRUE), reshaped(thinning, {"va": 0.2 * low})]
    torque = candidate_columns(plain, hidden) @ np.array([0.3, 0.3])
    observed, at = [], 0
    for one in plain.observations:
        if one.use == "identify":
            own = torque[at : at + len(one.time)] / plain.dataset.robot.nominal_gains
            at += len(own)
            one = replace(one, current=one.current + own)  # noqa: PLW2901
        observed.append(one)
    shown = replace(plain, observations=tuple(observed), kept={})
    begun = [at_left("presliding_hysteresis", x0=BEGUN), reshaped(thinning, {"va": low})]
    return with_effects(shown, begun), low


def test_what_wants_past_the_end_of_its_range_stays_there_and_the_rest_moves(
    lowest: tuple[Prepared, float],
) -> None:
    model, low = lowest
    before = spread(*solved_quickly(model))
    found = stepped(model, *solved_quickly(model))
    assert found is not None
    moved, *solved = found
    assert np.mean((spread(*solved) / before) ** 2) < 1.0
    x0, va = (one.effect.shape_values() for one in moved.effects)
    assert va["va"] == low
    assert abs(x0["x0"] - TRUE) < 0.5 * abs(BEGUN - TRUE)


def test_steps_end_where_nothing_is_left_that_may_move(lowest: tuple[Prepared, float]) -> None:
    model, _ = lowest
    alone = with_effects(model, model.effects[1:])
    found = stepped(alone, *solved_quickly(alone))
    assert found is not None
    assert found[0].effects == alone.effects
