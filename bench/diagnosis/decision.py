"""What decides between models, in one place: every threshold of a diagnosis that is no numerical bound."""

from dataclasses import dataclass
from math import erfc, exp, sqrt


@dataclass(frozen=True)
class DecisionRule:
    """What decides which effects an answer has, and how sure it is of them.

    prior: nats against every effect, odds of 20,000 to 1: of some 30 effects in every subset, with shapes that are
    adapted to the data, few must pass by chance. coarsening: independent samples; where they are many, an error that
    falls by 3 % brings 10 nats, and no more than that repeats from one log of a machine to the next. undecided: nats by
    which another set may be less probable, where the data still do not tell them apart. inexact: share of the logarithm
    of error over noise; where a model leaves more than noise, its form is wrong, and an effect that takes less of that
    away, and a drive gain along, may only make up for it. shows: standard errors by which a parameter must
    differ from zero, or a gain move. beyond_noise: times the noise floor; an error below holds nothing to look for.
    dominant: times the residual, that must remain without an effect which is named though something has no name.
    cancels: times a motor's torque; a spring that balances 80 % of a weight has four times what the motor gives. most:
    share of a motor's squared error; what takes more away is looked for before all else. surprising: probability of so
    strong a pattern by chance.
    """

    prior: float = 10.0
    coarsening: float = 328.0
    undecided: float = 10.0
    inexact: float = 0.15
    shows: float = 3.0
    beyond_noise: float = 1.15
    dominant: float = 3.0
    cancels: float = 5.0
    most: float = 0.5
    surprising: float = 1e-4

    @property
    def material(self) -> float:
        """Share of an error that is worth an effect where samples are many."""
        return 1.0 - exp(-self.prior / self.coarsening)

    @property
    def by_chance(self) -> float:
        """Probability of a value that differs from zero by `shows` standard errors."""
        return erfc(self.shows / sqrt(2.0))

    def coarsening_beyond(self, excess: float) -> float:
        """Samples that count where the logarithm of error over noise is `excess`."""
        return self.prior / (self.prior / self.coarsening + self.inexact * excess)


RULE = DecisionRule()
