"""A joint position whose zero is wrong."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from bench.truth.hidden.base import JointEffect


@dataclass(frozen=True)
class EncoderOffset(JointEffect):
    """What is measured is q + offset: the log has it, and the controller acts on it.

    offset: rad or m.
    """

    name: ClassVar[str] = "encoder_offset"
    shares: ClassVar[tuple[float, float]] = (0.004, 0.08)
    law: ClassVar[str] = "logged and controlled position = q + offset"
    offset: float
