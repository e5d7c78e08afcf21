"""A joint position whose zero is wrong."""

from dataclasses import dataclass

from bench.truth.hidden.base import JointEffect


@dataclass(frozen=True)
class EncoderOffset(JointEffect):
    """What is measured is q + offset: the log has it, and the controller acts on it.

    offset: rad or m.
    """

    name = "encoder_offset"
    shares = (0.004, 0.08)
    law = "logged and controlled position = q + offset"
    offset: float
