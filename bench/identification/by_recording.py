"""Recordings without a value of their own of an effect that has one for each recording."""

from bench.identification.finding import Code, Finding, Unknown
from bench.identification.prepare import Prepared


def without_own_values(prepared: Prepared) -> list[Finding]:
    """The recordings, and the effect with the recordings by whose values they are modelled."""
    among = {instance.effect.name: instance.among for instance in prepared.effects if instance.recording}
    found = []
    for name, logs in among.items():
        others = tuple(
            measurement.recording.name
            for measurement in prepared.measured
            if measurement.recording.log not in logs
        )
        if others:
            of = tuple(Unknown("effect", "", log, name) for log in logs)
            found.append(Finding(Code.NO_VALUE_OF_ITS_OWN, others, of))
    return found
