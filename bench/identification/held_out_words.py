"""What recordings that were not fitted tell of the fitted ones, in words."""

from collections.abc import Callable, Mapping

from bench.effects.select import TAG
from bench.identification.finding import Code, Finding
from bench.identification.wording import and_list, in_percent


def _extrapolated(finding: Finding) -> str:
    return (
        f"{in_percent(finding.numbers['share'])} of the held-out samples are not judged: the fitted motions do not "
        "determine what the model gives there. Motions that reach further would."
    )


def _judged_beyond(finding: Finding) -> str:
    return (
        f"In most of the held-out samples of {and_list(finding.names)} the fitted motions do not determine what the "
        "model gives, so that their error says little about effects. Extend the fitted motions to the same range."
    )


def _unlike(finding: Finding) -> str:
    worst, *payload = finding.names
    load = f"the payload {payload[0]}" if payload else "no payload"
    return (
        f"{_far_worse(finding)}, {worst} worst: it is declared to carry {load}. Check that and its "
        "columns, or extend the fitted motions to the same range."
    )


def _other_values(finding: Finding) -> str:
    worst, *effects = finding.names
    ask = " ".join(f"--with {effect}{TAG}" for effect in effects)
    return (
        f"{_far_worse(finding)}, {worst} worst: {', '.join(effects)} differs in it, which hides missing effects; "
        f"`{ask}` estimates one value per recording."
    )


def _far_worse(finding: Finding) -> str:
    checked, fitted = (in_percent(finding.numbers[name]) for name in ("checked", "fitted"))
    return f"The error of recordings that were not fitted ({checked}) is far larger than that of fitted ones ({fitted})"


HELD_OUT_WORDS: Mapping[Code, Callable[[Finding], str]] = {
    Code.EXTRAPOLATED: _extrapolated,
    Code.JUDGED_BEYOND: _judged_beyond,
    Code.CHECKED_UNLIKE_FITTED: _unlike,
    Code.CHECKED_HAS_OTHER_VALUES: _other_values,
}
