"""One power of the velocity where several functions of it come near one, and the frictions that there truly are."""

import numpy as np
import pytest

from bench.diagnosis.discovery.factors import Memory, Power
from bench.diagnosis.discovery.find import find_missing_effects
from bench.diagnosis.discovery.grammar import LOAD, V
from bench.diagnosis.discovery.laws import Law
from bench.diagnosis.discovery.merged import Part, fewer, parts_of, together, unknowns, with_another
from bench.diagnosis.discovery.source import law_effect
from bench.diagnosis.discovery.term import Term
from bench.diagnosis.discovery.variables import Place
from bench.diagnosis.result import Diagnosis
from bench.effects import CATALOGUE, EffectInstance
from bench.identification.tolerances import TOLERANCES
from tests.discover_kit import BRAKED, FRICTIONS, among, measured

FLOOR = 1.15  # times the noise: what may be left
LEFT = Place(("left", "right"), (True, True), 0)
BRAKED_LEFT = {**BRAKED, "joint": "left"}


def power(c: float, exponent: float, joint: str = "left") -> dict[str, object]:
    return {"effect": "product_law", "joint": joint, "c": c, "direction": 1.0, "v": exponent}


def diagnosed(*hidden: dict[str, object]) -> Diagnosis:
    found = find_missing_effects(among(FRICTIONS, measured(*hidden)))
    assert found.unexplained.error < FLOOR * found.unexplained.noise_floor
    return found


@pytest.mark.parametrize(
    "powers",
    [{"left": (0.3, 2.4)}, {"left": (0.14, 0.57), "right": (0.14, 1.6)}, {"left": (0.08, 1.37)}],
    ids=["one motor", "two motors", "a small one"],
)
def test_one_power_of_the_velocity_stands_for_several_functions_that_are_near_it(
    powers: dict[str, tuple[float, float]],
) -> None:
    """With 0.57 three effects of the catalogue leave no more than noise, with 1.6 two leave a little more, and with
    1.37 two and a friction that varies with the position leave no more.
    """
    found = diagnosed(*(power(*values, joint) for joint, values in powers.items()))
    assert found.missing == ()
    assert {law.place for law in found.discovered} == set(powers)
    for law in found.discovered:
        c, exponent = powers[law.place]
        assert law.numbers["p"].value == pytest.approx(exponent, abs=0.02)
        assert law.terms[0].value == pytest.approx(c, rel=0.02)


def test_beside_what_goes_by_something_else_it_is_one_power_too() -> None:
    found = diagnosed(power(0.3, 1.6), {"effect": "joint_spring", "k": 3.0, "q0": -1.0})
    assert found.missing == ("joint_spring",)
    (law,) = found.discovered
    assert law.numbers["p"].value == pytest.approx(1.6, abs=0.02)


THERE = {
    "left": {"viscous_friction": {"Fv": 0.1}, "quadratic_drag": {"c": 0.05}},
    "right": {
        "stribeck_friction": {"Fc": 0.1, "Fs": 0.1, "vs": 0.3},
        "viscous_friction": {"Fv": 0.1},
    },
}


@pytest.mark.parametrize("beside", [(), (BRAKED_LEFT,)], ids=["alone", "beside a law"])
def test_frictions_that_are_there_keep_their_names(beside: tuple[dict[str, object], ...]) -> None:
    hidden = [
        {"effect": name, "joint": joint, **values}
        for joint, frictions in THERE.items()
        for name, values in frictions.items()
    ]
    found = diagnosed(*hidden, *beside)
    assert {
        verdict.effect: verdict.actuators for verdict in found.ranking if verdict.effect in found.missing
    } == {
        "viscous_friction": ("left", "right"),
        "quadratic_drag": ("left",),
        "stribeck_friction": ("right",),
    }
    assert [law.place for law in found.discovered] == ["left"] * len(beside)


def test_a_friction_beside_a_law_has_the_shape_that_it_was_found_with_there() -> None:
    """In the shape of a model without the law it was Coulomb friction and quadratic drag, for sure."""
    stribeck = {"effect": "stribeck_friction", "joint": "left", "Fc": 0.05, "Fs": 0.02, "vs": 0.3}
    found = diagnosed(stribeck, {"effect": "viscous_friction", "joint": "left", "Fv": 0.03}, BRAKED_LEFT)
    assert set(found.missing) == {"stribeck_friction", "viscous_friction"}
    assert [law.place for law in found.discovered] == ["left"]


def of_catalogue(*names: str, joint: str = "left") -> list[Part]:
    return [Part(EffectInstance(CATALOGUE[name], joint, f"{name}:{joint}")) for name in names]


def law_of(*terms: Term) -> Law:
    effect, source = law_effect("law", terms, LEFT)
    return Law("law", terms, (LEFT,), (EffectInstance(effect, "left", "law:left"),), source)


def test_a_law_that_saves_no_unknown_stands_for_nothing() -> None:
    coulomb, viscous, shear = of_catalogue("coulomb_friction", "viscous_friction", "shear_thinning_friction")
    assert fewer([coulomb, viscous], 2, CATALOGUE) == []
    kept = fewer([coulomb, viscous, shear], 2, CATALOGUE)
    assert sorted(kept, key=len) == [[], [viscous], [coulomb]]


def test_a_special_case_of_what_was_found_may_stay_beside_a_law() -> None:
    """Coulomb friction beside a power of the velocity looks like the first three, with viscous friction like all."""
    found = of_catalogue("stribeck_friction", "shear_thinning_friction", "quadratic_drag", "joint_spring")
    kept = [sorted(part.name for part in some) for some in fewer(found, 2, CATALOGUE)]
    assert ["coulomb_friction"] in kept
    assert ["coulomb_friction", "viscous_friction"] in kept
    assert ["constant_offset", "coulomb_friction"] in kept


def test_an_exponent_that_was_chosen_is_an_unknown_like_one_that_was_adapted() -> None:
    chosen, adapted = (Term((Power(V, 1.5, free=free),)) for free in (False, True))
    parts = [parts_of(law_of(term).instances, [law_of(term)]) for term in (chosen, adapted)]
    assert [unknowns(some) for some in parts] == [2, 2]
    assert unknowns(of_catalogue("viscous_friction", "stribeck_friction")) == 5


def test_terms_of_a_law_count_as_functions_of_the_velocity_by_themselves() -> None:
    squared, by_load = Term((Power(V, 3.0),)), Term((Power(V), Power(LOAD, 1.0, odd=False)))
    lagged = Term((Memory(0.1, (Power(V),)),))
    law = law_of(squared, by_load, lagged)
    parts = parts_of((*law.instances, of_catalogue("coulomb_friction")[0].instance), [law])
    assert [part.of_velocity for part in parts] == [True, False, False, True]
    (alike,) = together(parts)
    assert [part.name for part in alike] == [parts[0].name, "coulomb_friction"]


def test_a_dissipative_effect_at_the_same_motor_may_only_compensate() -> None:
    group = of_catalogue("viscous_friction", "quadratic_drag")
    drift = of_catalogue("thermal_friction_drift")
    elsewhere = of_catalogue("thermal_friction_drift", joint="right")
    stored = of_catalogue("joint_spring")
    assert list(with_another([group], [*group, *drift, *elsewhere, *stored])) == [group, [*group, *drift]]


@pytest.mark.parametrize("exponent", [0.2, 0.3, 0.45, 0.6, 0.8, 1.3, 1.7, 2.2, 2.7])
def test_a_sum_of_few_powers_is_near_one_with_any_exponent(exponent: float) -> None:
    velocity = np.sin(np.linspace(0.0, 40.0, 4000)) * np.sin(np.linspace(0.0, 7.0, 4000))

    def odd(p: float) -> np.ndarray:
        return np.sign(velocity) * np.abs(velocity) ** p

    basis = np.column_stack([odd(p) for p in TOLERANCES.laws.summed_exponents])
    remainder = odd(exponent) - basis @ np.linalg.lstsq(basis, odd(exponent))[0]
    assert np.linalg.norm(remainder) < 2e-3 * np.linalg.norm(odd(exponent))


def test_motors_with_the_same_functions_are_looked_at_together_and_alone() -> None:
    left, right = (
        of_catalogue("coulomb_friction", "viscous_friction", joint=joint) for joint in ("left", "right")
    )
    assert together([*left, *right]) == [[*left, *right], left, right]
    assert together([*left, *right[:1]]) == [left]
    more = [*left, *of_catalogue("quadratic_drag")]
    assert together([*right, *more]) == [more, right]
