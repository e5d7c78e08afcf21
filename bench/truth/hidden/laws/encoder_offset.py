"""A joint position with a wrong zero."""

from dataclasses import dataclass

from bench.truth.hidden.base import JointEffect


@dataclass(frozen=True)
class EncoderOffset(JointEffect):
    """The measured position is q + offset, in the log and in the controller.

    offset: rad or m.
    """

    name = "encoder_offset"
    shares = (0.004, 0.08)
    law = "logged and controlled position = q + offset"
    offset: float
