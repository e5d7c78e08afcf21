"""What only the final answer of a diagnosis has: places, logs omitted, half of the band."""

from dataclasses import replace

from bench.diagnosis.places import alike_places, place_shares
from bench.diagnosis.result import Diagnosis
from bench.diagnosis.search_result import SearchResult
from bench.diagnosis.without_log import without_logs
from bench.identification.bandwidth import with_band_checked
from bench.identification.identify import fit
from bench.identification.model_averaged import gains_model_averaged


def completed(finding: SearchResult, diagnosis: Diagnosis) -> Diagnosis:
    """The final answer with the probability of every place of its effects, the places that the data cannot distinguish,
    the answer with each log omitted, and standard errors that cover the gains with an effect at another such place, and
    the answer in half of the band.
    """
    last, model = finding.last, finding.model
    alike = alike_places(model, finding.new, last.system.samples)
    shares = place_shares(last.system, last.chosen, finding.new, alike.places)
    ranking = tuple(
        replace(verdict, alike=alike.places.get(verdict.effect, {}), places=shares.get(verdict.effect, {}))
        for verdict in diagnosis.ranking
    )
    after = gains_model_averaged(diagnosis.after, alike.answers)
    return replace(
        diagnosis,
        ranking=ranking,
        after=with_band_checked(model, after, fit),
        without_logs=without_logs(model, last.system, last.selection, last.proposals),
    )
