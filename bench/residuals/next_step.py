"""What to do about errors that noise does not account for."""

from bench.identification.decision import RULE
from bench.identification.wording import motor_words
from bench.residuals.bounds import NAMING
from bench.residuals.motor import Compared, relative_error_of, relative_noise


def remaining_errors(what: Compared) -> list[str]:
    """One sentence for every motor whose error is far above the noise of its current."""
    lines = []
    for joint in what.joints:
        series = what.of(joint)
        error, noise = relative_error_of(series) or 0.0, relative_noise(series)
        if error > NAMING.unasked * noise > 0.0:
            times = f"{error / noise:.3g} times the noise of the current ({100.0 * noise:.3g} %)"
            lines.append(f"{motor_words(joint)}: error {100.0 * error:.3g} %, {times}")
    return lines


DIAGNOSE = "names the physical effect that the model lacks"
KEEP = "keeps the model"


def beyond_noise(what: Compared) -> bool:
    """Whether errors remain that noise does not account for."""
    errors = [
        (relative_error_of(what.of(joint)) or 0.0, relative_noise(what.of(joint))) for joint in what.joints
    ]
    return any(error > RULE.beyond_noise * noise for error, noise in errors)
