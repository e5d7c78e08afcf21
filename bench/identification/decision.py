"""What decides in identification and diagnosis, in one place: every threshold of an answer that is no numerical bound.

Numerical bounds are in `bench.identification.tolerances`.
"""

from dataclasses import dataclass
from math import erf, erfc, exp, log, sqrt

from bench.basics.in_force import InForce


@dataclass(frozen=True)
class DecisionRule:
    """What decides which effects an answer has, and how sure it is of them.

    Evidence. prior: nats against every effect, odds of 20,000 to 1: of some 30 effects in every subset, with shapes
    that are adapted to the data, few must pass by chance. coarsening: independent samples; where they are many, an
    error that falls by 3 % brings 10 nats, and no more than that repeats from one log of a machine to the next.
    undecided: nats by which another set may be less probable, where the data do not distinguish the two. even:
    probability; an effect of the answer that is less probable only resembles what is missing. surprising: probability
    of so strong a pattern by chance.

    Standard errors. shows: by which a parameter must differ from zero, or a gain move. certain: by which two values
    must differ so that no inexact model explains it. loose: relative standard error, above which a value says little.

    Noise. beyond_noise: times the noise floor; an error below holds nothing to look for. much: times what noise leaves;
    with more, something unknown acts, and a known effect may only resemble it. inexact: share of the logarithm of error
    over noise; where a model leaves more than noise, its form is wrong, and an effect that takes less of that away, and
    a drive gain along, may only make up for it. law_beyond_noise: times what noise leaves; with more, a law has not the
    right form, and effects at its motors are unsure. law_share: share of the error that a law explains; its form may
    be wrong by as much, so that an effect at its motor that explains less is unsure.

    Shares of an error. most: of a motor's squared error; what takes more away is looked for before all else. helps: of
    an error, that a model of another kind must take away, with values by recording or an effect in place of a law: less
    may be another effect. dominant: times the residual, that must remain without an effect which is named though
    something has no name. dominant_in_much: the same where `much` remains. cancels: times a motor's torque; a spring
    that balances 80 % of a weight has four times what the motor gives; of an effect whose torque the motor has to give,
    such as friction, `much` is too much.

    Drive gains. gain_far: factor to the nominal gain, up or down; a gain beyond is not credible, since makers are
    wrong by a tenth. gain_lost: the same, beyond which a model says nothing of the gain, and a fit starts again from
    the nominal one.
    """

    prior: float = 10.0
    coarsening: float = 328.0
    undecided: float = 10.0
    even: float = 0.5
    surprising: float = 1e-4
    shows: float = 3.0
    certain: float = 5.0
    loose: float = 0.3
    beyond_noise: float = 1.15
    much: float = 2.0
    inexact: float = 0.15
    law_beyond_noise: float = 1.5
    law_share: float = 0.1
    most: float = 0.5
    helps: float = 0.1
    dominant: float = 3.0
    dominant_in_much: float = 10.0
    cancels: float = 5.0
    gain_far: float = 2.0
    gain_lost: float = 5.0

    @property
    def material(self) -> float:
        """Share of an error that is worth an effect where samples are many."""
        return 1.0 - exp(-self.prior / self.coarsening)

    @property
    def sure(self) -> float:
        """Probability from which an effect is missing, as that of a value within two standard errors; between the rest
        and this it is undecided.
        """
        return erf(sqrt(2.0))

    @property
    def sure_odds(self) -> float:
        """The same as log odds, nats."""
        return log(self.sure / (1.0 - self.sure))

    @property
    def by_chance(self) -> float:
        """Probability of a value that differs from zero by `shows` standard errors."""
        return erfc(self.shows / sqrt(2.0))

    def coarsening_beyond(self, excess: float) -> float:
        """Samples that count where the logarithm of error over noise is `excess`."""
        return self.prior / (self.prior / self.coarsening + self.inexact * excess)


_FORCE = InForce(DecisionRule())
RULE = _FORCE.read
"""The rule in force: the default, or what `deciding_by` was given."""
rule_in_force = _FORCE.value
deciding_by = _FORCE.during
