"""Is the answer the same in half of the band? The filters are checked by their effect on the estimates.

Coloured noise of positions, clock jitter and repeated rows hide in the motion's spectrum, and bias the observation
matrix in the whole band that was chosen from it. An estimate from half of the band has other errors; the difference of
the two shows the bias (Hausman, "Specification tests in econometrics", 1978).
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from math import hypot

import numpy as np

from bench.basics.chi_squared import exceeded_with
from bench.identification.decision import RULE
from bench.identification.estimators import DEFAULT_METHOD
from bench.identification.finding import Code, Finding, Unknown
from bench.identification.model_averaged import estimates, in_both, model_averaged
from bench.identification.prepare import Prepared, prepare, with_effects
from bench.identification.problem import Problem
from bench.identification.result import BandPoint, Identification
from bench.identification.tolerances import TOLERANCES
from bench.signals.bounds import BANDS
from bench.signals.settings import FilterSettings, settled_border

Fit = Callable[[Prepared], Identification]


def with_band_checked(prepared: Prepared, result: Identification, fitted: Fit) -> Identification:
    """The answer with standard errors that cover how far its values move in half of the band, beyond what noise
    explains; if wider filters were rejected, the whole distance, and that to the narrowest of these.

    fitted: fits the same model in another band. The answer contains the values in each band.
    """
    at_band = result if result.method == DEFAULT_METHOD else fitted(prepared)
    half = narrower(prepared)
    lower = None if half is None else fitted(half)
    wider = [fitted(_with_settings(prepared, settings)) for settings in prepared.rejected[-1:]]
    others = [*wider, *([] if lower is None else [lower])]
    rate = prepared.dataset.recordings[0].rate
    numbers = {"band": prepared.settings.band(rate), "decimation": float(prepared.settings.decimation)}
    if not others:
        unchecked = Finding(Code.BAND_UNCHECKED, numbers={"band": numbers["band"]})
        return replace(result, findings=(*result.findings, unchecked))
    points = tuple(
        sorted((_point(prepared, answer) for answer in (at_band, *others)), key=lambda point: -point.band)
    )
    apart = _apart(at_band, others, all_of_it=bool(prepared.rejected))
    answer = replace(model_averaged(result, apart, "bandwidth"), bandwidths=points)
    if prepared.rejected:
        numbers["rejected"] = prepared.rejected[0].band(rate)
        return replace(answer, findings=(*answer.findings, Finding(Code.BAND_NARROWED, numbers=numbers)))
    if lower is not None and (moved(at_band, lower) or sharper(at_band, lower)):
        return replace(answer, findings=(*answer.findings, Finding(Code.BAND_MATTERS, numbers=numbers)))
    return answer


def narrower(prepared: Prepared) -> Prepared | None:
    """The same model in half of the band; None if a recording or a motor then has too few samples."""
    settings = prepared.settings
    fitted = [recording for recording in prepared.dataset.recordings if recording.use == "identify"]
    shortest = min(len(recording.time) for recording in fitted)
    decimation = 2 * settings.decimation
    if shortest // decimation < BANDS.samples:
        return None
    cutoff = 0.5 * settings.position_cutoff
    border = settled_border(cutoff, fitted[0].rate, shortest)
    half = _with_settings(
        prepared, replace(settings, position_cutoff=cutoff, decimation=decimation, border=(border, border))
    )
    rows = np.sum([observation.moving.sum(axis=0) for observation in half.fitted], axis=0)
    unknowns = half.layout.size + int(half.gains.is_fitted.sum())
    if np.any((rows > 0) & (rows < TOLERANCES.statistics.block_rows)) or rows.sum() < 2 * unknowns:
        return None
    return half


def _with_settings(prepared: Prepared, settings: FilterSettings) -> Prepared:
    """The same model with other filters; shapes are kept, since a narrower band may not determine them."""
    plain = prepared.halved
    if plain is None or plain.settings != settings:
        plain = prepare(Problem(prepared.dataset, {}, (), settings, fit_gains=False))
    model = with_effects(replace(plain, scale=prepared.scale), prepared.effects, prepared.present)
    return replace(model, converged=True)


def moved(first: Identification, second: Identification) -> bool:
    """Whether all values together differ by more than their standard errors and chance explain."""
    squares = [(a.value - b.value) ** 2 / (a.std**2 + b.std**2) for a, b in in_both(first, second).values()]
    return bool(squares) and sum(squares) > exceeded_with(RULE.surprising, len(squares))


def sharper(first: Identification, second: Identification) -> bool:
    """Whether standard errors are clearly smaller in `second`, in the median: then the wider band adds noise."""
    ratios = [b.std / a.std for a, b in in_both(first, second).values()]
    return bool(ratios) and float(np.median(ratios)) < TOLERANCES.findings.half_band


def _apart(
    first: Identification, others: Sequence[Identification], *, all_of_it: bool
) -> Mapping[Unknown, float]:
    """Standard errors by unknown that cover the distance to other values, whole or beyond their errors."""
    spreads: dict[Unknown, float] = {}
    for there in others:
        for unknown, (a, b) in in_both(first, there).items():
            noise = 0.0 if all_of_it else a.std**2 + b.std**2
            beyond = max((a.value - b.value) ** 2 - noise, 0.0)
            spreads[unknown] = max(spreads.get(unknown, 0.0), hypot(a.std, beyond**0.5))
    return spreads


def _point(prepared: Prepared, answer: Identification) -> BandPoint:
    rate = prepared.dataset.recordings[0].rate
    return BandPoint(
        answer.settings.band(rate),
        answer.settings.position_cutoff,
        answer.error.identify,
        answer.error.validate,
        {unknown: (each.value, each.std) for unknown, each in estimates(answer).items() if each.std > 0.0},
    )
