"""A replay in sentences."""

from bench.basics.sentence import in_percent
from bench.export.replay.cause_words import cause_sentence
from bench.export.replay.replay import Replay
from bench.identification.result import relative_error


def replay_sentences(result: Replay) -> tuple[str, ...]:
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


def shortcomings(result: Replay) -> tuple[str, ...]:
    """Why the twin's error is larger than the model's, and what it omits."""
    return (
        *map(cause_sentence, result.causes),
        *(f"Not simulated, so its part of the current is missing: {name}." for name in result.left_out),
    )
