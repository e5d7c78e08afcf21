"""Columns of the wrong sign or joint, with which every effect that a search names is wrong."""

from collections.abc import Sequence
from pathlib import Path

from bench.basics.errors import BenchError
from bench.identification.finding import NEGATIVE, WRONG_COLUMNS, Finding
from bench.identification.finding_words import sentence
from bench.identification.result import Identification
from bench.identification.tolerances import TOLERANCES


def refuse_signs(folder: Path, causes: Sequence[Finding], before: Identification) -> None:
    """Raise BenchError for a column with the wrong sign or joint, before anything is searched.

    A negative gain of the starting model counts where that model explains the currents: otherwise an effect that is
    missing may have made it negative.
    """
    wrong = [finding for finding in causes if finding.code in WRONG_COLUMNS]
    error = before.error.identify
    if error is not None and error < TOLERANCES.findings.large_error:
        wrong += [finding for finding in before.findings if finding.code in NEGATIVE]
    if wrong:
        raise BenchError(f"{folder}: {sentence(wrong[0])}")
