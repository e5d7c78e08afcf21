"""Why an effect got its verdict, as codes; bench/diagnosis/reason_words.py says it."""

from dataclasses import dataclass
from enum import StrEnum


class Because(StrEnum):
    """What the data say of an effect. names of the `Reason` in brackets."""

    EXPLAINS = "explains"  # the error falls with it
    AS_GOOD = "as good"  # it would do as well as the identified effects
    AS_GOOD_AS_A_LAW = "as good as a law"  # that is in no catalogue [the motors of such laws]
    GAINS_NOTHING = "gains nothing"
    GAINS_LITTLE = "gains little"  # too little to be sure
    TAKEN_UP = "taken up"  # by the model's parameters [the one that does most, if any]
    IMPOSSIBLE = (
        "impossible"  # a parameter is negative that cannot be [parameter, its place if not everywhere]
    )
    CANCELS = "cancels"  # its torque is many times all that a motor gives, or cancels another's [the motor]
    MOVES_GAIN = (
        "moves a gain"  # where the model's error is no noise, and explains too little for that [the motor]
    )
    USUAL = (
        "usual"  # friction, without which the error is larger than with the usual friction of a drive alone
    )
    WORSE_THAN_USUAL = (
        "worse than usual"  # the error is larger with it than with the usual friction of a drive
    )
    TOO_SHORT = (
        "too short"  # are the logs for something that changes with the time alone [the longest log's length]
    )
    NOT_NEEDED = "not needed"  # the other identified effects do as well without it


class Doubt(StrEnum):
    """What makes the name of an effect that explains something unsure."""

    MUCH_LEFT = "much left"  # by effects of the catalogue: it may imitate something else
    BESIDE_A_LAW = "beside a law"  # that explains far more at the same motor, and may be inexact


@dataclass(frozen=True)
class Reason:
    """Codes and names; errors, places and alternatives stand in the verdict itself."""

    because: Because
    names: tuple[str, ...] = ()
    doubts: tuple[Doubt, ...] = ()
