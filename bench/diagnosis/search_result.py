"""The result of a search for missing effects."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import partial

from bench.diagnosis.base_model import BaseModel, added_effects
from bench.diagnosis.candidates import Proposal
from bench.diagnosis.differs import differing
from bench.diagnosis.encoder_noise import encoder_error
from bench.diagnosis.evidence import Samples, answer_squares
from bench.diagnosis.ladder import Fits
from bench.diagnosis.reason import Reason
from bench.diagnosis.result import Differing, LadderStep, Superfluous, Unexplained, Unfinished
from bench.diagnosis.round import Round
from bench.diagnosis.split_problem import SplitProblem
from bench.diagnosis.unexplained import excess, unexplained
from bench.diagnosis.values_by_log import with_common_values
from bench.effects import EffectInstance
from bench.identification.chosen_band import usual_friction
from bench.identification.prepare import Prepared
from bench.identification.result import Identification


@dataclass(frozen=True)
class SearchResult:
    """The result of a search. new: beyond what the starting model has; names: of their effects; fits: see `fits_of`;
    barred: effects that may not be selected, and why. differs: effects that differ from run to run, and differently:
    the answer with a value of them for each; compared: whether both are known. unfinished: parts that the deadline cut.
    usual: names that are included only since the model is worse than usual friction without them.
    """

    base_model: BaseModel
    last: Round
    model: Prepared
    after: Identification
    new: tuple[EffectInstance, ...]
    names: tuple[str, ...]
    fits: Fits
    ladder: tuple[LadderStep, ...]
    superfluous: tuple[Superfluous, ...]
    barred: Mapping[str, Reason]
    compared: bool = False
    differs: tuple[Differing, ...] = ()
    differently: Identification | None = None
    unfinished: tuple[Unfinished, ...] = ()
    usual: tuple[str, ...] = ()

    def weight_by(self, samples: Samples) -> float:
        """Log weight of the identified model, with the priors of its laws: see `Samples.log_posterior`."""
        effects = self.model.effects
        return answer_squares(effects, self.after.recordings, self.last.prior_of(effects)).weight(samples)

    def compared_by_log(self, case: SplitProblem) -> "SearchResult":
        """With effects whose values differ by recording, identified or not, and the answer with these.

        Where more than noise is left, with the usual friction: without it, other values explain too little to be seen.
        """
        model = self.model
        if self.last.system.excess:
            friction = [
                each for each in self.last.proposals if each.name in usual_friction(case.problem.catalogue)
            ]
            model = self.base_model.with_instances(
                [
                    *added_effects(self.base_model, model),
                    *(each for proposal in friction if self._lacks(proposal) for each in proposal.instances),
                ]
            )
        model = with_common_values(model, case.start.effects)
        differs, differently = differing(model, case.problem.catalogue)
        return replace(self, compared=True, differs=differs, differently=differently)

    def _lacks(self, proposal: Proposal) -> bool:
        """Whether data can show an effect and the model has it nowhere."""
        return not proposal.absorbed and proposal.name not in {each.name for each in self.model.effects}

    def unexplained_by(self, case: SplitProblem, after: Identification) -> Unexplained:
        """The unexplained error in an answer of the model."""
        return unexplained(after, case.problem.dataset.recordings, partial(encoder_error, self.model))

    def excess(self, case: SplitProblem) -> float:
        """Excess of the identified model: see `unexplained.excess`."""
        recordings = case.problem.dataset.recordings
        return excess(self.after, recordings, partial(encoder_error, self.model))

    def odds_over(self, other: "SearchResult", excess: float) -> float:
        """Log odds of the identified model over that of another search; excess: log(error / noise) of this model."""
        samples = self.last.system.samples.beyond(excess)
        return self.weight_by(samples) - other.weight_by(samples)
