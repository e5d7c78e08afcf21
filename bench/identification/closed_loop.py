"""Closed-loop output error: the current that the twin's controller would command, compared with the logged one.

Gautier, Janot and Vandanjon, "A new closed-loop output error method for parameter identification of robot dynamics",
2013 (DIDIM). Under the same law and reference a simulated twin follows the robot's motion whatever its parameters, up
to an error e of the encoder resolution; to first order in e, the errors of its positions and currents are linear in the
parameters. Position errors enter through the law: the current that it computes from reference and measured position is
a second reading of the motors' current, without the noise of the logged one. The instruments are at the twin's motion:
noise in the measured one would bias the estimate behind wide filters.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from bench.basics.errors import BenchError
from bench.dataset.controller import ControlLaw, references
from bench.dataset.recording import Recording
from bench.identification.compressed import Stack, compress
from bench.identification.current_error import current_error, current_floor, squared_errors
from bench.identification.decision import RULE
from bench.identification.effect_columns import robot_signals
from bench.identification.effect_rows import effect_rows
from bench.identification.filtered import Measured, measure
from bench.identification.instrumental import instrumental_variables
from bench.identification.layout import known_rows, regressor_rows
from bench.identification.observation import observe
from bench.identification.prepare import Prepared
from bench.identification.solution import Solution
from bench.identification.standstill import interpolated
from bench.identification.tolerances import TOLERANCES
from bench.signals.bounds import BANDS
from bench.signals.decimation import decimate
from bench.signals.processing import estimate_motion
from bench.signals.settings import signal_bands

TERMS = ("kp", "kv", "ka")


def output_error(
    stack: Stack,
    start: Solution,
    nominal: np.ndarray,
    terms: np.ndarray,
    simulated: np.ndarray,
    joints: Sequence[str],
) -> Solution:
    """Gains and parameters from two readings of each motor's current, each weighted by its residual.

    terms (M, n, 3): of the controller's law, from references and measured positions, row by row as in the stack.
    simulated (M, n, p + 1): [Phi, kappa] at the motion of the twin; nominal gains (n,) stay where they are not fitted.
    The law is taken as exact and sets the scale of the gains. Raises BenchError naming a joint whose logged currents
    contradict the law.
    """
    terms = terms * stack.moving[:, :, None]
    _check_law(stack.current, terms, joints)
    commanded = terms.sum(axis=2)
    readings = [stack.current, commanded]
    precisions = []
    for current in readings:
        given = with_current(stack, current)
        solution = current_error(given, start)
        squares = squared_errors(given.factors, solution.theta, solution.gains) / len(current)
        precisions.append(1.0 / np.maximum(squares, current_floor(stack) ** 2))
    current = sum(reading * weight for reading, weight in zip(readings, precisions, strict=True)) / sum(
        precisions
    )

    def transform(given: Stack) -> Stack:
        return with_current(given, current)

    return replace(instrumental_variables(transform(stack), start, nominal, simulated), transform=transform)


def _check_law(logged: np.ndarray, terms: np.ndarray, joints: Sequence[str]) -> None:
    """Check that the logged currents (M, n) contain each of the law's terms (M, n, 3) with a factor of one."""
    parts = np.array_split(np.arange(len(logged)), TOLERANCES.statistics.compared_parts)
    for joint, measured, every in zip(joints, logged.T, terms.swapaxes(0, 1), strict=True):
        present = np.flatnonzero(every.any(axis=0))
        law = every[:, present]
        factors = np.linalg.lstsq(law, measured, rcond=1e-9)[0]
        error = measured - law @ factors
        scores = np.array([law[part].T @ error[part] for part in parts])
        inverse = np.linalg.pinv(law.T @ law, rcond=1e-18, hermitian=True)
        deviations = np.sqrt(np.diag(inverse @ scores.T @ scores @ inverse))
        for k, factor, deviation in zip(present, factors, deviations, strict=True):
            if abs(factor - 1.0) > RULE.certain * deviation + TOLERANCES.statistics.law_current:
                raise BenchError(
                    f"controller of joint {joint}: the logged current has {factor:.4g} ± {deviation:.2g} times the "
                    f"law's term with {TERMS[k]}: another law, another unit, or noise that the filter lets through?"
                )


def with_current(stack: Stack, current: np.ndarray) -> Stack:
    """The equations with other currents (M, n)."""
    return replace(stack, current=current, factors=compress(stack.phi, stack.kappa, current))


def commanded_currents(prepared: Prepared) -> np.ndarray:
    """The law's terms with kp, kv and ka (M, n, 3), drive units, filtered and decimated as the rows of the fit.

    Raises BenchError if the dataset lacks the controller's law, or a recording its reference.
    """
    dataset = prepared.dataset
    if dataset.controller is None:
        raise BenchError(
            f"{dataset.folder}: method 'oe' needs the controller's law: [controller] in dataset.toml, and columns "
            "reference.JOINT in the recordings"
        )
    joints, decimation = dataset.robot.joints, prepared.settings.decimation
    currents = []
    for measurement in prepared.measured:
        if measurement.recording.use == "identify":
            terms = law_terms(dataset.controller, measurement, joints)
            currents.append(decimate(interpolated(terms, measurement.gaps), decimation))
    return np.concatenate(currents)


def law_terms(law: ControlLaw, measured: Measured, joints: Sequence[str]) -> np.ndarray:
    """The law's terms (N, n, 3) from a recording's references and positions, at its rate.

    As a current, it keeps as much of the fit's band as the logged one, however narrow the filter of the motion is.
    """
    recording, settings = measured.recording, measured.settings
    band = settings.band(recording.rate)
    cutoff = min(max(settings.position_cutoff, BANDS.widest * band), BANDS.highest_cutoff * recording.rate)
    wide = replace(settings, position_cutoff=cutoff)
    wanted = estimate_motion(references(recording, joints), recording.rate, wide)
    seen = estimate_motion(recording.position, recording.rate, wide)
    velocity = wanted.velocity - seen.velocity + law.velocity_delay * seen.acceleration
    terms = law.kp * (wanted.position - seen.position), law.kv * velocity, law.ka * wanted.acceleration
    return np.stack(terms, axis=2)


def simulated_columns(prepared: Prepared) -> np.ndarray:
    """[Phi, kappa] (M, n, p + 1) at the twin's motion, the rows of all fitted recordings in the order of the stack.

    The twin follows the measured positions up to twice the motion's band, which comes from the spectra, not the fit's
    filters.
    """
    fitted = [measurement for measurement in prepared.measured if measurement.recording.use == "identify"]
    recordings = [measurement.recording for measurement in fitted]
    cutoff = followed_band(recordings)
    parts = []
    for measurement in fitted:
        settings = replace(prepared.settings, position_cutoff=min(cutoff, 0.4 * measurement.recording.rate))
        motion = replace(measure(prepared.model, measurement.recording, settings), gaps=measurement.gaps)
        parts.append(columns_at(prepared, motion))
    return np.concatenate(parts)


def followed_band(recordings: Sequence[Recording]) -> float:
    """Highest frequency that the twin follows, Hz."""
    bands = signal_bands(
        [recording.position for recording in recordings],
        [recording.current for recording in recordings],
        recordings[0].rate,
    )
    return TOLERANCES.motion.twin_band * bands.motion


def columns_at(prepared: Prepared, measured: Measured) -> np.ndarray:
    """[Phi, kappa] (M, n, p + 1) of one recording at some motion, filtered and decimated as the fit's."""
    layout, payloads = prepared.layout, prepared.dataset.payloads
    signals = robot_signals(prepared.model, measured, prepared.present)
    effects = effect_rows(signals, prepared.settings.decimation, prepared.effects)
    rows = replace(observe(prepared.model, measured), effects=effects)
    phi, kappa = regressor_rows(rows, layout), known_rows(rows, payloads)
    return np.concatenate((phi, kappa[:, :, None]), axis=2)
