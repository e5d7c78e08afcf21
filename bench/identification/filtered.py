"""A recording before decimation: filtered, differentiated, loops closed."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from math import tau

import numpy as np

from bench.basics.errors import BenchError
from bench.basics.joint_units import joint_units
from bench.dataset.recording import Recording, position_column, velocity_column
from bench.effects.row_cache import KeptRows
from bench.identification.closes_otherwise import closes_otherwise
from bench.identification.decision import RULE
from bench.identification.finding import Code, Finding
from bench.identification.standstill import Gaps, no_gaps, standstills
from bench.identification.tolerances import TOLERANCES
from bench.model.geometry import Geometry, Joint
from bench.model.model import IdentificationModel
from bench.model.motion import LongMotion, Motion, path_of
from bench.model.nodes import of_recording
from bench.model.reaction import HeldMotion
from bench.signals.filtering import low_pass
from bench.signals.processing import LoggedVelocity, compared_velocity, estimate_motion, trim
from bench.signals.settings import FilterSettings, signal_bands


def logged_velocities(
    recording: Recording, joints: Sequence[str], settings: FilterSettings
) -> dict[str, LoggedVelocity]:
    """How logged velocities of a recording compare with its positions, by joint."""
    compared = {}
    for j, joint in enumerate(joints):
        velocity = recording.extra.get(velocity_column(joint))
        if velocity is None or not np.all(np.isfinite(velocity)) or not np.any(velocity):
            continue
        compared[joint] = compared_velocity(recording.position[:, j], velocity, recording.rate, settings)
    return compared


def taken_velocities(
    recording: Recording, joints: Sequence[str], compared: Mapping[str, LoggedVelocity]
) -> np.ndarray | None:
    """The logged velocities (N, n) that are used, NaN for the other joints; None if there are none."""
    taken = [joint for joint, velocity in compared.items() if velocity.taken]
    if not taken:
        return None
    velocities = np.full(recording.position.shape, np.nan)
    for joint in taken:
        velocities[:, list(joints).index(joint)] = recording.extra[velocity_column(joint)]
    return velocities


def velocity_noise(joints: Sequence[str], compared: Mapping[str, LoggedVelocity]) -> np.ndarray:
    """Noise density (n,) of every velocity that is used, unit^2/s^2/Hz; infinite for the others."""
    return np.array(
        [
            compared[joint].density if joint in compared and compared[joint].taken else np.inf
            for joint in joints
        ]
    )


@dataclass(frozen=True)
class Measured:
    """One recording at its rate, N samples of n motors, border samples dropped.

    time (N,) s; position, velocity, acceleration (N, n): rad or m and rates, filtered; current (N, n) drive unit, as
    logged; tree: the motion of all joints of the opened tree; gaps: where joints are at rest. logged: how logged
    velocities compare with the positions. Caches. kept: rows of effects that need no model; perturbed: observation
    matrices of other motions and gravities, which recur; reshaped: of other geometries, of which a search tries many;
    reactions: of joint forces; held: the motion of these, by sample spacing; few: motion and regressor at coarse ones,
    as measured and of the last changed machine, by its key.
    """

    recording: Recording
    settings: FilterSettings
    time: np.ndarray
    position: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray
    current: np.ndarray
    tree: Motion
    gaps: Gaps
    logged: Mapping[str, LoggedVelocity] = field(default_factory=dict)
    kept: KeptRows = field(default_factory=KeptRows, compare=False, repr=False)
    perturbed: KeptRows = field(default_factory=KeptRows, compare=False, repr=False)
    reshaped: KeptRows = field(default_factory=KeptRows, compare=False, repr=False)
    reactions: KeptRows = field(
        default_factory=lambda: KeptRows(TOLERANCES.memory.force_bytes), compare=False, repr=False
    )
    held: dict[int, HeldMotion] = field(default_factory=dict, compare=False, repr=False)
    few: dict[bytes, tuple[Motion, np.ndarray]] = field(default_factory=dict, compare=False, repr=False)

    @property
    def redundant(self) -> np.ndarray:
        """Current of the redundant motors (N, r), drive unit, as logged."""
        if self.recording.redundant is None:
            return np.zeros((len(self.time), 0))
        return trim(self.recording.redundant, self.settings)


def measure(model: IdentificationModel, recording: Recording, settings: FilterSettings) -> Measured:
    """Filter and differentiate the positions, use logged velocities that are better, and close the loops.

    Raises BenchError that names the recording and the time of a sample that cannot be used.
    """
    joints = model.geometry.robot.joints
    logged = logged_velocities(recording, joints, settings)
    taken = taken_velocities(recording, joints, logged)
    motion = estimate_motion(recording.position, recording.rate, settings, taken)
    time = trim(recording.time, settings)
    track = time, motion.position, motion.velocity, motion.acceleration
    try:
        tree, passive = _closed(model.geometry, track)
    except BenchError as error:
        otherwise = closes_otherwise(model.geometry, *track)
        raise of_recording(recording.name, type(error)(f"{error}{otherwise}")) from None
    return Measured(
        recording=recording,
        settings=settings,
        time=time,
        position=motion.position,
        velocity=motion.velocity,
        acceleration=motion.acceleration,
        current=trim(recording.current, settings),
        tree=tree,
        gaps=no_gaps(motion.velocity.shape[1])
        if settings.keep_standstill
        else standstills(motion.position, motion.velocity, passive, recording.rate, settings.position_cutoff),
        logged=logged,
    )


def _closed(
    geometry: Geometry, track: tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]
) -> tuple[Motion, np.ndarray]:
    """The motion of all joints, if long computed on demand; rates (N, k) of passive joints."""
    path = path_of(geometry, *track)
    numbers = len(track[0]) * (geometry.nq + geometry.nv * (2 + len(geometry.active)))
    if numbers > TOLERANCES.memory.motion_numbers:
        return LongMotion(path), path.rates(_passive(geometry))
    tree = path.motion(slice(None))
    rates = passive_rates(geometry, tree)
    return (tree if numbers <= TOLERANCES.memory.lasting_numbers else LongMotion(path, tree)), rates


def forget_motions(measured: Sequence[Measured]) -> None:
    """Free the memory of long motions of all joints, and of what follows from them and effects use once per model; if
    needed again, it is computed again, bit by bit the same.
    """
    for entry in measured:
        if isinstance(entry.tree, LongMotion):
            entry.tree.forget()
            entry.held.clear()
            entry.few.clear()
            for rows in (entry.perturbed, entry.reshaped, entry.reactions):
                rows.forget()


def passive_rates(geometry: Geometry, tree: Motion) -> np.ndarray:
    """Velocities (N, k) of the hinges and slides without a motor, rad/s or m/s."""
    return np.asarray(tree.v[:, _passive(geometry)])


def _passive(geometry: Geometry) -> list[int]:
    """Velocity indices in the tree of these joints."""
    return [
        joint.v.start
        for joint in geometry.joints
        if joint.kind in ("hinge", "slide") and joint.v.start not in geometry.active
    ]


def contradicted_closures(geometry: Geometry, measured: Sequence[Measured]) -> tuple[Finding, ...]:
    """Joints of redundant motors whose logged position contradicts the loop closures, each with its worst recording.

    Reported if the difference, filtered like the positions, exceeds encoder noise and tolerances. Joints without a
    position in a recording are skipped.
    """
    findings = []
    for actuator in geometry.robot.redundant:
        joint = geometry.joints[geometry.joint_index(actuator.joint)]
        logged = [
            measurement
            for measurement in measured
            if position_column(actuator.joint) in measurement.recording.extra
        ]
        each = [_contradiction(joint, measurement) for measurement in logged]
        clear = [finding for finding in each if finding is not None]
        if clear:
            findings.append(max(clear, key=lambda finding: finding.numbers["difference"]))
    return tuple(findings)


def _contradiction(joint: Joint, measured: Measured) -> Finding | None:
    recording, settings = measured.recording, measured.settings
    logged = recording.extra[position_column(joint.name)]
    filtered = low_pass(logged, recording.rate, settings.position_cutoff, settings.filter_order)
    closed = measured.tree.q[:, joint.q.start] + joint.offset
    difference = trim(filtered, settings) - closed
    if joint.kind != "slide":
        difference = difference - tau * np.round(np.median(difference) / tau)
    size, travel = float(np.sqrt((difference**2).mean())), float(np.ptp(closed))
    if size <= max(
        TOLERANCES.findings.closure_error * travel, RULE.certain * _noise(joint, measured, logged)
    ):
        return None
    return Finding(
        Code.CLOSURE_CONTRADICTED,
        (joint.name, recording.name),
        numbers={"difference": size, "mean": float(difference.mean()), "travel": travel},
        unit=joint_units(joint.kind != "slide").position,
    )


def _noise(joint: Joint, measured: Measured, logged: np.ndarray) -> float:
    """RMS noise that passes the filter, of this encoder and, through the closures, of the others."""
    recording = measured.recording
    positions = np.column_stack((recording.position, logged))
    density = signal_bands([positions], [recording.current], recording.rate).position_noise
    follow = (measured.tree.jacobian[:, joint.v.start] ** 2).mean(axis=0)
    return float(np.sqrt((follow @ density[:-1] + density[-1]) * measured.settings.position_cutoff))
