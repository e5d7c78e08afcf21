"""The metrics of a sweep: what each measures, how it is reported and computed; titles of metrics and axes."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np

from bench.effects.display_names import spoken
from bench.studies.sweep.identified_run import IdentifiedRun

Of = Literal["", "joint", "joint or all", "use"]
"""The part of the name after the dot: none or any, a joint, a joint or none, identify or validate."""

USES: Mapping[str, str] = {"identify": "fitted", "validate": "not fitted"}


@dataclass(frozen=True)
class Metric:
    """A metric. measures: in words; title: for people.

    unit: SI, empty for a dimensionless number; relative: reported in percent; share: of successes, whose mean is a
    coverage. of: see `Of`. group: the group of `record` that it belongs to, empty if it is always recorded. value:
    computes it from a run; values: computes those with a name after the dot. Both are None if `accuracy` computes it.
    """

    measures: str
    title: str = ""
    unit: str = ""
    relative: bool = False
    share: bool = False
    of: Of = ""
    group: str = ""
    value: Callable[[IdentifiedRun], float] | None = None
    values: Callable[[IdentifiedRun], Mapping[str, float]] | None = None


METRICS: Mapping[str, Metric] = {
    "gain_error": Metric(
        "largest relative deviation of an estimated drive gain from the true one",
        "largest gain error",
        relative=True,
        of="joint or all",
    ),
    "gain_std": Metric(
        "standard deviation of a drive gain as estimated, relative",
        "stated standard error of a gain",
        relative=True,
        of="joint",
    ),
    "gain_within": Metric(
        "share of the drive gains whose 95 % interval holds the truth",
        "gains inside their 95 % intervals",
        relative=True,
        share=True,
        of="joint or all",
        value=lambda run: float(run.by_gain("gain_within").mean()),
    ),
    "gain_rms": Metric(
        "root mean square of the relative deviations of all drive gains",
        title="RMS gain error",
        relative=True,
        value=lambda run: float(np.sqrt(np.mean(run.by_gain("gain_error") ** 2))),
    ),
    "error": Metric(
        "relative error of the current",
        "error of the current",
        relative=True,
        of="use",
    ),
    "noise_floor": Metric(
        "what a perfect model would leave of the current",
        "noise floor",
        relative=True,
        of="use",
    ),
    "identify_error_over_noise_floor": Metric(
        "error of the current over the noise floor, fitted recordings",
        title="error over the noise floor, fitted",
    ),
    "validate_error_over_noise_floor": Metric(
        "the same, recordings that were not fitted", title="error over the noise floor, not fitted"
    ),
    "scaled_condition": Metric(
        "condition number of the observation matrix, columns of unit length",
        title="condition number, scaled columns",
    ),
    "loop_gap": Metric("largest opening of a loop, m", title="largest opening of a loop", unit="m"),
    "position_cutoff": Metric(
        "cut-off of the low-pass on positions, Hz",
        title="cut-off of the position filter",
        unit="Hz",
        value=lambda run: run.result.settings.position_cutoff,
    ),
    "decimation": Metric(
        "one sample in this many is fitted", value=lambda run: float(run.result.settings.decimation)
    ),
    "drive_gain": Metric(
        "drive gain",
        "drive gain",
        of="joint",
        group="gains",
        values=lambda run: {joint: gain.value for joint, gain in run.result.drive_gains.items()},
    ),
    "parameter": Metric(
        "base parameter",  # .NAME, .NAME.std, .NAME.true
        group="parameters",
        values=lambda run: run.parameter_columns(),
    ),
    "parameter_error": Metric(
        "largest relative deviation of an essential base parameter from the true one",
        title="largest parameter error",
        relative=True,
        group="parameters",
        value=lambda run: run.worst_parameter(),
    ),
    "parameter_within": Metric(
        "share of the base parameters whose 95 % interval holds the truth",
        title="parameters inside their 95 % intervals",
        relative=True,
        share=True,
        group="parameters",
        value=lambda run: run.parameters_within(),
    ),
    "diagnosis": Metric(
        "of `diagnose`"
    ),  # .missed, .invented: numbers of effects; .missing: names; .gain_error
    "effect": Metric(
        "effect parameter",  # .EFFECT.JOINT.PARAMETER and .std
        group="effects",
        values=lambda run: run.effect_columns(),
    ),
}
NONE = Metric("")


def metric_of(column: str) -> Metric:
    """The metric of a column of a table; `NONE` if the column is not a metric."""
    return METRICS.get(column.partition(".")[0], NONE)


def what_is_measured(column: str) -> str:
    """What a column measures, in lower case; its name if it is not a metric."""
    return metric_of(column).measures or column


def is_share(column: str) -> bool:
    """Whether the mean of a column is a share of successes."""
    return metric_of(column).share


def is_relative(column: str) -> bool:
    """Whether a column is given in percent."""
    return metric_of(column).relative


AXIS_TITLES: Mapping[str, tuple[str, str]] = {
    "base": ("scenario", ""),
    "controller.feedforward": ("share of feed-forward", ""),
    "controller.natural_frequency": ("natural frequency of the controller", "Hz"),
    "design.duration": ("duration of a recording", "s"),
    "design.span": ("share of the joint ranges", ""),
    "gains.error": ("error of the nominal gains", ""),
    "hidden_effect": ("hidden effect", ""),
    "hidden_share": ("share of the torque that is hidden", ""),
    "log_rate": ("rate of the log", "Hz"),
    "method": ("estimator", ""),
    "sensors.current_noise_ratio": ("noise of the current over its RMS", ""),
    "sensors.encoder_bits": ("encoder bits", ""),
}


def metric_title(metric: str) -> str:
    """A metric in words, followed by the part after the dot, such as a joint."""
    head, _, of = metric.partition(".")
    title = metric_of(metric).title or head.replace("_", " ")
    return f"{title}, {USES.get(of, of.replace('_', ' '))}" if of else title


def axis_title(axis: str) -> str:
    """An axis in words with its unit; for an unknown key, the part after its last dot."""
    words, unit = axis_parts(axis)
    return f"{words} [{unit}]" if unit else words


def axis_words(axis: str) -> str:
    """The same without its unit, for a sentence."""
    return axis_parts(axis)[0]


def axis_parts(axis: str) -> tuple[str, str]:
    """An axis in words, and its unit."""
    if axis in METRICS and METRICS[axis].title:
        return METRICS[axis].title, ""
    if axis in AXIS_TITLES:
        return AXIS_TITLES[axis]
    parts = axis.split(".")
    if parts[0] == "payloads" and len(parts) == 3:
        return f"{parts[2].replace('_', ' ')} of payload {parts[1]}", "kg" if parts[2] == "mass" else ""
    if parts[0] == "hidden" and len(parts) == 3:
        return f"{parts[2]} of hidden {spoken(parts[1])}", ""
    return parts[-1].replace("_", " "), ""
