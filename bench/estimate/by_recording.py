"""What is said of effects that have a value for each recording."""

from bench.effects.names import spoken
from bench.estimate.prepare import Prepared


def notes_by_recording(prepared: Prepared) -> list[str]:
    """With what recordings are modelled that have no value of their own."""
    among = {one.effect.name: one.among for one in prepared.effects if one.recording}
    notes = []
    for name, logs in among.items():
        others = [one.recording.name for one in prepared.measured if one.recording.log not in logs]
        if others:
            value = "the mean of the values of these" if len(logs) > 1 else "the value of that one"
            has, its, it_is = ("has", "its", "it is") if len(others) == 1 else ("have", "their", "they are")
            notes.append(
                f"{', '.join(others)} {has} no {spoken(name)} of {its} own, as the fitted recordings have "
                f"({', '.join(logs)}): {it_is} modelled with {value}."
            )
    return notes
