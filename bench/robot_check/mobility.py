"""Degrees of freedom of the closed robot, whether the motors hold all of them, and how well."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from bench.basics.errors import BenchError
from bench.model.base import BaseParameters
from bench.model.bounds import RANKS
from bench.model.geometry import Geometry
from bench.model.mobility import SingularHomeError, column_scales, scaled_jacobians, smallest_singular_values
from bench.model.mobility import check_mobility as require_mobility
from bench.model.regressor import rotor_columns
from bench.model.spin import idle_spins
from bench.robot_check.bounds import PLAUSIBLE
from bench.robot_check.couplings import equation_of
from bench.robot_check.home import closed_pose, file_qpos
from bench.robot_check.outcome import Check, CheckCode
from bench.robot_check.range_words import home_key
from bench.robot_check.report import Amplification, Mobility, RobotReport

AXES = ("x", "y", "z", "turning about x", "turning about y", "turning about z")


def component_names(geometry: Geometry) -> tuple[str, ...]:
    """The name of every velocity of the tree, (nv,)."""
    names: list[str] = []
    for joint in geometry.joints:
        axes = AXES if joint.kind == "free" else AXES[3:]
        names += [joint.name] if joint.kind in ("hinge", "slide") else [f"{joint.name} ({a})" for a in axes]
    return tuple(names)


def mobility_of(geometry: Geometry, q: np.ndarray) -> Mobility:
    """Count velocities, equations and their rank, the largest over the poses q (N, nq)."""
    spins = len(idle_spins(geometry))
    equations = sum(loop.size for loop in geometry.loops) + len(geometry.couplings)
    rank = 0
    if equations:
        values = np.linalg.svd(scaled_jacobians(geometry, q)[:, :equations], compute_uv=False)
        rank = int((values > RANKS.dependent * values.max(axis=1, keepdims=True)).sum(axis=1).max())
    return Mobility(geometry.nv, equations, rank, len(geometry.active), spins)


def check_mobility(geometry: Geometry, mobility: Mobility) -> Check:
    """Whether there are as many degrees of freedom as motors, every passive joint is held, and home is regular."""
    try:
        require_mobility(geometry)
    except BenchError as error:
        fault = str(error).removeprefix(f"robot {geometry.robot.name}: ")
        if isinstance(error, SingularHomeError):
            pose = closed_pose(geometry)
            if pose is not None and smallest_singular_values(geometry, pose[None])[0] > PLAUSIBLE.regular:
                fault += f", for example {home_key(file_qpos(geometry, pose))}"
        return Check(CheckCode.MOBILITY_FAULT, "failed", {"fault": fault})
    return Check(
        CheckCode.MOBILITY,
        "ok" if mobility.remaining == mobility.motors else "failed",
        {
            **{name: getattr(mobility, name) for name in ("tree", "rank", "spins", "remaining", "motors")},
            "redundant": [actuator.joint for actuator in geometry.robot.redundant],
        },
    )


def couplings_and_spins(geometry: Geometry) -> Iterator[Check]:
    """The couplings, and a note on the rods that can spin between their ball joints."""
    for coupling in geometry.couplings:
        yield Check(CheckCode.COUPLING, "ok", equation_of(geometry, coupling))
    bodies = [geometry.joints[spin.joint].body for spin in idle_spins(geometry)]
    if bodies:
        yield Check(CheckCode.ROD_SPINS, "note", {"bodies": bodies})


def weakest_joints(geometry: Geometry, q: np.ndarray) -> tuple[str, ...]:
    """Passive joints that take part in the least constrained motion at q (nq,), with the motors held."""
    _, _, motions = np.linalg.svd(scaled_jacobians(geometry, q[None])[0][:, geometry.passive])
    weakest = np.abs(motions[-1])
    moving = set(geometry.passive[weakest > RANKS.takes_part * weakest.max()].tolist())
    return tuple(joint.name for joint in geometry.joints if moving & set(range(joint.v.start, joint.v.stop)))


def amplification(geometry: Geometry, q: np.ndarray) -> Amplification:
    """Largest passive speed for a unit speed of one motor at q (nq,); compared in dimensionless form."""
    passive, active = geometry.passive, geometry.active
    jacobian = scaled_jacobians(geometry, q[None])[0]
    speeds = -np.linalg.lstsq(jacobian[:, passive], jacobian[:, active], rcond=None)[0]
    row, column = np.unravel_index(int(np.argmax(np.abs(speeds))), speeds.shape)
    scales = column_scales(geometry)
    moved, mover = int(passive[row]), int(active[column])
    units = [("rad", "m")[int(_is_length(geometry, v))] for v in (moved, mover)]
    value = abs(float(speeds[row, column])) * float(scales[moved] / scales[mover])
    names = component_names(geometry)
    return Amplification(value, f"{units[0]}/{units[1]}", names[moved], names[mover])


def _is_length(geometry: Geometry, v: int) -> bool:
    joint = geometry.joint_at(v)
    return joint.kind == "slide" or (joint.kind == "free" and v < joint.v.start + 3)


def check_rotors(geometry: Geometry, base: BaseParameters) -> Check:
    """Which rotor inertias are separate base parameters, and which are part of a body's inertia."""
    kept = set(base.columns.tolist())
    identified: list[str] = []
    within_bodies: list[str] = []
    for joint, column in zip(geometry.robot.driven, rotor_columns(geometry).tolist(), strict=True):
        (identified if column in kept else within_bodies).append(joint)
    return Check(CheckCode.ROTOR_INERTIA, "ok", {"identified": identified, "within_bodies": within_bodies})


def with_tilts(report: RobotReport, geometry: Geometry) -> RobotReport:
    """The report with the most tilted pair of nearly parallel hinges, if any.

    It is a note; it is a failure, put before the first one, if something else fails, or if closures make a motor
    redundant, since such a tilt can remove degrees of freedom. It is the reason for loose poses, and replaces them.
    """
    widest = max(_tilts(geometry), key=lambda tilt: tilt[2], default=None) if geometry.closed else None
    if widest is None:
        return report
    first, second, angle = widest
    values = {"first": first, "second": second, "angle": angle}
    if not report.failures and not geometry.robot.redundant:
        return replace(report, checks=(*report.checks, Check(CheckCode.NEARLY_PARALLEL, "note", values)))
    at = report.checks.index(report.failures[0]) if report.failures else len(report.checks)
    tilted = Check(CheckCode.NEARLY_PARALLEL, "failed", values)
    rest = (check for check in report.checks[at:] if check.code is not CheckCode.POSES_LOOSE)
    return replace(report, checks=(*report.checks[:at], tilted, *rest))


def _tilts(geometry: Geometry) -> Iterator[tuple[str, str, float]]:
    """Pairs of hinges with nearly parallel axes and their angle, rad; one on the other or both on one body, so that the
    angle is the same in all poses.
    """
    hinges = [(index, joint) for index, joint in enumerate(geometry.joints) if joint.kind == "hinge"]
    for place, (_, joint) in enumerate(hinges):
        for other_index, other in hinges[:place]:
            if joint.parent not in (other_index, other.parent):
                continue
            on_it = joint.parent == other_index
            axes = [joint.placement.rotation @ joint.axis]
            axes.append(other.axis if on_it else other.placement.rotation @ other.axis)
            angle = float(np.linalg.norm(np.cross(*axes)))
            if PLAUSIBLE.rounded_tilt < angle < PLAUSIBLE.meant_tilt:
                yield other.name, joint.name, angle
