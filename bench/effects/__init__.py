"""The catalogue of physical effects, model side: one file an effect, one literal, sorted mapping."""

from bench.effects.catalogue import CATALOGUE, EffectInstance, select_effects
from bench.effects.effect import (
    ActuatorEffect,
    Effect,
    EffectParameter,
    JointSignals,
    RobotSignals,
    ShapeParameter,
    TorqueModel,
)

__all__ = [
    "CATALOGUE",
    "ActuatorEffect",
    "Effect",
    "EffectInstance",
    "EffectParameter",
    "JointSignals",
    "RobotSignals",
    "ShapeParameter",
    "TorqueModel",
    "select_effects",
]
