"""The machine to simulate: the robot's MJCF with motors, a joint controller, a payload and hidden effects."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

from bench.basics.errors import BenchError
from bench.basics.files.toml_input import one_line
from bench.dataset.home_qpos import home_qpos
from bench.dataset.mjcf_neutral import keep_masses, neutral
from bench.dataset.payload import Payload, inertia_matrix
from bench.dataset.robot import Robot
from bench.scenario.scenario import Scenario, payload_truth, per_joint
from bench.scenario.tables import Controller, PayloadTable
from bench.truth.assembly import Indices, felt_inertia
from bench.truth.balls import ball_joints, refuse_too_light
from bench.truth.hidden.base import (
    LAWS,
    PAYLOAD_BODY,
    Draft,
    HiddenEffect,
    JointEffect,
    harden_friction,
    has_law,
)
from bench.truth.hidden.entries import hidden_effects
from bench.truth.hidden.laws.encoder_offset import EncoderOffset
from bench.truth.streams import stream

Array = NDArray[np.float64]

LOOP_SOFTNESS = 0.002  # s: time constant of a closure constraint; gaps of 0.02 to 0.7 µm for a small robot
CLOSING = (
    mujoco.mjtEq.mjEQ_CONNECT,
    mujoco.mjtEq.mjEQ_WELD,
    mujoco.mjtEq.mjEQ_JOINT,
    mujoco.mjtEq.mjEQ_TENDON,
)
ACTING = ("gravity", "wind", "magnetic", "density", "viscosity")  # options of the file that are kept
ROBOT_SWITCHES = sum(
    int(flag)
    for flag in (
        mujoco.mjtDisableBit.mjDSBL_LIMIT,
        mujoco.mjtDisableBit.mjDSBL_CONSTRAINT,
        mujoco.mjtDisableBit.mjDSBL_EQUALITY,
        mujoco.mjtDisableBit.mjDSBL_GRAVITY,
    )
)
RIGID = (0.9999, 0.99999, 0.001, 0.5, 2.0)  # solimp: almost no compliance
SOFTEST = 1e3  # over the mass of the machine: largest inverse weight of a body in a closure
SOFTEST_TURN = 10.0  # the same for rotation, over that mass times the square of its longest link
SOFTEST_SIDE = 100.0  # largest inverse weight of a coupling's lighter side over that of the heavier one
LIGHTEST, SMALLEST = 1e-6, 1e-3  # kg, m: least mass and size assumed for a machine


@dataclass(frozen=True, eq=False)
class Drive:
    """Motors and joint controller, arrays (n,).

    force = true gain · i, i = (kp (q_ref − q) + kv (q̇_ref − q̇) + ff) / nominal gain, ff = feedforward · q̈_ref. q
    is the encoder reading: the position of the motors plus offset.
    kp: N·m/rad, kv: N·m·s/rad, feedforward: kg·m², or N/m, N·s/m, kg for a slide.
    """

    nominal_gains: Array
    true_gains: Array
    kp: Array
    kv: Array
    feedforward: Array
    offset: Array
    """Of the encoders, rad or m."""

    @property
    def ratio(self) -> Array:
        """True over nominal gain."""
        return self.true_gains / self.nominal_gains

    def command(self, q: Array, qd: Array, qdd: Array) -> Array:
        """The controller's command for a reference (…, n), N·m or N, without feedback.

        At every step, kp · (position of the motors) and kv · velocity are subtracted from it.
        """
        return self.kp * (q - self.offset) + self.kv * qd + self.feedforward * qdd


@dataclass(frozen=True, eq=False)
class Machine:
    """A compiled machine; the models differ only in the payload and have the same layout."""

    robot: Robot
    models: Mapping[str | None, mujoco.MjModel]
    """Models by payload name; None is the machine without payload."""
    drive: Drive
    payloads: Mapping[str, Payload]
    """The true payloads."""
    hidden: tuple[HiddenEffect, ...]
    laws: bool
    """Whether some effect has a law that is evaluated at every step, which then also sets the forces of the motors."""
    home: Array
    """qpos (nq,) of the keyframe `home`."""
    inertia: Array
    """Effective inertia (n,) at the actuated joints in `home`, loops closed, without hidden effects; kg·m² or kg."""
    addresses: Indices
    """Indices into qpos of the actuated joints (n,), those of redundant motors last."""
    dofs: Indices
    """Indices into qvel of the actuated joints (n,)."""
    motor_addresses: Indices
    """Indices into qpos of the coordinates that the motors turn and the encoders measure: the rotor for an actuated
    joint with a spring or play in its drive, otherwise the joint itself.
    """
    motor_dofs: Indices
    """The same in qvel."""

    @property
    def leading(self) -> int:
        """Number of the actuated joints that move independently; they come first."""
        return len(self.robot.joints)


def build_machine(scenario: Scenario) -> Machine:
    """The machine of a scenario.

    Raises BenchError for an unknown effect or joint, and for a model that MuJoCo refuses.
    """
    try:
        return _built(scenario)
    except BenchError as error:
        raise BenchError(f"scenario {scenario.name}: {error}") from error


def _built(scenario: Scenario) -> Machine:
    robot, settings = scenario.robot, scenario.settings
    rigid = _rigid_spec(robot, settings.step)
    plain = _compiled(rigid.copy(), robot)
    dofs = np.array([plain.joint(joint).dofadr[0] for joint in robot.driven])
    home = home_qpos(robot.mjcf_model())
    inertia = felt_inertia(plain, home, dofs, len(robot.joints))
    hidden = hidden_effects(settings.hidden, robot.driven, plain)
    laws = _rubbing_ball(plain, hidden) or any(has_law(effect, law) for effect in hidden for law in LAWS)
    drive = _drive(robot, settings.controller, true_gains(scenario), inertia, _encoder_offset(hidden, robot))
    payloads = {name: _true_payload(name, table, hidden) for name, table in settings.payloads.items()}
    models: dict[str | None, mujoco.MjModel] = {}
    for name in (None, *payloads):
        draft = Draft(
            rigid.copy(),
            robot,
            plain,
            home,
            dict(zip(robot.driven, inertia.tolist(), strict=True)),
            tuple(payloads),
        )
        for effect in hidden:
            if effect.changes_drives:
                effect.change(draft)
        _add_motors(draft, drive, laws)
        for effect in hidden:
            if not effect.changes_drives:
                effect.change(draft)
        if payloads:
            _add_payload(draft, None if name is None else payloads[name])
        models[name] = _compiled(draft.spec, robot)
        for effect in hidden:
            effect.adjust(models[name], draft)
        _harden_loops(models[name])
        refuse_too_light(models[name], np.append(home, np.zeros(models[name].nq - len(home))))
    model = models[None]
    ends = [draft.motor_side(joint).name for joint in robot.driven]
    addresses, motor_addresses = (
        np.array([model.joint(joint).qposadr[0] for joint in side]) for side in (robot.driven, ends)
    )
    motor_dofs = np.array([model.joint(joint).dofadr[0] for joint in ends])
    return Machine(
        robot,
        models,
        drive,
        payloads,
        hidden,
        laws,
        home,
        inertia,
        addresses,
        dofs,
        motor_addresses,
        motor_dofs,
    )


def _rubbing_ball(plain: mujoco.MjModel, hidden: Sequence[HiddenEffect]) -> bool:
    """Whether a ball joint may have dry friction, from the file or from a hidden effect."""
    balls = ball_joints(plain)
    names = [name for name, _ in balls]
    return any(np.any(plain.dof_frictionloss[dofs]) for _, dofs in balls) or any(
        isinstance(effect, JointEffect) and effect.joint in names for effect in hidden
    )


def true_gains(scenario: Scenario) -> Array:
    """The true drive gains (n,) of a scenario, in the units of the robot's gains."""
    robot, gains = scenario.robot, scenario.settings.gains
    nominal = nominal_gains(robot)
    if gains.true is not None:
        return per_joint(gains.true, robot.driven)
    if gains.error_within is not None:
        draws = [stream(scenario.settings.seed, "gain", joint).uniform(-1, 1) for joint in robot.driven]
        return nominal * (1 + gains.error_within * np.array(draws))
    return nominal * (1 + per_joint(gains.error or 0.0, robot.driven))


def nominal_gains(robot: Robot) -> Array:
    """Nominal drive gains of all motors (n,), redundant ones last."""
    return np.array([motor.gain for motor in robot.motors])


def _rigid_spec(robot: Robot, step: float) -> mujoco.MjSpec:
    """The robot's MJCF without actuators, sensors and keyframes, set up for explicit integration and rigid loops."""
    spec = robot.mjcf_spec()
    for extra in (*spec.actuators, *spec.sensors, *spec.keys):
        spec.delete(extra)
    spec.compiler.fusestatic = False
    keep_masses(spec)
    _set_options(spec)
    option = spec.option
    option.timestep = step
    # explicit, so that every force is evaluated at the logged velocity
    option.integrator = mujoco.mjtIntegrator.mjINT_EULER
    option.disableflags |= mujoco.mjtDisableBit.mjDSBL_EULERDAMP | mujoco.mjtDisableBit.mjDSBL_CONTACT
    option.solver = mujoco.mjtSolver.mjSOL_NEWTON
    option.jacobian = mujoco.mjtJacobian.mjJAC_DENSE  # the sparse Hessian of 4.0.0 is wrong
    option.iterations, option.tolerance = 100, 1e-12
    for equality in spec.equalities:
        if equality.type not in CLOSING:
            raise BenchError(
                f"{robot.model_path}: equality {equality.name!r}: "
                "only connect, weld, joint and tendon are supported"
            )
        equality.solref = [max(LOOP_SOFTNESS, 2 * step), 1.0]
        equality.solimp = RIGID
    for joint in spec.joints:
        joint.actfrclimited = False
        if joint.frictionloss > 0.0:
            harden_friction(joint, step)
    return spec


def _set_options(spec: mujoco.MjSpec) -> None:
    """Reset MuJoCo's options, except for physical ones and the switches that belong to the robot.

    Springs, dampers or friction that the file switches off are removed from its joints instead, since the switch
    would also affect those of hidden effects.
    """
    plain, off = mujoco.MjSpec(), int(spec.option.disableflags)
    option = plain.option
    for name in ACTING:
        setattr(option, name, getattr(spec.option, name))
    option.disableflags = off & ROBOT_SWITCHES
    spec.option = option
    spec.memory = -1
    for joint in spec.joints:
        if off & int(mujoco.mjtDisableBit.mjDSBL_SPRING):
            joint.stiffness = np.zeros(len(joint.stiffness))
        if off & int(mujoco.mjtDisableBit.mjDSBL_DAMPER):
            joint.damping = np.zeros(len(joint.damping))
        if off & int(mujoco.mjtDisableBit.mjDSBL_FRICTIONLOSS):
            joint.frictionloss = 0.0


def _harden_loops(model: mujoco.MjModel) -> None:
    """Scale the stiffness of closures to the mass of the machine, and of couplings to the heavier of their sides.

    In MuJoCo, a closure is softer the lighter its bodies are. A light frame or pin that transmits the forces of the
    machine to the ground, or the rotor of a belt, would yield by millimetres and hundredths of a radian.
    """
    weight = max(float(model.body_mass[1:].sum()), LIGHTEST)
    size = max(float(np.linalg.norm(model.body_pos[1:], axis=1).max()), SMALLEST)
    softest = np.array([SOFTEST / weight, SOFTEST_TURN / (weight * size**2)])  # 1/kg, 1/(kg·m²)
    for loop in range(model.neq):
        kind = mujoco.mjtEq(int(model.eq_type[loop]))
        ends = np.array([model.eq_obj1id[loop], model.eq_obj2id[loop]])
        if kind == mujoco.mjtEq.mjEQ_TENDON:
            _harden_coupling(model.tendon_invweight0, ends[ends >= 0])
        elif kind == mujoco.mjtEq.mjEQ_JOINT:
            dofs = model.jnt_dofadr[ends[ends >= 0]]
            if not model.dof_frictionloss[dofs].any():  # the friction constraint uses the same inverse weight
                _harden_coupling(model.dof_invweight0, dofs)
        else:
            by_site = int(model.eq_objtype[loop]) == int(mujoco.mjtObj.mjOBJ_SITE)
            for body in model.site_bodyid[ends] if by_site else ends:
                model.body_invweight0[body] = np.minimum(model.body_invweight0[body], softest)


def _harden_coupling(mobility: Array, sides: Indices) -> None:
    """Limit the inverse weight of the lighter side of a coupling to SOFTEST_SIDE times that of the heavier one."""
    mobility[sides] = np.minimum(mobility[sides], SOFTEST_SIDE * mobility[sides].min())


def _compiled(spec: mujoco.MjSpec, robot: Robot) -> mujoco.MjModel:
    try:
        return spec.compile()
    except ValueError as error:
        raise BenchError(
            f"{robot.model_path}: MuJoCo cannot compile the machine: {one_line(error)}"
        ) from error


def _encoder_offset(hidden: Sequence[HiddenEffect], robot: Robot) -> Array:
    """Constant offsets (n,) of the encoders, rad or m."""
    offset = np.zeros(len(robot.driven))
    for effect in hidden:
        if isinstance(effect, EncoderOffset):
            offset[robot.driven.index(effect.joint)] += effect.offset
    return offset


def _true_payload(name: str, table: PayloadTable, hidden: Sequence[HiddenEffect]) -> Payload:
    payload = payload_truth(name, table)
    for effect in hidden:
        payload = effect.weigh(payload)
    return payload


def _drive(robot: Robot, controller: Controller, gains: Array, inertia: Array, offset: Array) -> Drive:
    """Gains of the controller and the motors. inertia: effective inertia (n,) at each actuated joint in the home
    pose.
    """
    joints = robot.driven
    if controller.kp is not None and controller.kv is not None:
        kp, kv = per_joint(controller.kp, joints), per_joint(controller.kv, joints)
    else:
        omega = 2 * np.pi * per_joint(controller.natural_frequency, joints)
        kp = inertia * omega**2
        kv = 2 * per_joint(controller.damping, joints) * inertia * omega
    feedforward = inertia if controller.feedforward == "acceleration" else np.zeros(len(joints))
    return Drive(nominal_gains(robot), gains, kp, kv, feedforward, offset)


def _add_motors(draft: Draft, drive: Drive, laws: bool) -> None:
    """Add an actuator for each driven joint, first in the model.

    With laws, the control is the force, which the laws set. Without laws, the force is that of the controller, ratio
    · (control − kp q − kv q̇), with `Drive.command` as control.
    """
    for i, joint in enumerate(draft.robot.driven):
        motor = draft.spec.add_actuator(neutral(), name=f"motor:{joint}", target=draft.motor_side(joint).name)
        motor.trntype = mujoco.mjtTrn.mjTRN_JOINT
        motor.gaintype = mujoco.mjtGain.mjGAIN_FIXED
        motor.biastype = mujoco.mjtBias.mjBIAS_AFFINE
        motor.gainprm[0] = 1.0 if laws else drive.ratio[i]
        motor.biasprm[1] = 0.0 if laws else -drive.ratio[i] * drive.kp[i]
        motor.biasprm[2] = 0.0 if laws else -drive.ratio[i] * drive.kv[i]


def _add_payload(draft: Draft, payload: Payload | None) -> None:
    """Add a body fixed in the tool frame; without a payload it has no mass, so that all models have the same layout."""
    robot = draft.robot
    site = draft.plain.site(robot.tool_site)
    parent = draft.spec.site(robot.tool_site).parent
    if parent.name == "world":
        raise BenchError(
            f"{robot.model_path}: the tool site {robot.tool_site!r} does not move with the robot"
        )
    body = parent.add_body(name=PAYLOAD_BODY, pos=site.pos, quat=site.quat)
    body.explicitinertial = True
    body.mass, body.inertia = 0.0, np.zeros(3)
    if payload is None or payload.mass is None or payload.inertia is None:
        return
    moments, axes = np.linalg.eigh(inertia_matrix(payload.inertia))
    moments = np.maximum(moments, 0.0)
    moments[2] = min(moments[2], moments[0] + moments[1])  # rounding must not violate the triangle inequality
    quaternion = np.zeros(4)
    mujoco.mju_mat2Quat(quaternion, (axes * np.linalg.det(axes)).ravel())
    body.mass, body.inertia, body.iquat = payload.mass, moments, quaternion
    body.ipos = payload.center_of_mass
