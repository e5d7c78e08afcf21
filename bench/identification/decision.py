"""Every threshold that decides in identification and diagnosis, numerical bounds aside.

Numerical bounds are in `bench.identification.tolerances`.
"""

from dataclasses import dataclass
from math import erf, erfc, exp, log, sqrt

from bench.basics.in_force import InForce


@dataclass(frozen=True)
class DecisionRule:
    """The thresholds that decide which effects an answer has, and how certain they are.

    Evidence. prior: nats against every effect, odds of 20,000 to 1: of some 30 effects in every subset, with shapes
    adapted to the data, few must pass by chance. coarsening: independent samples; in a long log, an error that falls by
    3 % brings 10 nats, and smaller changes do not repeat from one log of a machine to the next. undecided: nats; sets
    that differ by less are not distinguished by the data. even: probability; a less probable effect of the answer only
    resembles what is missing. surprising: probability of so strong a pattern by chance.

    Standard errors. shows: by which a parameter must differ from zero, or a gain move. certain: by which two values
    must differ for no inexact model to explain it. loose: relative standard error, above which a value says little.

    Noise. beyond_noise: times the noise floor; a smaller error needs no explanation. much: times the noise; with a
    larger error something unknown acts, and a known effect may only resemble it. inexact: share of log(error / noise);
    a model with more error than noise has a wrong form, and an effect that removes less than this share may only
    compensate for it. law_beyond_noise: times the noise; with a larger error a law has a wrong form, and effects at its
    motors are uncertain. law_share: of the error that a law explains; its form may be wrong by as much, so an effect at
    its motor that explains less is uncertain.

    Shares of an error. most: of a motor's squared error; whatever removes more is searched first. helps: of an error; a
    model of another kind (values by recording, an effect in place of a law) must remove this much, since less may be
    another effect. dominant: times the residual; without an effect that is named while something remains unnamed, the
    error must be this large. dominant_in_much: the same if `much` remains. cancels: times a motor's torque; a spring
    that balances 80 % of a weight has four times the motor's; for an effect whose torque the motor must supply, such as
    friction, `much` is the bound.

    Drive gains. gain_far: factor to the nominal gain, up or down; a gain beyond is not credible, since makers err by a
    tenth. gain_lost: the same; beyond it a model does not determine the gain, and a fit restarts from the nominal one.
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
        """Share of the error that an effect must remove in a long log."""
        return 1.0 - exp(-self.prior / self.coarsening)

    @property
    def sure(self) -> float:
        """Probability from which an effect is missing, that of a value within two standard errors; undecided down to
        the complement.
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
        """The coarsening at log(error / noise) = `excess`."""
        return self.prior / (self.prior / self.coarsening + self.inexact * excess)


_FORCE = InForce(DecisionRule())
RULE = _FORCE.read
"""The rule in force: the default, or what `deciding_by` was given."""
rule_in_force = _FORCE.value
deciding_by = _FORCE.during
