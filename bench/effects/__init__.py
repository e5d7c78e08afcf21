"""The catalogue of physical effects, model side: a file per effect."""

from bench.effects.catalogue import CATALOGUE
from bench.effects.checked_columns import effect_columns
from bench.effects.effect import (
    ActuatorEffect,
    Bracket,
    Effect,
    EffectParameter,
    JointSamples,
    Place,
    ShapeParameter,
    changes_torque,
)
from bench.effects.places import Places, passive_joints, places_in
from bench.effects.select import EffectInstance, select_effects
from bench.effects.signals import JointSignals, RobotSignals, TorqueModel
from bench.effects.user_file import catalogue_for, load_effects

__all__ = [
    "CATALOGUE",
    "ActuatorEffect",
    "Bracket",
    "Effect",
    "EffectInstance",
    "EffectParameter",
    "JointSamples",
    "JointSignals",
    "Place",
    "Places",
    "RobotSignals",
    "ShapeParameter",
    "TorqueModel",
    "catalogue_for",
    "changes_torque",
    "effect_columns",
    "load_effects",
    "passive_joints",
    "places_in",
    "select_effects",
]
