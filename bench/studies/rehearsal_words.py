"""A rehearsal in words."""

from bench.excitation.experiment.simulated import SimulatedDrive
from bench.studies.rehearsal import Rehearsal


def rehearsal_sentence(rehearsal: Rehearsal) -> str:
    """What a scenario differs in from the drive that is tried first, or that none runs; "" where the first one runs."""
    if not rehearsal.refused:
        return ""
    if rehearsal.runs:
        first = rehearsal.refused[0]
        taken, other = _described(rehearsal.drive), _described(first.drive)
        return f"The scenario simulates {taken}, because {other} fails: {first.why}."
    last = rehearsal.refused[-1]
    return f"The scenario cannot be simulated. With {_described(last.drive)}, the last attempt: {last.why}."


def _described(drive: SimulatedDrive) -> str:
    return f"a controller of {drive.natural_frequency:g} Hz in steps of {1e3 * drive.step:g} ms"
