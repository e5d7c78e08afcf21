"""Metrics and axes of a sweep as people say them; their names are for files and commands."""

from __future__ import annotations

from bench.effects.display_names import spoken

METRIC_TITLES = {
    "drive_gain": "drive gain",
    "error": "error of the current",
    "gain_error": "largest gain error",
    "gain_rms": "RMS gain error",
    "gain_std": "stated standard error of a gain",
    "gain_within": "gains inside their 95 % intervals",
    "identify_error_over_noise_floor": "error over the noise floor, fitted",
    "loop_gap": "largest opening of a loop",
    "noise_floor": "noise floor",
    "parameter_error": "largest parameter error",
    "parameter_within": "parameters inside their 95 % intervals",
    "position_cutoff": "cut-off of the position filter",
    "scaled_condition": "condition number, scaled columns",
    "validate_error_over_noise_floor": "error over the noise floor, not fitted",
}

AXIS_TITLES = {
    "base": "scenario",
    "controller.feedforward": "share of feed-forward",
    "controller.natural_frequency": "natural frequency of the controller [Hz]",
    "design.duration": "duration of a recording [s]",
    "design.span": "share of the joint ranges",
    "gains.error": "error of the nominal gains",
    "hidden_effect": "hidden effect",
    "hidden_share": "share of the torque that is hidden",
    "log_rate": "rate of the log [Hz]",
    "method": "estimator",
    "sensors.current_noise_ratio": "noise of the current over its RMS",
    "sensors.encoder_bits": "encoder bits",
}

RELATIVE = frozenset(
    {
        "error",
        "gain_error",
        "gain_rms",
        "gain_std",
        "gain_within",
        "noise_floor",
        "parameter_error",
        "parameter_within",
    }
)
"""Metrics that are told in percent."""


def metric_title(metric: str) -> str:
    """A metric in words; what it is of, such as a joint, behind it."""
    head, _, of = metric.partition(".")
    title = METRIC_TITLES.get(head, head.replace("_", " "))
    return f"{title}, {of.replace('_', ' ')}" if of else title


def axis_title(axis: str) -> str:
    """An axis in words: a key of a scenario by what it is, or what stands behind its last dot."""
    if axis in METRIC_TITLES:
        return METRIC_TITLES[axis]
    if axis in AXIS_TITLES:
        return AXIS_TITLES[axis]
    parts = axis.split(".")
    if parts[0] == "payloads" and len(parts) == 3:
        return f"{parts[2].replace('_', ' ')} of payload {parts[1]}" + (" [kg]" if parts[2] == "mass" else "")
    if parts[0] == "hidden" and len(parts) == 3:
        return f"{parts[2]} of hidden {spoken(parts[1])}"
    return parts[-1].replace("_", " ")


def axis_words(axis: str) -> str:
    """The same in a sentence, without its unit."""
    return axis_title(axis).partition(" [")[0]


def is_relative(metric: str) -> bool:
    """Whether a metric is told in percent."""
    return metric.partition(".")[0] in RELATIVE
