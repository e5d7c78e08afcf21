"""Points of the grammar that have a name."""

from bench.diagnosis.discovery.factors import Decay, Power, Wave
from bench.diagnosis.discovery.grammar import LOAD, A, Q, V
from bench.diagnosis.discovery.term import Term

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
"""Effects of the catalogue that are terms of the grammar, or sums of them, whatever their numbers."""

_BY_STRUCTURE = {term.structure: name for name, terms in NAMED.items() for term in terms}


def name_of(term: Term) -> str | None:
    """The effect of the catalogue of which a term is a case; None where it has no name."""
    return _BY_STRUCTURE.get(term.structure)
