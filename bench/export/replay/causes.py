"""Why a twin's currents differ more than the model's: simulated again without a cause, it differs less."""

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

from bench.basics.progress import Progress
from bench.export.replay.simulated import Recorded, Simulated, simulate
from bench.export.replay.track import AS_EXPORTED, OPEN
from bench.identification.decision import RULE
from bench.identification.result import relative_error
from bench.robot_check.contacts import GeomPair


@dataclass(frozen=True)
class Contacts:
    """Geoms push each other. error: of the twin without contacts, infinite if it is still lost."""

    pairs: tuple[GeomPair, ...]
    error: float


@dataclass(frozen=True)
class SoftLoops:
    """Loops open. opened: by how much, m or rad; error: of the twin without the causes before this and with these
    solref and solimp at its equalities.
    """

    opened: float
    solref: tuple[float, float]
    solimp: tuple[float, float, float]
    error: float


@dataclass(frozen=True)
class PossibleBodies:
    """The exported bodies are possible ones, `distance` standard errors from the estimate; error: of the model with
    their parameters.
    """

    distance: float
    error: float


Cause = Contacts | SoftLoops | PossibleBodies


def causes_of(
    recorded: Recorded, simulated: Simulated, possible: float, progress: Progress
) -> tuple[Cause, ...]:
    """The causes of a twin's error, in the order in which they are to be mended.

    possible: relative error of the model with the parameters of the exported bodies.
    """
    causes: list[Cause] = list(_of_simulation(recorded, simulated, possible, progress))
    if possible > RULE.beyond_noise * (relative_error(recorded.modelled) or 0.0):
        causes.append(PossibleBodies(recorded.physical.distance, possible))
    return tuple(causes)


def _of_simulation(
    recorded: Recorded, first: Simulated, possible: float, progress: Progress
) -> tuple[Contacts | SoftLoops, ...]:
    """Contacts and soft loops, if the twin without them has a smaller error."""
    causes: list[Contacts | SoftLoops] = []
    change, now = AS_EXPORTED, first
    if _unexplained(now, possible) and now.touching:
        change = replace(change, contacts_off=True)
        without = simulate(recorded, change, progress)
        if _differs(now, without):
            causes.append(Contacts(now.touching, without.error))
        now = without
    if _unexplained(now, possible) and now.opened > OPEN:
        change = replace(change, stiff=True)
        stiff = simulate(recorded, change, progress)
        if _differs(now, stiff):
            solref = change.solref(now.tracked[0].step)
            causes.append(SoftLoops(now.opened, solref, change.solimp, stiff.error))
        now = stiff
    # without any current, the error is 1
    return tuple(causes) if now.error < (1.0 - RULE.helps) * min(first.error, 1.0) else ()


def _unexplained(simulated: Simulated, possible: float) -> bool:
    return simulated.error > RULE.beyond_noise * possible


def _differs(before: Simulated, after: Simulated) -> bool:
    """Whether a change moves the error; a twin that is lost before may be lost for another cause, too."""
    return math.isinf(before.error) or abs(after.error - before.error) > RULE.helps * before.error


def causes_as_data(causes: Sequence[Cause]) -> list[dict[str, Any]]:
    """The causes as plain data."""
    names: dict[type[Cause], str] = {
        Contacts: "contacts",
        SoftLoops: "soft_loops",
        PossibleBodies: "possible_bodies",
    }
    return [{"cause": names[type(cause)], **asdict(cause)} for cause in causes]
