"""Does an error remain that no known effect explains, and what does it vary with?"""

from collections.abc import Callable, Sequence

import numpy as np

from bench.basics.chi_squared import exceeded_with
from bench.dataset.recording import Recording
from bench.diagnosis.noise import not_repeated
from bench.diagnosis.result import Remainder, Unexplained, excess_of
from bench.identification.current_noise import current_noise, relative_noise_in_band
from bench.identification.decision import RULE
from bench.identification.result import CurrentSeries, Identification, relative_error
from bench.identification.tolerances import TOLERANCES
from bench.signals.settings import FilterSettings

SEED = 20120606


def relative_noise_floor(
    recordings: Sequence[Recording], series: Sequence[CurrentSeries], settings: FilterSettings
) -> float:
    """RMS of the current noise after the fit's filters over that of the currents, all series together.

    The noise is read off the spectra above the band of the motion and taken as white.
    """
    by_name = {recording.name: recording for recording in recordings}
    noise = measured = 0.0
    for trace in series:
        recording = by_name[trace.name]
        variance = current_noise(recording, settings, trace.sharing) ** 2
        noise += float((variance * trace.moving.sum(axis=0)).sum())
        measured += float(((trace.measured * trace.moving) ** 2).sum())
    return float(np.sqrt(noise / measured)) if measured else 0.0


def excess(result: Identification, recordings: Sequence[Recording], encoders: Callable[[], float]) -> float:
    """Logarithm, at least zero, of the error on held-out recordings over noise or the non-repeating part of the error.
    encoders: see `unexplained`.
    """
    _, error, floor = _judged(result, recordings)
    if error <= RULE.beyond_noise * floor:
        return 0.0
    return excess_of(error, floor, encoders(), not_repeated(result.recordings))


def unexplained(
    result: Identification, recordings: Sequence[Recording], encoders: Callable[[], float] = lambda: 0.0
) -> Unexplained:
    """Test the errors of the final model on held-out recordings for any dependence.

    encoders: relative error by encoder noise alone; called only if current noise does not explain the error.
    """
    held_out, error, floor = _judged(result, recordings)
    if error <= RULE.beyond_noise * floor:
        return Unexplained(Remainder.NOISE, error, floor, ())
    from_encoders = encoders()
    if error <= RULE.beyond_noise * np.hypot(floor, from_encoders):
        return Unexplained(Remainder.NOISE_AND_ENCODERS, error, floor, (), from_encoders)
    ratios: dict[str, float] = {}
    random = np.random.default_rng(SEED)
    joints = list(result.joints)
    for j in range(len(joints)):
        errors = np.concatenate([trace.error[:, j][trace.moving[:, j]] for trace in held_out])
        if not len(errors):
            continue  # the error of a motor that never moves cannot vary
        scale = errors.std() or 1.0
        if _in_impacts(errors):
            ratios["time"] = max(ratios.get("time", 0.0), TOLERANCES.statistics.follows)
        for name, values in _variables(held_out, j).items():
            ratio = _dependence(errors / scale, values, random)
            ratios[name] = max(ratios.get(name, 0.0), ratio)
    if _lasting(held_out):
        ratios["time"] = max(ratios.get("time", 0.0), TOLERANCES.statistics.follows)
    depends = tuple(name for name, ratio in sorted(ratios.items(), key=lambda pair: -pair[1]) if ratio >= 1.0)
    what = Remainder.PATTERN if depends else Remainder.NO_PATTERN
    return Unexplained(what, error, floor, depends, from_encoders, not_repeated(result.recordings))


def _judged(
    result: Identification, recordings: Sequence[Recording]
) -> tuple[list[CurrentSeries], float, float]:
    """The held-out series, or all if there are none; their relative error; and its noise floor.

    If the error is far below the noise above the band of the fit, the noise in the band is read off the error in the
    upper half of the band.
    """
    held_out = [trace for trace in result.recordings if trace.use == "validate"] or list(result.recordings)
    error = relative_error(held_out) or 0.0
    floor = relative_noise_floor(recordings, held_out, result.settings)
    if error**2 < TOLERANCES.statistics.white * floor**2:
        floor = min(relative_noise_in_band(held_out, result.settings), error)
    return held_out, error, floor


def _variables(series: Sequence[CurrentSeries], j: int) -> dict[str, np.ndarray]:
    """What a motor's error may vary with, one value per row."""

    def stacked(name: str) -> np.ndarray:
        return np.concatenate([getattr(trace, name)[:, j][trace.moving[:, j]] for trace in series])

    variables = {
        "position": stacked("position"),
        "velocity": stacked("velocity"),
        "acceleration": stacked("acceleration"),
        "current": stacked("measured"),
        "time": np.concatenate([(trace.time - trace.time[0])[trace.moving[:, j]] for trace in series]),
    }
    loads = np.concatenate(
        [np.full(int(trace.moving[:, j].sum()), float(trace.payload is not None)) for trace in series]
    )
    if np.ptp(loads) > 0:
        variables["payload"] = loads
    return variables


def _dependence(errors: np.ndarray, values: np.ndarray, random: np.random.Generator) -> float:
    """Variation between bins relative to chance: above one, less probable than RULE.surprising.

    Chance comes from blocks of the same errors with random signs, which keep their autocorrelation.
    """
    edges = np.unique(np.quantile(values, np.linspace(0, 1, TOLERANCES.statistics.bins + 1)))
    if len(edges) < 2:
        return 0.0
    index = np.clip(np.searchsorted(edges, values, side="right") - 1, 0, len(edges) - 2)
    count = np.maximum(np.bincount(index, minlength=len(edges) - 1), 1)

    def between(errors: np.ndarray) -> float:
        sums = np.bincount(index, weights=errors, minlength=len(edges) - 1)
        return float((sums**2 / count).sum())

    rows = TOLERANCES.statistics.shuffled_rows
    blocks = len(errors) // rows
    if blocks < 4:
        return 0.0
    trimmed = errors[: blocks * rows].reshape(blocks, rows)
    rest = errors[blocks * rows :]
    chance = np.array(
        [
            between(
                np.concatenate(((trimmed * random.choice((-1.0, 1.0), size=(blocks, 1))).reshape(-1), rest))
            )
            for _ in range(TOLERANCES.statistics.shuffles)
        ]
    )
    # the sum of squares of bin means is close to a scaled chi-squared; its moments give the tail
    mean, variance = chance.mean(), chance.var()
    freedom = 2.0 * mean**2 / max(variance, 1e-300)
    limit = mean / freedom * exceeded_with(RULE.surprising, freedom)
    return between(errors) / limit


def _in_impacts(errors: np.ndarray) -> bool:
    """Whether few short stretches have most of the squared error, as when play is crossed."""
    rows = TOLERANCES.statistics.shuffled_rows
    blocks = len(errors) // rows
    energy = np.sort((errors[: blocks * rows].reshape(blocks, rows) ** 2).sum(axis=1))
    few = round(TOLERANCES.statistics.impacts * blocks)
    return few > 0 and float(energy[-few:].sum()) > RULE.most * float(energy.sum())


def _lasting(series: Sequence[CurrentSeries]) -> bool:
    """Whether errors correlate for longer than white noise after the fit's low-pass.

    The sum of squared correlations at lags beyond its reach is compared with its chi-squared law (Box and
    Pierce 1970), over all recordings and motors.
    """
    squares = count = 0.0
    first = TOLERANCES.statistics.low_pass_lags
    for trace in series:
        errors = trace.error * trace.moving
        scale = (errors**2).sum(axis=0)
        for lag in range(first, first + TOLERANCES.statistics.pattern_lags):
            if lag >= len(errors) // 2:
                break
            correlation = (errors[lag:] * errors[:-lag]).sum(axis=0) / np.where(scale > 0, scale, 1.0)
            squares += float((correlation**2 * trace.moving.sum(axis=0)).sum())
            count += correlation.size
    return count > 0 and squares > exceeded_with(RULE.surprising, count)
