"""A special case of a found effect is compared with it at its best, and is found beside it where both are there."""

import pytest

from bench.basics.progress import SILENT
from bench.dataset.dataset import Dataset
from bench.diagnosis import round as one_round
from bench.diagnosis.base_model import base_model_of
from bench.diagnosis.candidates import Proposal
from bench.diagnosis.round import with_shapes_of
from bench.diagnosis.rounds import round_about
from bench.diagnosis.with_catalogue import diagnose_with_catalogue
from bench.effects import CATALOGUE, EffectInstance
from bench.identification.nonlinear import converged
from bench.identification.prepare import prepare
from bench.identification.problem import problem_of
from bench.identification.solve_only import reshaped
from tests.discover_kit import measured

PRESLIDING = {"effect": "presliding_hysteresis", "Fc": 0.2, "stiffness": 8.0}
CABLE = {"effect": "hysteretic_cable", "F": 0.3, "reach": 0.2, "sharpness": 2.0}
LITTLE = {"effect": "presliding_hysteresis", "Fc": 0.03, "stiffness": 3.0}
FAR = 0.001  # rad: of a displacement too small to be seen, with which it is Coulomb friction


def at_both(name: str, **shape: float) -> tuple[EffectInstance, ...]:
    """An effect at both motors of a five-bar."""
    instances = (EffectInstance(CATALOGUE[name], joint, f"{name}:{joint}") for joint in ("left", "right"))
    return tuple(reshaped(instance, shape) for instance in instances)


def after_a_cable(dataset: Dataset, monkeypatch: pytest.MonkeyPatch) -> tuple[list[float], set[str]]:
    """Where a hysteretic cable was found, and presliding friction began at FAR, where it is no rival of it: the
    displacement that it is given at each motor, and the set that is best then.
    """
    monkeypatch.setattr(one_round, "_rival", lambda *_: None)
    base_model = base_model_of(converged(prepare(problem_of(dataset))))
    proposals = [
        Proposal("hysteretic_cable", at_both("hysteretic_cable"), False, ""),
        Proposal("presliding_hysteresis", at_both("presliding_hysteresis", x0=FAR), False, ""),
    ]
    model = base_model.with_proposals(proposals, [0])
    found = round_about(base_model, model, proposals, {"presliding_hysteresis"})
    assert found.names == {"hysteretic_cable"}
    after = one_round.reshaped_proposals(base_model, found, SILENT)
    values = [instance.effect.shape_values()["x0"] for instance in after[1].instances]
    return values, round_about(base_model, model, after, ()).names


def test_presliding_friction_has_its_name_where_a_cable_was_found(monkeypatch: pytest.MonkeyPatch) -> None:
    displacements, names = after_a_cable(measured(PRESLIDING), monkeypatch)
    assert displacements == pytest.approx([0.2 / 8.0] * 2, rel=0.05)
    assert names == {"presliding_hysteresis"}


def test_what_shows_beside_a_cable_has_its_shape_beside_it(monkeypatch: pytest.MonkeyPatch) -> None:
    displacements, names = after_a_cable(measured(CABLE, LITTLE), monkeypatch)
    assert max(displacements) < 0.02  # of the cable it is ten times as much
    assert names == {"hysteretic_cable", "presliding_hysteresis"}


def test_a_cable_alone_keeps_its_name(monkeypatch: pytest.MonkeyPatch) -> None:
    _, names = after_a_cable(measured(CABLE), monkeypatch)
    assert names == {"hysteretic_cable"}


def test_presliding_friction_beside_a_cable_is_found_with_it() -> None:
    found = diagnose_with_catalogue(problem_of(measured(CABLE, LITTLE)))
    assert set(found.missing) == {"hysteretic_cable", "presliding_hysteresis"}


def test_a_special_case_takes_its_shape_from_the_same_joint() -> None:
    wholes = [reshaped(at_both("hysteretic_cable")[0], {"x0": 0.024, "n": 1.01})]
    parts = with_shapes_of(wholes, at_both("presliding_hysteresis", x0=FAR))
    assert [part.effect.shape_values() for part in parts] == [{"x0": 0.024}, {"x0": FAR}]
