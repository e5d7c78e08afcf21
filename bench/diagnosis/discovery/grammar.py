"""The candidate laws: carriers times modulators, with memory, in a fixed order."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np

from bench.diagnosis.discovery.factors import Decay, Factor, Memory, Power, Step, Wave
from bench.diagnosis.discovery.term import Term
from bench.diagnosis.discovery.variables import Variable
from bench.identification.tolerances import TOLERANCES

V, A, Q, LOAD = (Variable(kind) for kind in ("velocity", "acceleration", "position", "load"))
T, TOOL, OTHERS = Variable("time"), Variable("tool_speed"), Variable("others_load")


@dataclass(frozen=True)
class Scope:
    """The inputs of laws, the same at all motors.

    others: number of other motors; several: whether their loads can be added; tool: whether there is one. duration s,
    of the longest recording. lowest, highest: positions, rad or m; rates: of waves over the position, rad per unit,
    each with its range if free, either way; pulses: of waves over time, rad/s. shortest s: between samples. of_time:
    whether a law may depend on time alone.
    """

    others: int
    several: bool
    tool: bool
    duration: float
    lowest: float
    highest: float
    rates: tuple[tuple[float, float], ...]
    pulses: tuple[float, ...]
    shortest: float
    of_time: bool


def grammar(scope: Scope) -> list[Term]:
    """Every candidate term, each once."""
    speed = [*_powers(V, TOLERANCES.laws.exponents, (1.0, 2.0)), Power(V, 0.0)]
    inertial = [*_powers(A, (1.0, 2.0), (0.5, 1.0, 1.5, 2.0)), Power(A, 0.0)]
    load = [*_powers(LOAD, (0.5, 1.0, 1.5, 2.0), (0.5, 1.0, 1.5, 2.0)), Power(LOAD, 0.0)]
    place = [Power(Q), Power(Q, 2.0, odd=False), Power(Q, 3.0), Power(Q, 1.0, odd=False)]
    waves = [Wave(Q, rate, reach) for rate, reach in scope.rates]
    steps = [*_steps(Q, scope.lowest, scope.highest)]
    clock: list[Factor] = []
    if scope.of_time:
        pulses = (Wave(T, pulse, np.pi / scope.duration, free=True) for pulse in scope.pulses)
        clock = [*_decays(scope), Power(T), *pulses]
        steps += _steps(T, 0.0, scope.duration)
    tool = [Power(TOOL, exponent, odd=False) for exponent in (1.0, 2.0)] if scope.tool else []
    together = [Power(OTHERS), Power(OTHERS, 1.0, odd=False)] if scope.several else []
    others = [factor for ahead in range(1, scope.others + 1) for factor in _of_another(ahead)]
    groups: list[list[Factor]] = [list(speed), list(inertial), list(load), [*place, *waves]]
    singles = [factor for group in groups for factor in group]
    partners: list[Factor] = [*clock, *steps, *tool, *together, *others]
    terms = [Term((factor,)) for factor in (*singles, *partners)]
    for i, group in enumerate(groups):
        terms += _products(group, [factor for later in groups[i + 1 :] for factor in later])
    carriers = [Power(V, 0.0), Power(V), Power(A), Power(LOAD), Power(V, 1.0, odd=False)]
    carriers += [Power(V, 2.0), Power(A, 1.0, odd=False), Power(LOAD, 1.0, odd=False), Power(Q)]
    terms += _products(carriers, partners)
    terms += _remembered(scope)
    terms += _triples([*waves[:3], Power(Q, 1.0, odd=False), Power(Q, 2.0, odd=False), Power(Q)])
    return list(
        {term: None for term in terms if sum(isinstance(factor, Wave) for factor in term.factors) < 2}
    )


def _powers(x: Variable, odd: Iterable[float], even: Iterable[float]) -> list[Power]:
    return [*(Power(x, value) for value in odd), *(Power(x, value, odd=False) for value in even)]


def _products(first: Sequence[Factor], second: Sequence[Factor]) -> list[Term]:
    return [Term((factor, other)) for factor, other in product(first, second)]


def _decays(scope: Scope) -> list[Factor]:
    return [Decay(share * scope.duration) for share in TOLERANCES.laws.decays]


def _steps(x: Variable, low: float, high: float) -> list[Factor]:
    return [Step(x, low + part * (high - low), 0.15 * (high - low)) for part in TOLERANCES.laws.onsets]


def _of_another(ahead: int) -> list[Factor]:
    """Factors of the motor `ahead` places further."""
    q, v, a, load = (Variable(variable.kind, ahead) for variable in (Q, V, A, LOAD))
    powers = [Power(v, 0.0), Power(v), Power(v, 2.0), *(Power(x, 1.0, odd=False) for x in (v, a, load))]
    return [
        *powers,
        Power(v, 2.0, odd=False),
        Power(a),
        Power(load),
        Power(q),
        *(Wave(q, h, 0.5) for h in (1.0, 2.0)),
    ]


def _remembered(scope: Scope) -> list[Term]:
    """Memories by themselves, and friction that follows them."""
    signed: list[tuple[Power, ...]] = [
        (Power(V, 0.0),),
        (Power(V),),
        (Power(V, 2.0),),
        (Power(A),),
        (Power(LOAD),),
        (Power(Q),),
    ]
    signed += [(Power(V), Power(Q, 2.0, odd=False))]
    sized: list[tuple[Power, ...]] = [
        (Power(V, 1.0, odd=False),),
        (Power(V, 2.0, odd=False),),
        (Power(A, 1.0, odd=False),),
    ]
    sized += [(Power(LOAD, 1.0, odd=False),), (Power(LOAD, 2.0, odd=False),)]
    sized += [(Power(V, 1.0, odd=False), Power(LOAD, 1.0, odd=False))]
    known = [value for value in TOLERANCES.laws.durations if 2.0 * scope.shortest < value < scope.duration]
    terms = [Term((Memory(duration, pair),)) for pair in signed for duration in known]
    carriers = (Power(V, 0.0), Power(V), Power(LOAD))
    slow = [value for value in (*known, 0.5 * scope.duration) if value >= 0.1]
    return terms + [
        Term((carrier, Memory(duration, pair))) for carrier in carriers for pair in sized for duration in slow
    ]


def _triples(places: Sequence[Factor]) -> list[Term]:
    """Products of three variables of the motor itself."""
    sizes = [Power(A, 1.0, odd=False), Power(LOAD, 1.0, odd=False)]
    friction = [Power(V, 0.0), Power(V), Power(V, 2.0)]
    terms = [Term((power, *sizes)) for power in friction]
    terms += [Term((power, size, place)) for power in friction for size in sizes for place in places]
    terms += [Term((Power(V, 1.0, odd=False), Power(LOAD), place)) for place in places]
    return terms + [Term((Power(V, 1.0, odd=False), Power(A), place)) for place in places]


CONSTANT, SIGN, SPEED = Term(()), Term((Power(V, 0.0),)), Term((Power(V),))
BASICS = (SIGN, SPEED)
_WAVE, _DECAY = Wave(Q, 1.0, 0.0), Decay(1.0)

NAMED: dict[str, tuple[Term, ...]] = {
    "asymmetric_viscous_friction": (Term((Power(V, 1.0, odd=False),)),),
    "cogging_torque": (Term((_WAVE,)),),
    "constant_offset": (CONSTANT,),
    "coulomb_friction": (SIGN,),
    "gain_saturation": (Term((Power(LOAD, 3.0),)),),
    "joint_spring": (Term((Power(Q),)),),
    "load_dependent_friction": (Term((Power(V, 0.0), Power(LOAD, 1.0, odd=False))),),
    "position_dependent_friction": (Term((Power(V, 0.0), _WAVE)),),
    "quadratic_drag": (Term((Power(V, 2.0),)),),
    "rotor_inertia": (Term((Power(A),)),),
    "thermal_friction_drift": (Term((Power(V, 0.0), _DECAY)), Term((Power(V), _DECAY))),
    "torque_ripple": (Term((Power(LOAD), _WAVE)),),
    "viscous_friction": (SPEED,),
}
"""Effects of the catalogue that are terms of the grammar, or sums of them, for any constants."""

_BY_STRUCTURE = {term.structure: name for name, terms in NAMED.items() for term in terms}


def name_of(term: Term) -> str | None:
    """The effect of the catalogue of which a term is a case; None if it has no name."""
    return _BY_STRUCTURE.get(term.structure)
