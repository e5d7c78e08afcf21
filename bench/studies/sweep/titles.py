"""Metrics and axes of a sweep as people say them; their names are for files and commands."""

from __future__ import annotations

from collections.abc import Mapping

from bench.effects.display_names import spoken
from bench.studies.sweep.metrics import METRICS, metric_of

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

USES: Mapping[str, str] = {"identify": "fitted", "validate": "not fitted"}


def metric_title(metric: str) -> str:
    """A metric in words; what it is of, such as a joint, behind it."""
    head, _, of = metric.partition(".")
    title = metric_of(metric).title or head.replace("_", " ")
    return f"{title}, {USES.get(of, of.replace('_', ' '))}" if of else title


def axis_title(axis: str) -> str:
    """An axis in words with its unit: a key of a scenario by what it is, or the part behind its last dot."""
    words, unit = axis_parts(axis)
    return f"{words} [{unit}]" if unit else words


def axis_words(axis: str) -> str:
    """The same in a sentence, without its unit."""
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
