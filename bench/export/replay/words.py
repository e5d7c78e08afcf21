"""A replay in words."""

from bench.export.replay.replay import Replay
from bench.identification.result import relative_error
from bench.identification.wording import in_percent

OPEN = 1e-4  # m or rad: a loop that opens farther moves the motors


def replay_sentences(result: Replay) -> tuple[str, ...]:
    """How near the twin comes to the measurements, compared with the model, and what it does not hold."""
    twin, model = relative_error(result.twin.recordings), relative_error(result.model.recordings)
    if twin is None or model is None:
        return shortcomings(result)
    count = len(result.twin.recordings)
    said = (
        f"Simulated by MuJoCo along {count} recorded motion{'s' if count > 1 else ''}, the twin's currents differ "
        f"from the measured ones by {in_percent(twin)}; those of the exported model by {in_percent(model)}."
    )
    return (said, *shortcomings(result))


def shortcomings(result: Replay) -> tuple[str, ...]:
    """What the twin leaves out, and loops that open."""
    messages = [f"Not simulated, so its part of the current is missing: {name}." for name in result.left_out]
    if result.opened > OPEN:
        messages.append(
            f"Loops open by up to {1e3 * result.opened:.2g} mm or mrad: solref and solimp of the MJCF's equalities are "
            'soft; solref="0.002 1" solimp="0.9999 0.99999 0.001" keeps them closed.'
        )
    return tuple(messages)
