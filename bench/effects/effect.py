"""What an effect is: columns that the model lacks, beside those of the rigid bodies."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import ClassVar

import numpy as np


@dataclass(frozen=True)
class EffectParameter:
    """A parameter of an effect; in its unit `{effort}` is N*m or N and `{angle}` is rad or m."""

    name: str
    unit: str

    def unit_at(self, rotates: bool) -> str:
        """The unit at a hinge (True) or at a slide (False)."""
        return self.unit.format(effort="N*m" if rotates else "N", angle="rad" if rotates else "m")


@dataclass(frozen=True)
class JointSignals:
    """What is known of one actuated joint at every sample, each (N,), before decimation.

    time s; position, velocity, acceleration in rad or m and their rates, filtered; current in drive units, as
    logged; gain: the nominal drive gain, N*m or N per drive unit.
    """

    time: np.ndarray
    position: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray
    current: np.ndarray
    gain: float


@dataclass(frozen=True)
class Effect(ABC):
    """A physical effect at an actuated joint, linear in its parameters.

    The motor has to overcome `columns @ parameters`, N*m or N, beside the rigid-body torque.
    """

    name: ClassVar[str]
    parameters: ClassVar[tuple[EffectParameter, ...]]

    @abstractmethod
    def columns(self, joint: JointSignals) -> np.ndarray:
        """One column (N, p) for each parameter: its torque or force at a parameter value of one."""
