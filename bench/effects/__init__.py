"""The catalogue of physical effects, model side: one file an effect, one literal, sorted mapping."""

from bench.effects.catalogue import CATALOGUE, EffectInstance, select_effects
from bench.effects.effect import Effect, EffectParameter, JointSignals

__all__ = ["CATALOGUE", "Effect", "EffectInstance", "EffectParameter", "JointSignals", "select_effects"]
