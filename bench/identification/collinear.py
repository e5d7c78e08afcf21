"""Calibration together with dynamics: which effects' parameters the data tell only in combination."""

from collections.abc import Sequence

import numpy as np

from bench.effects import EffectInstance
from bench.identification.decision import RULE
from bench.identification.finding import Code, Finding, Unknown
from bench.identification.tolerances import TOLERANCES


def collinear(
    effects: Sequence[EffectInstance], covariance: np.ndarray, rows: Sequence[Unknown]
) -> list[Finding]:
    """A finding for each combination of effects that are changes of the model itself, such as zeros of encoders, a tilt
    and lengths, whose parameters are known together far better than each.

    covariance (P, P), its rows named. The eigenvector of a small eigenvalue of the correlation between them is the
    combination that is known; what is known of each by itself is 1 / sqrt(eigenvalue) times less.
    """
    changing = {
        (instance.effect.name, instance.place) for instance in effects if instance.effect.depends_on_model
    }
    indices = [
        i
        for i, row in enumerate(rows)
        if row.kind == "effect" and (row.effect, row.place) in changing and covariance[i, i] > 0.0
    ]
    if len(indices) < 2:
        return []
    std = np.sqrt(np.diag(covariance)[indices])
    values, vectors = np.linalg.eigh(covariance[np.ix_(indices, indices)] / np.outer(std, std))
    findings = []
    for value, vector in zip(values, vectors.T, strict=True):
        if value * TOLERANCES.findings.widened**2 >= 1.0:
            break
        part = np.flatnonzero(np.abs(vector) >= TOLERANCES.findings.takes_part * np.abs(vector).max())
        together = tuple(rows[indices[i]] for i in part)
        if len({(unknown.effect, unknown.place) for unknown in together}) > 1:
            wider = float(1.0 / np.sqrt(max(value, np.finfo(float).eps)))
            findings.append(Finding(Code.HARDLY_APART, of=together, numbers={"wider": wider}))
    return findings


def unsettled(
    effects: Sequence[EffectInstance], values: np.ndarray, std: np.ndarray
) -> list[tuple[int, Unknown]]:
    """Parameters of effects, by index, that are not where the effect was linearised: the search for them did not end.

    values, std (k,): of all parameters of all effects, one effect after the other.
    """
    findings, at = [], 0
    for instance in effects:
        about = instance.effect.about_values()
        for k, parameter in enumerate(instance.effect.parameters):
            value, place = float(values[at + k]), about.get(parameter.name, 0.0)
            off = abs(value - place)
            if (
                place
                and off > RULE.shows * std[at + k]
                and off > TOLERANCES.steps.linearisation_reached * max(abs(value), abs(place))
            ):
                findings.append(
                    (at + k, Unknown("effect", parameter.name, instance.place, instance.effect.name))
                )
        at += len(instance.effect.parameters)
    return findings
