"""Currents for a desired motion, to add to a controller's feedback."""

from dataclasses import dataclass
from functools import partial

import numpy as np

from bench.basics.errors import BenchError
from bench.effects import ActuatorEffect
from bench.effects.passive_joint import PassiveEffect
from bench.export.identified import EffectValues, IdentifiedModel, carried
from bench.model.geometry import Geometry
from bench.model.motion import Motion, motion_of, rates_at
from bench.model.regressor import projected_regressor
from bench.twin.laws import Memoryless, joint_law_of


@dataclass(frozen=True)
class Chosen:
    """The effects of a model that depend only on present position, velocity and acceleration, and the others."""

    at_motors: tuple[EffectValues, ...]
    between: tuple[EffectValues, ...]
    in_passive: tuple[EffectValues, ...]
    left_out: tuple[str, ...]


def chosen_effects(model: IdentifiedModel) -> Chosen:
    """Sort the effects of a model by their inputs."""
    at_motors, between, in_passive, left_out = [], [], [], []
    for fitted_effect in model.effects_in():
        effect = fitted_effect.instance.effect
        if isinstance(effect, PassiveEffect):
            in_passive.append(fitted_effect)
        elif effect.of_instant and effect.before_torque:
            between.append(fitted_effect)
        elif effect.of_instant or _steady(fitted_effect):
            at_motors.append(fitted_effect)
        else:
            left_out.append(f"{effect.name} at {fitted_effect.place}" if fitted_effect.place else effect.name)
    return Chosen(tuple(at_motors), tuple(between), tuple(in_passive), tuple(left_out))


class Feedforward:
    """Currents for a desired motion of the driven joints, in the units and order of the robot's actuators.

    Loops are closed from the pose of the previous call, or from home. payload: name of the one that the robot carries,
    none by default; BenchError if the model does not know it. left_out: omitted effects that need more than the instant
    (a delay, a spring in a drive, warm-up); their current is missing.
    """

    def __init__(self, model: IdentifiedModel, payload: str | None = None) -> None:
        self.joints = model.robot.joints
        self._columns, self._values = carried(model, payload)
        self._model, self._effects = model, chosen_effects(model)
        self.left_out = self._effects.left_out
        self._before: Motion | None = None

    def __call__(self, position: np.ndarray, velocity: np.ndarray, acceleration: np.ndarray) -> np.ndarray:
        """Currents (n,) for positions, velocities and accelerations (n,) each, as logged: rad or m and rates."""
        asked = [np.asarray(values, dtype=float) for values in (position, velocity, acceleration)]
        if any(values.shape != (len(self.joints),) for values in asked):
            raise BenchError(f"{len(self.joints)} values each are needed: {', '.join(self.joints)}")
        geometry = self._model.model.geometry
        motion = motion_of(geometry, np.zeros(1), *(values[None] for values in asked), near=self._before)
        if geometry.closed:  # once more from there, for the Jacobian of the closed pose to rounding
            motion = rates_at(geometry, motion.time, motion.q, asked[1][None], asked[2][None])
        self._before = motion
        torque = (projected_regressor(geometry, motion, self._columns) @ self._values)[0]
        for effect in self._effects.in_passive:
            torque += _passive(geometry, motion, effect)
        for fitted_effect in self._effects.at_motors:
            j = self.joints.index(fitted_effect.place)
            torque[j] += self._at_motor(fitted_effect, j, asked, 0.0)
        total = torque.copy()
        for effect_values in self._effects.between:
            j = self.joints.index(effect_values.place)
            total[j] += self._at_motor(effect_values, j, asked, float(torque[j]))
        return np.asarray(total / self._model.gains)

    def _at_motor(self, fitted_effect: EffectValues, j: int, asked: list[np.ndarray], needed: float) -> float:
        """Torque of an effect at motor j, given the rest of the motor's torque."""
        effect, gain = fitted_effect.instance.effect, float(self._model.gains[j])
        if not isinstance(effect, ActuatorEffect):
            raise TypeError(effect.name)
        rotates = self._model.model.geometry.active_joints[j].kind != "slide"
        law = Memoryless(effect, np.array(list(fitted_effect.values.values())), gain, rotates)
        state = [np.zeros(1), *(part[j : j + 1] for part in asked), np.array([needed / gain])]
        return float(law.at(*state, needs=partial(np.full, 1, needed))[0])


def _steady(fitted_effect: EffectValues) -> bool:
    """Whether an effect at a motor depends only on the instant, not on time."""
    effect = fitted_effect.instance.effect
    law = joint_law_of(effect, fitted_effect.values, 1.0, True)
    if not isinstance(law, Memoryless):
        return False
    state = np.array([0.0, 0.7, 1.3, 0.0, 0.0])[:, None]
    later, with_current = state + np.eye(5)[[0, 4], :, None]
    first = law.at(*state)
    return bool(np.array_equal(first, law.at(*later)) and np.array_equal(first, law.at(*with_current)))


def _passive(geometry: Geometry, motion: Motion, fitted_effect: EffectValues) -> np.ndarray:
    """Motor torques (n,) for an effect in a joint without a motor."""
    effect = fitted_effect.instance.effect
    if not isinstance(effect, PassiveEffect):
        raise TypeError(effect.name)
    rates, torque = effect.with_rates(geometry, motion, fitted_effect.place)
    return np.asarray(torque[0] @ np.array(list(fitted_effect.values.values())) @ rates.jacobian[0])
