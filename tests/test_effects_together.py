"""Effects that act on each other: a model that is told of all of them leaves nothing of a log without noise."""

import functools
import json
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
import pytest

from bench.dataset.dataset import Dataset
from bench.excitation.scenario import designer
from bench.identification.identify import identify
from bench.identification.prepare import prepare
from bench.identification.problem import problem_of
from bench.identification.result import Identification, Quantity
from bench.scenario.scenario import load_scenario, resolve_trajectories
from bench.truth.dataset import as_dataset
from bench.truth.simulate import simulate
from tests.hidden_kit import STEP

Hidden = Mapping[str, object]
LEFT, RIGHT = {"joint": "left"}, {"joint": "right"}
SOFT = {"effect": "drive_flexibility", "stiffness": 300.0, "damping": 0.1, "rotor_inertia": 0.003, **LEFT}
OFFSETS = (
    {"effect": "encoder_offset", "offset": 0.08, **LEFT},
    {"effect": "encoder_offset", "offset": -0.06, **RIGHT},
)
COGGING = tuple(
    {"effect": "cogging_torque", "a": 0.0, "b": 0.3, "period": 0.2, **joint} for joint in (LEFT, RIGHT)
)


def without_noise(*hidden: Hidden) -> Dataset:
    return _simulated(json.dumps(hidden))


@functools.cache
def _simulated(hidden: str) -> Dataset:
    changes = {
        "design": {"optimise": False, "duration": 8.0},
        "sensors": {"encoder_bits": 0, "current_noise_ratio": 0.0},
        "hidden": json.loads(hidden),
        "step": STEP,
    }
    scenario = load_scenario("five_bar", changes)
    return as_dataset(simulate(scenario, resolve_trajectories(scenario, designer)))


def told(dataset: Dataset, hidden: Sequence[Hidden]) -> Identification:
    requests = (f"{one['effect']}:{one['joint']}" if "joint" in one else str(one["effect"]) for one in hidden)
    return identify(prepare(problem_of(dataset, list(dict.fromkeys(requests)))))


@pytest.mark.parametrize(
    ("hidden", "left"),
    [
        ((SOFT,), 3e-4),
        # a motor's friction is no load of its spring, and what it does at reversals swings the link
        ((SOFT, {"effect": "viscous_friction", "Fv": 0.1}), 3e-4),
        ((SOFT, {"effect": "coulomb_friction", "Fc": 0.1}), 3e-3),
        # what shakes the link faster than it swings asks for the other sign of a stiff drive's compliance
        ((SOFT, {"effect": "cogging_torque", "a": 0.0, "b": 0.3, "period": 0.2, **RIGHT}), 2e-3),
        # a spring of the link is a load of the drive's spring
        ((SOFT, {"effect": "joint_spring", "k": 1.0, "q0": -1.0, **LEFT}), 1.5e-4),
        ((SOFT, {"effect": "passive_viscous_friction", "Fv": 0.05}), 3e-4),
        (OFFSETS, 3e-5),
        ((*OFFSETS, {"effect": "passive_viscous_friction", "Fv": 0.05}), 3e-5),
        ((*OFFSETS, {"effect": "current_loop_lag", "T": 0.003}), 1e-4),
        ((*COGGING, {"effect": "viscous_friction", "Fv": 0.1}), 1e-4),
    ],
    ids=lambda one: "+".join(dict.fromkeys(e["effect"] for e in one)) if isinstance(one, tuple) else "",
)
def test_a_model_that_was_told_leaves_nothing(hidden: Sequence[Hidden], left: float) -> None:
    result = told(without_noise(*hidden), hidden)
    assert result.error.validate is not None
    assert result.error.validate < left


def test_a_compliance_and_its_rotor_are_found_beside_a_friction() -> None:
    hidden = (SOFT, {"effect": "viscous_friction", "Fv": 0.1})
    found = told(without_noise(*hidden), hidden).effect_parameters["drive_flexibility"]["left"]
    assert found["C"].value == pytest.approx(1 / 300.0, rel=0.01)
    assert found["CIa"].value == pytest.approx(0.003 / 300.0, rel=0.1)


def test_deviations_of_a_shape_are_those_that_noise_makes() -> None:
    """Of periods, a Stribeck velocity would do as well: what is found stands at the very best of all shapes."""
    clean = without_noise(*COGGING)
    true = _periods(told(clean, COGGING))
    sizes = np.concatenate([one.current for one in clean.recordings]).std(axis=0)
    squares = []
    for seed in range(16):
        rng = np.random.default_rng(seed)
        noisy = replace(
            clean,
            recordings=tuple(
                replace(one, current=one.current + 0.01 * sizes * rng.normal(size=one.current.shape))
                for one in clean.recordings
            ),
        )
        for one, exact in zip(_periods(told(noisy, COGGING)), true, strict=True):
            squares.append(((one.value - exact.value) / one.std) ** 2)
    assert 0.6 < np.sqrt(np.mean(squares)) < 1.35


def _periods(result: Identification) -> list[Quantity]:
    places = result.effect_parameters["cogging_torque"]
    return [places[joint]["periods"] for joint in ("left", "right")]
