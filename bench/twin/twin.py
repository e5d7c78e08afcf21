"""The exported robot in MuJoCo with the effects that its MJCF cannot represent."""

from collections.abc import Mapping, Sequence
from copy import deepcopy
from dataclasses import dataclass
from pathlib import Path

import mujoco
import numpy as np

from bench.basics.errors import BenchError
from bench.dataset.home_qpos import home_qpos
from bench.effects.laws.platform_force import PlatformForce
from bench.twin.drive import DriveLaw, drive_law_of
from bench.twin.file import STEPS_TO_STICK, STIFF, TwinFile, load_twin_file
from bench.twin.laws import Instant, JointLaw, joint_law_of


@dataclass(frozen=True)
class TwinMotor:
    """A motor with its indices in MuJoCo's arrays and its effects. dry: the dry friction in the MJCF, N*m or N."""

    actuator: int
    qpos: int
    dof: int
    dry: float
    joint_laws: tuple[JointLaw, ...]
    drive_laws: tuple[DriveLaw, ...]


@dataclass(frozen=True)
class ToolForce:
    """F0 - K p at the tool, p its displacement from home; N, N/m and m, in world axes."""

    site: int
    home: np.ndarray
    force: np.ndarray
    stiffness: np.ndarray


class Twin:
    """A simulated robot whose inputs are the current references of its drives.

    model, data: MuJoCo's, which may be read, rendered and changed as usual. joints: of the motors, in the order of the
    currents. left_out: effects that cannot be simulated this way.
    """

    def __init__(self, model: mujoco.MjModel, file: TwinFile) -> None:
        self.model = model
        self.data = mujoco.MjData(model)
        self.joints = tuple(motor.joint for motor in file.motors)
        self._tool: ToolForce | None = None
        self._initial, self.left_out = self._placed(file)
        self._applied = np.zeros(model.nv)
        self.reset()

    @property
    def positions(self) -> np.ndarray:
        """Positions of the driven joints (n,), rad or m."""
        return self.data.qpos[[motor.qpos for motor in self._motors]]

    @property
    def velocities(self) -> np.ndarray:
        """Velocities of the driven joints (n,), rad/s or m/s."""
        return self.data.qvel[[motor.dof for motor in self._motors]]

    @property
    def dofs(self) -> np.ndarray:
        """Indices of the driven joints in MuJoCo's velocities (n,)."""
        return np.array([motor.dof for motor in self._motors])

    @property
    def actuators(self) -> np.ndarray:
        """Indices of the motors in MuJoCo's controls (n,)."""
        return np.array([motor.actuator for motor in self._motors])

    def reset(self) -> None:
        """Return to the home position, at rest, at time zero, with the effects in their initial state."""
        if self.model.nkey and mujoco.mj_name2id(self.model, mujoco.mjtObj.mjOBJ_KEY, "home") >= 0:
            mujoco.mj_resetDataKeyframe(self.model, self.data, self.model.key("home").id)
        else:
            mujoco.mj_resetData(self.model, self.data)
        self._applied[:] = 0.0
        self._motors = deepcopy(self._initial)

    def apply(self, currents: Sequence[float] | np.ndarray) -> None:
        """Set controls and applied forces for these current references (n,). Raises BenchError for another shape."""
        given = np.asarray(currents, dtype=float)
        if given.shape != (len(self._motors),):
            raise BenchError(
                f"{len(self._motors)} currents are needed ({', '.join(self.joints)}), not {given.shape}"
            )
        for motor, current in zip(self._motors, given.tolist(), strict=True):
            now = self._instant(motor, current)
            for law in motor.drive_laws:
                current = law(current, now)  # noqa: PLW2901 - one law after the other
            self.data.ctrl[motor.actuator] = current
        self.apply_forces(given)

    def apply_forces(self, currents: np.ndarray) -> None:
        """Set only the forces at the joints and at the tool; the caller sets the controls."""
        acting = np.zeros(self.model.nv)
        for motor, current in zip(self._motors, currents.tolist(), strict=True):
            dry, now = motor.dry, self._instant(motor, current)
            for law in motor.joint_laws:
                torque, friction = law.opposing(now)
                acting[motor.dof] -= torque
                dry += friction
            if motor.joint_laws:
                self.model.dof_frictionloss[motor.dof] = dry
        if self._tool is not None:
            acting += self._tool_force(self._tool)
        self.data.qfrc_applied += acting - self._applied
        self._applied[:] = acting

    def step(self, currents: Sequence[float] | np.ndarray) -> None:
        """Advance MuJoCo by one step with these current references (n,)."""
        self.apply(currents)
        mujoco.mj_step(self.model, self.data)

    def _instant(self, motor: TwinMotor, current: float) -> Instant:
        position, velocity = self.data.qpos[motor.qpos], self.data.qvel[motor.dof]
        return Instant(self.data.time, float(position), float(velocity), current)

    def _tool_force(self, tool: ToolForce) -> np.ndarray:
        jacobian = np.zeros((3, self.model.nv))
        mujoco.mj_jacSite(self.model, self.data, jacobian, None, tool.site)
        way = self.data.site_xpos[tool.site] - tool.home
        return np.asarray(jacobian.T @ (tool.force - tool.stiffness * way))

    def _placed(self, file: TwinFile) -> tuple[tuple[TwinMotor, ...], tuple[str, ...]]:
        """The motors with their effects, and the names of the omitted effects."""
        left_out = []
        joint_laws: dict[str, list[JointLaw]] = {joint: [] for joint in self.joints}
        drive_laws: dict[str, list[tuple[int, DriveLaw]]] = {joint: [] for joint in self.joints}
        gains = {motor.joint: motor.gain for motor in file.motors}
        for instance, values in file.effects:
            at = instance.joint
            if at in gains:
                rotates = int(self.model.joint(at).type[0]) == int(mujoco.mjtJoint.mjJNT_HINGE)
                if (law := joint_law_of(instance.effect, values, gains[at], rotates)) is not None:
                    joint_laws[at].append(law)
                    continue
                if (drive := drive_law_of(instance.effect, values, rotates)) is not None:
                    drive_laws[at].append(drive)
                    continue
            elif isinstance(instance.effect, PlatformForce) and file.tool is not None:
                self._tool = self._force_at(file.tool, values)
                continue
            left_out.append(f"{instance.name} at {at}" if at else instance.name)
        motors = []
        for motor in file.motors:
            joint = self.model.joint(motor.joint)
            dof = int(joint.dofadr[0])
            if joint_laws[motor.joint]:
                self.model.dof_solref[dof] = [STEPS_TO_STICK * self.model.opt.timestep, 1.0]
                self.model.dof_solimp[dof] = STIFF
            motors.append(
                TwinMotor(
                    self.model.actuator(motor.actuator).id,
                    int(joint.qposadr[0]),
                    dof,
                    float(self.model.dof_frictionloss[dof]),
                    tuple(joint_laws[motor.joint]),
                    tuple(law for _, law in sorted(drive_laws[motor.joint], key=lambda ranked: ranked[0])),
                )
            )
        return tuple(motors), tuple(left_out)

    def _force_at(self, tool: str, values: Mapping[str, float]) -> ToolForce:
        home = mujoco.MjData(self.model)
        home.qpos[:] = home_qpos(self.model)
        mujoco.mj_kinematics(self.model, home)
        site = self.model.site(tool).id
        force, stiffness = (np.array([values[f"{name}{axis}"] for axis in "xyz"]) for name in "Fk")
        return ToolForce(site, home.site_xpos[site].copy(), force, stiffness)


def load_twin(mjcf: str | Path, *, partial: bool = False) -> Twin:
    """The twin of an exported MJCF, with the effects of NAME.twin.json next to it.

    Raises BenchError if an effect cannot be simulated, unless `partial`: then `Twin.left_out` names it.
    """
    mjcf = Path(mjcf)
    file = load_twin_file(mjcf)
    try:
        model = mujoco.MjModel.from_xml_path(str(mjcf))
        twin = Twin(model, file)
    except (ValueError, KeyError) as error:
        raise BenchError(f"{mjcf}: {' '.join(str(error).split())}") from None
    if twin.left_out and not partial:
        raise BenchError(
            f"{file.path}: no simulation of this kind holds {', '.join(twin.left_out)}; partial=True leaves them out"
        )
    return twin
