"""Dry friction of a joint without a motor that grows with the force in it."""

from dataclasses import dataclass

import numpy as np

from bench.effects.effect import Effect, EffectParameter
from bench.effects.passive_joint import passive_velocity, seen_by_motors
from bench.effects.signals import JointReaction, RobotSignals

MOST = 10.0  # times the force of the model: bound for the part of a mass on the axis
NOTHING = 1e-9  # of the largest force: a smaller one has no direction


@dataclass(frozen=True)
class PassiveLoadFriction(Effect):
    """Friction of a bearing in proportion to the force that it bears across its axis, carried to the motors.

    Linearised about mu and mum, the columns together give mu |F| (Euler's theorem for homogeneous functions). Friction
    and springs in joints without a motor, including its friction, also load the bearing: those of the present model
    count. Valid while the joint turns, for a force that the motion determines: not with redundant closures. Source:
    Rosyid and El-Khasawneh, "Identification of the dynamic parameters of a parallel kinematics mechanism with prismatic
    joints by considering varying friction", Applied Sciences 10(14), 2020 (friction as a coefficient times the normal
    force).
    """

    name = "passive_load_friction"
    law = (
        "τ = J_p' mu |F_p| sign(q̇_p): friction in a passive joint p in proportion to the force in it, carried to the "
        "motors by the loops."
    )
    symbols = (
        "mu: positive, N·m/N of a hinge (coefficient of friction times radius of the pin), N/N of a slide; F_p: force "
        "in N across the joint's axis, by the model: what the bodies beyond it need, and the loops that they close. "
        "mum = mu m: m is a mass on the joint's axis that the motors cannot tell from one on its other side, but the "
        "bearing can. q̇_p: velocity of the passive joint; J_p (1, n): its velocity for the motors' velocities."
    )
    shown_by = "carry a second payload, and move fast and slowly"
    seen = ("opposes", "load")
    in_key = ("is there at several motors at once, and grows with the load and with the acceleration", "")
    parameters = (
        EffectParameter("mu", "{effort}/N", positive=True),
        EffectParameter("mum", "{effort}*s^2/m"),
    )
    by_motor = True
    place = "bearing"
    depends_on_model = True
    every_sample = True
    bends = True

    mu: float = 0.0
    mum: float = 0.0

    def in_joint(self, robot: RobotSignals, joint: str) -> np.ndarray:
        """Torque or force (N, 1, 2) in the joint by mu and mum."""
        direction = np.sign(passive_velocity(robot, joint))
        reaction = robot.joint_reaction(joint, robot.every)
        force, of_mass, torques = reaction.force, reaction.of_mass, robot.in_joints()
        if torques:  # these jump when a joint reverses
            force, of_mass = robot.refined(force), robot.refined(of_mass)
        for other, torque in torques.items():
            force = force + np.einsum("kud,kd->ku", robot.refined(reaction.by_torque(other)), torque)
        whole = force + self._mass(reaction) * of_mass
        size = np.linalg.norm(whole, axis=1, keepdims=True)
        along = whole / np.maximum(size, NOTHING * max(float(size.max()), np.finfo(float).tiny))
        parts = np.column_stack([(along * part).sum(axis=1) for part in (force, of_mass)])
        if not torques:
            parts = robot.refined(parts)
        return np.asarray(parts * direction[:, None])[:, None]

    def columns(self, robot: RobotSignals, joint: str) -> np.ndarray:
        torque = self.in_joint(robot, joint)[:, 0]
        return np.stack([seen_by_motors(robot, joint, column) for column in torque.T], axis=2)

    def _mass(self, reaction: JointReaction) -> float:
        """kg on the axis; that of bars as long as no friction determines it."""
        if not self.mu > 0.0:
            return reaction.mass
        largest = float(np.linalg.norm(reaction.of_mass))
        if not largest > 0.0:
            return 0.0
        most = MOST * float(np.linalg.norm(reaction.force)) / largest
        return float(np.clip(self.mum / self.mu, -most, most))
