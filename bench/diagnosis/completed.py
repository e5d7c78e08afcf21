"""What only the final answer of a diagnosis has: places, logs omitted, half of the band."""

from dataclasses import replace

from bench.diagnosis.places import alike_places, place_shares
from bench.diagnosis.result import Diagnosis
from bench.diagnosis.search_result import SearchResult
from bench.diagnosis.without_log import without_logs
from bench.identification.bandwidth import with_band_checked
from bench.identification.identify import fit


def completed(finding: SearchResult, diagnosis: Diagnosis) -> Diagnosis:
    """The final answer with the probability of every place of its effects, the places that the data cannot distinguish,
    the answer with each log omitted, and standard errors that cover the answer in half of the band.
    """
    last, model = finding.last, finding.model
    alike = alike_places(model, finding.new, last.system.samples)
    shares = place_shares(last.system, last.chosen, finding.new, alike)
    ranking = tuple(
        replace(verdict, alike=alike.get(verdict.effect, {}), places=shares.get(verdict.effect, {}))
        for verdict in diagnosis.ranking
    )
    return replace(
        diagnosis,
        ranking=ranking,
        after=with_band_checked(model, diagnosis.after, fit),
        without_logs=without_logs(model, last.system, last.selection, last.proposals),
    )
