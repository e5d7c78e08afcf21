"""A replay in sentences: how far the twin agrees, and why its currents differ more than the model's."""

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from bench.basics.sentence import in_percent
from bench.export.replay.causes import Cause, Contacts, SoftLoops
from bench.export.replay.track import Lost
from bench.identification.result import relative_error
from bench.robot_check.contact_words import pairs_in_words, without_contacts

if TYPE_CHECKING:
    from bench.export.replay.replay import Replay


def lost_in_words(lost: Lost, causes: Sequence[Cause]) -> str:
    """A twin that does not follow, with what makes it follow."""
    said = f"the twin does not follow the recording: joint {lost.joint} is lost at t = {lost.time:.3f} s"
    if not causes:
        return f"{said} (a stop, or a time step that is too long?)"
    return " ".join([f"{said}.", *map(cause_sentence, causes)])


def cause_sentence(cause: Cause) -> str:
    """A cause with what to write in the MJCF."""
    if isinstance(cause, Contacts):
        return (
            f"Geoms touch: {pairs_in_words(cause.pairs)}. MuJoCo pushes them apart, the model has no contacts: "
            f"{without_contacts(cause.pairs)}.{_then(cause.error)}"
        )
    if isinstance(cause, SoftLoops):
        solref, solimp = (" ".join(f"{x:.5g}" for x in values) for values in (cause.solref, cause.solimp))
        return (
            f"Loops open by up to {1e3 * cause.opened:.2g} mm or mrad, as solref and solimp of the MJCF's equalities "
            f'are soft: write solref="{solref}" solimp="{solimp}".{_then(cause.error)}'
        )
    return (
        f"No real bodies have the identified parameters: the exported ones are {cause.distance:.1f} standard errors "
        f"away, and the model with them has an error of {in_percent(cause.error)}."
    )


def _then(error: float) -> str:
    """What a cure gives, as a further sentence."""
    return "" if math.isinf(error) else f" The error is then {in_percent(error)}."


def replay_sentences(result: "Replay") -> tuple[str, ...]:
    """Agreement of the twin with the measurements, compared with the model, and why it is not better."""
    twin, model = relative_error(result.twin.recordings), relative_error(result.model.recordings)
    if twin is None or model is None:
        return shortcomings(result)
    count = len(result.twin.recordings)
    said = (
        f"Simulated by MuJoCo along {count} recorded motion{'s' if count > 1 else ''}, the twin's currents differ "
        f"from the measured ones by {in_percent(twin)}; those of the exported model by {in_percent(model)}."
    )
    return (said, *shortcomings(result))


def shortcomings(result: "Replay") -> tuple[str, ...]:
    """Why the twin's error is larger than the model's, and what it omits."""
    return (
        *map(cause_sentence, result.causes),
        *(f"Not simulated, so its part of the current is missing: {name}." for name in result.left_out),
    )
