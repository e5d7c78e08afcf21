"""Numbers, units and names as text, for tables, figures and Rerun documents."""

import math
import re
from collections.abc import Mapping

import numpy as np

from bench.identification.decision import RULE
from bench.identification.result import CurrentSeries, DriveGain, Identification, Quantity
from bench.identification.standard_errors import StdFrom

GIVEN = "given"
ABSORBED = "absorbed"  # by other parameters: no separate value
UNDETERMINED = "not determined"  # a value with too large a standard error
USES = {"identify": "fitted", "validate": "not fitted"}

STD_FROM: dict[StdFrom, str] = {
    "noise": "the error as noise",
    "blocks": "differences between parts of the logs, positions or velocities: model errors exceed noise",
    "periods": "errors that return with the motion: model errors exceed noise, however often the motion is repeated",
    "models": "how the estimate differs between models that explain the data as well",
    "instruments": "how the estimate differs from that of instrumental variables: the filters let noise through",
    "bandwidth": "how the estimate differs from that in another band of frequencies",
    "payload": "how the estimate differs from that with the payload as a point, which real bodies allow",
}

Truth = Mapping[str, float]
"""True values by joint (drive gains), by parameter name, and as EFFECT:JOINT.PARAMETER (effects)."""

SUPERSCRIPT = str.maketrans("0123456789-", "⁰¹²³⁴⁵⁶⁷⁸⁹⁻")


def pretty_unit(unit: str) -> str:
    """A unit as it is printed: "N*m/A" -> "N·m/A", "kg*m^2" -> "kg·m²"."""
    raised = re.sub(r"\^(-?\d+)", lambda power: power.group(1).translate(SUPERSCRIPT), unit)
    return raised.replace("*", "·")


def value_and_std(value: float, std: float) -> tuple[str, str]:
    """A value to the digits that its standard deviation supports, and the deviation to two digits, or "given"."""
    if not (math.isfinite(value) and math.isfinite(std)):
        return f"{value:.5g}", f"{std:.2g}"
    if std == 0.0:
        return f"{value:.6g}", GIVEN
    large = max(abs(value), std) >= 1e6
    leading = 0 if large else math.floor(math.log10(float(f"{std:.1e}")))
    decimals = 1 - leading
    if leading < -6 or large:
        return f"{value:.4e}", f"{std:.1e}"
    return f"{value:z.{max(decimals, 0)}f}", f"{std:.{max(decimals, 0)}f}"


def percent(share: float | None, *, signed: bool = False) -> str:
    """A share as a percentage of about three digits; "–" for None or NaN."""
    if share is None or math.isnan(share):
        return "–"
    value = 100.0 * share
    size = abs(value)
    if size >= 1000.0:
        return f"{'<-' if value < 0 else '>'}1000 %"
    digits = sum(size < bound for bound in (99.95, 99.5, 0.9995))
    text = f"{size:.{digits}f}" if size >= 0.00095 or size == 0.0 else f"{size:.1e}"
    return f"{'-' if value < 0 else '+' if signed else ''}{text} %"


def quantity_text(quantity: Quantity) -> str:
    """A value with its standard deviation or "given"; or only "not determined" or "absorbed"."""
    pair = quantity_parts(quantity)
    if pair is None:
        return ABSORBED if math.isinf(quantity.std) else UNDETERMINED
    return " ".join(pair) if pair[1] == GIVEN else " ± ".join(pair)


def quantity_parts(quantity: Quantity) -> tuple[str, str] | None:
    """A value, and its standard deviation or "given"; None if the value is not determined."""
    return value_and_std(quantity.value, quantity.std) if quantity.determined else None


def change_between(before: float, after: float) -> str:
    """The change of a value in percent, or the difference itself if the sign changes or a value is zero."""
    if before * after > 0.0:
        return percent((after - before) / abs(before), signed=True)
    return f"{after - before:+.3g}"


def deviations_away(quantity: Quantity, truth: float) -> float | None:
    """Deviation of a value from the truth, in standard deviations; None for a value that was given."""
    return (quantity.value - truth) / quantity.std if quantity.std else None


def off_by(quantity: Quantity, truth: float) -> float | None:
    """Deviation of a value from the truth, as a share of the truth's size; None if that is zero."""
    return (quantity.value - truth) / abs(truth) if truth else None


def gain_change(gain: DriveGain) -> float:
    """Change of a drive gain from its nominal value, as a share of the latter."""
    return gain.value / gain.nominal - 1.0


def is_poor(quantity: Quantity) -> bool:
    """Whether the standard deviation is too large a share of the value, above `RULE.loose`."""
    return quantity.relative_std > RULE.loose


def other_terms(name: str, grouping: str) -> list[str]:
    """The other standard parameters in the grouping of a base parameter, each with sign and factor."""
    terms = re.split(r" (?=[+-] )", grouping)
    return terms[1:] if terms[0] == name else terms


def rounded_terms(terms: list[str]) -> list[str]:
    """The terms with their factors rounded to three digits."""
    return [
        re.sub(r"^([+-] )?(\d\S*) ", lambda m: f"{m.group(1) or ''}{float(m.group(2)):.3g} ", term)
        for term in terms
    ]


def flat_effects(result: Identification) -> list[tuple[str, str, str, Quantity]]:
    """(effect, joint, parameter, quantity) for every effect parameter, in the model's order."""
    return [
        (effect, joint, name, quantity)
        for effect, joints in result.effect_parameters.items()
        for joint, values in joints.items()
        for name, quantity in values.items()
    ]


def effect_key(effect: str, joint: str, parameter: str) -> str:
    """The key of an effect parameter in `Truth`: EFFECT:PLACE.NAME."""
    return f"{effect}:{joint}.{parameter}"


def fit_rate(result: Identification) -> float | None:
    """Rows per second after decimation [Hz]; None without a recording of at least two rows."""
    for series in result.recordings:
        if len(series.time) > 1:
            return float((len(series.time) - 1) / (series.time[-1] - series.time[0]))
    return None


def error_where_moving(series: CurrentSeries) -> np.ndarray:
    """Measured minus modelled current (M, n); NaN where a joint does not move, as the model does not apply there."""
    return np.where(series.moving, series.error, np.nan)


def error_std(result: Identification) -> np.ndarray:
    """RMS error on the fitted recordings where a joint moves, (n,), in drive units; on all if none was fitted."""
    fitted = [error_where_moving(trace) for trace in result.recordings if trace.use == "identify"]
    errors = np.concatenate(fitted or [error_where_moving(trace) for trace in result.recordings])
    count = np.maximum(np.isfinite(errors).sum(axis=0), 1)
    return np.asarray(np.sqrt(np.nansum(errors**2, axis=0) / count))


def settings_lines(result: Identification) -> list[str]:
    """Source of the standard errors unless it is noise, rank, excluded rows, conditioning and filters, as lines."""
    moving = [trace.moving for trace in result.recordings if trace.use == "identify"]
    rows, all_rows = (sum(int(count(values)) for values in moving) for count in (np.sum, np.size))
    rate = fit_rate(result)
    filters = f"positions low-passed at {result.settings.position_cutoff:.4g} Hz"
    if rate is not None:
        filters += f", fit at {rate:.4g} Hz (one sample in {result.settings.decimation})"
    still = f"{all_rows - rows} more equations excluded because a joint stands still"
    equations = f"{rows} equations, " if result.recordings else ""  # a saved model has no rows to count
    spread = [] if result.std_from == "noise" else [f"± from {STD_FROM[result.std_from]}"]
    return [
        *spread,
        f"{equations}{result.unknowns} unknowns, rank {result.rank}",
        *([still] if rows < all_rows else []),
        f"condition number {result.condition:.4g}, with columns of unit length {result.scaled_condition:.4g}",
        filters,
    ]
