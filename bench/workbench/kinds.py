"""Which way an effect's columns change with its shape, with its value and with the present model."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from bench.effects import (
    ActuatorEffect,
    Bracket,
    Effect,
    EffectInstance,
    JointSamples,
    RobotSignals,
    places_in,
)
from bench.identification.effect_columns import robot_signals
from bench.identification.joint_samples import joint_samples
from bench.identification.partial_regression import PartialRegression, partial_regression
from bench.identification.prepare import Prepared, with_effects
from bench.identification.solve_only import candidate_columns, solved_quickly
from bench.workbench.found_model import FoundModel
from bench.workbench.small_perturbations import small_changes
from bench.workbench.variants import (
    FEW_NODES,
    NODES,
    Variants,
    branches_of,
    linear,
    of_needed,
    scale_of,
    searchable,
    shape_order,
    shape_stays,
    shaped,
    timed,
    valued,
)

SHARE = 0.3  # of the torque that the model needs: an effect in proportion to it is told apart up to that size
MANY = 8  # effects through the loops: more are told apart less finely
SAME = 1e-9  # of columns: what rounding leaves of a sum


class Kinds:
    """Effects as the page can evaluate them about the found model.

    unit: what effects see of every recording with drive gains of one. roomy: whether bodies and joints are few, so
    that errors of lengths and zeros can be told apart by their size. ticked: (effect, place) of the found model's
    effects. seen: what the others see of every recording, small changes where there are many of them.
    """

    def __init__(self, model: FoundModel) -> None:
        self.model = model
        found = model.found
        ones = np.ones_like(found.present.gains)
        self.unit = tuple(_signals(found, i, ones) for i in range(len(found.measured)))
        self._scaled = [_signals(found, 0, size * ones) for size in (1.0, 2.0, -1.0)]
        weighed = [name for name, one in found.dataset.payloads.items() if one.mass is not None]
        self._places = places_in(found.model.geometry, weighed)
        self.roomy = len(self._places.body) + len(self._places.actuator) <= MANY
        self.ticked = {(one.effect.name, one.joint) for one in model.effects}
        self.seen = found.signals if self.roomy else tuple(small_changes(one) for one in found.signals)
        self._without: dict[str, PartialRegression] = {}
        self._additive: dict[str, bool] = {}

    def of(self, effect: Effect) -> list[Variants]:
        """The effect at every place at which it can sit."""
        name = effect.name
        found = {one.joint: one for one in self.model.effects if one.effect.name == name}
        return [
            self._variants(
                found.get(place) or EffectInstance(effect, place, f"{name}:{place}" if place else name)
            )
            for place in self._places.of(effect.place)
        ]

    def _variants(self, instance: EffectInstance) -> Variants:
        effect = instance.effect
        if effect.before_torque and isinstance(effect, ActuatorEffect) and not effect.shape:
            return self._before_torque(instance)
        if effect.depends_on_model and not isinstance(effect, ActuatorEffect) and shape_stays(effect):
            return self._through_loops(instance)
        scale = scale_of(instance, *self._scaled)
        approximate = not scale
        bent = effect.about({parameter.name: 0.0 for parameter in effect.parameters}) is not effect
        if searchable(effect) and (approximate or not bent):
            nodes = NODES if self.roomy else FEW_NODES
            return shaped(instance, self._brackets(instance), scale or "none", approximate, nodes)
        return linear(instance, scale or "none", approximate or bent or bool(effect.shape))

    def _before_torque(self, instance: EffectInstance) -> Variants:
        """An effect made of the torque that the model needs at its joint, such as a delay."""
        effect = instance.effect
        if effect.about({parameter.name: 0.0 for parameter in effect.parameters}) is effect:
            return linear(instance, "none", False, "needed")
        if effect.of_torque == "proportion":
            return of_needed(instance, SHARE)
        if effect.of_torque != "time":
            return linear(instance, "none", True, "needed")
        rate = self.model.plain.measured[0].recording.rate
        return timed(instance, self.model.plain.settings.band(rate))

    def _through_loops(self, instance: EffectInstance) -> Variants:
        """An effect made of the rigid-body torque, at another geometry, motion or gravity."""
        effect = instance.effect
        if effect.name not in self._additive:
            self._additive[effect.name] = self._adds_up(instance)
        if not self._additive[effect.name]:
            return linear(instance, "none", True)
        if effect.about({parameter.name: 0.0 for parameter in effect.parameters}) is effect:
            return linear(instance, "none", False, "rigid")
        if not self.roomy:
            return linear(instance, "none", True, "rigid")
        reach = effect.reach(self.unit[0], instance.joint)
        return linear(instance, "none", True, "rigid") if reach is None else valued(instance, reach)

    def _adds_up(self, instance: EffectInstance) -> bool:
        """Whether the columns of a sum of models are the sum of their columns."""
        found = self.model.found
        present = found.present
        other = np.random.default_rng(1).normal(size=len(present.base)) * present.base

        def columns(base: np.ndarray, payloads: float) -> np.ndarray:
            carried = {name: payloads * values for name, values in present.payloads.items()}
            changed = replace(present, base=base, payloads=carried)
            signals = robot_signals(found.model, found.measured[0], changed)
            if not self.roomy:
                signals = small_changes(signals)
            return instance.effect.columns(signals, instance.joint)

        first, second = columns(present.base, 1.0), columns(other, 0.0)
        both = columns(present.base + other, 1.0)
        return bool(np.abs(both - first - second).max() <= SAME * max(np.abs(both).max(), 1.0) * 1e3)

    def _brackets(self, instance: EffectInstance) -> tuple[tuple[tuple[Bracket, ...], ...], ...]:
        """Where the shape is searched, in every branch, beside no effect at all and beside the found ones."""
        effect = instance.effect
        free, others = shape_order(effect)
        every: list[list[tuple[EffectInstance, tuple[Bracket, ...]]]] = []
        contexts = self._contexts(effect.name)
        for prepared, left in contexts:
            samples = joint_samples(prepared, instance, left)
            if not self.roomy:
                samples = tuple(_every_other(one) for one in samples)
            branches = []
            for values in branches_of(effect):
                named = dict(zip((one.name for one in others), values, strict=True))
                tried = replace(instance, effect=replace(effect, **named))
                branches.append((tried, tried.effect.brackets(free, samples)))
            every.append(branches)
        brackets = [tuple(one for _, one in branches) for branches in every]
        if brackets[0] == brackets[1]:
            return tuple(brackets)
        return tuple(
            tuple((_best(tried, one, *context),) for tried, one in branches)
            for branches, context in zip(every, contexts, strict=True)
        )

    def _contexts(self, name: str) -> list[tuple[Prepared, PartialRegression]]:
        """The equations and what they leave, without any effect, and with those found but this one."""
        model, found = self.model, self.model.found
        contexts = [(model.plain, model.bare), (found, model.left)]
        if any(one.effect.name == name for one in model.effects):
            if name not in self._without:
                kept = [one for one in model.effects if one.effect.name != name]
                others = with_effects(found, (*model.plain.effects, *kept))
                self._without[name] = partial_regression(*solved_quickly(others, model.fit_gains))
            contexts[1] = (found, self._without[name])
        return contexts


def _best(
    instance: EffectInstance, brackets: Sequence[Bracket], prepared: Prepared, left: PartialRegression
) -> Bracket:
    """The bracket whose first value explains most."""
    name = shape_order(instance.effect)[0].name
    explained = []
    for _, value, _ in brackets:
        changed = replace(instance, effect=replace(instance.effect, **{name: value}))
        explained.append(left.explained(candidate_columns(prepared, [changed]))[1])
    return brackets[int(np.argmax(explained))]


def _every_other(samples: JointSamples) -> JointSamples:
    """Half of the samples: enough to see which period stands out."""
    arrays = ("position", "velocity", "motor_torque", "error")
    return replace(samples, **{name: getattr(samples, name)[::2] for name in arrays})


def _signals(found: Prepared, recording: int, gains: np.ndarray) -> RobotSignals:
    return robot_signals(found.model, found.measured[recording], replace(found.present, gains=gains))
