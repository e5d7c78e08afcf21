"""Reasons of verdicts, as codes; bench/diagnosis/reason_words.py has the sentences."""

from dataclasses import dataclass
from enum import StrEnum


class Because(StrEnum):
    """What the data say about an effect. `Reason.names` in brackets."""

    EXPLAINS = "explains"  # the error falls with it
    AS_GOOD = "as good"  # it would do as well as the identified effects
    AS_GOOD_AS_A_LAW = "as good as a law"  # outside the catalogue [the motors of such laws]
    GAINS_NOTHING = "gains nothing"
    GAINS_LITTLE = "gains little"  # too little to be certain
    TAKEN_UP = "taken up"  # by the model's parameters [the one that does most, if any]
    IMPOSSIBLE = (
        "impossible"  # a parameter is negative but must be positive [parameter, its place if not everywhere]
    )
    CANCELS = "cancels"  # its torque is many times the motor's, or cancels another's [the motor]
    USUAL = (
        "usual"  # friction, without which the error is larger than with the usual friction of a drive alone
    )
    WORSE_THAN_USUAL = (
        "worse than usual"  # the error is larger with it than with the usual friction of a drive
    )
    TOO_SHORT = "too short"  # the logs, for an effect of time alone [the longest log's length]
    NOT_NEEDED = "not needed"  # the other identified effects do as well without it


class Doubt(StrEnum):
    """Doubts about the name of an effect that explains something."""

    MUCH_LEFT = "much left"  # unexplained by the catalogue: it may imitate something else
    BESIDE_A_LAW = "beside a law"  # which explains far more at the same motor, and may be inexact


@dataclass(frozen=True)
class Reason:
    """Codes and names; errors, places and alternatives are in the verdict."""

    because: Because
    names: tuple[str, ...] = ()
    doubts: tuple[Doubt, ...] = ()
