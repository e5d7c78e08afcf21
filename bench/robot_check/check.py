"""All checks of a robot, in order; a check is omitted if an earlier failure makes it meaningless."""

from dataclasses import replace

import numpy as np

from bench.basics.errors import BenchError
from bench.dataset.robot import Robot
from bench.dataset.robot_locked import ROUNDED
from bench.dataset.robot_redundancy import welds_to_connect
from bench.model.base import base_parameters
from bench.model.bounds import CLOSURE
from bench.model.closure import loop_residual
from bench.model.cures import welds_as_connects
from bench.model.geometry import Geometry, read_geometry
from bench.model.mobility import check_assembled
from bench.model.passive_ranges import passive_ranges
from bench.model.states import LoosePosesError, random_motion
from bench.robot_check import agreement
from bench.robot_check.agreement import check_base_parameters
from bench.robot_check.bounds import AGREEMENT, PLAUSIBLE
from bench.robot_check.contacts import check_contacts
from bench.robot_check.features import check_features, locked_lines, notes
from bench.robot_check.home import check_home, home_at_range_end, with_pose_in_ranges
from bench.robot_check.loops import check_closed_motion, check_constraints
from bench.robot_check.machine import CheckedMachine, make_machine, random_open_poses
from bench.robot_check.mobility import (
    check_mobility,
    check_rotors,
    couplings_and_spins,
    mobility_of,
    with_tilts,
)
from bench.robot_check.outcome import Check, CheckCode, RangeLeft
from bench.robot_check.report import (
    RobotReport,
    Singularity,
    check_home_ranges,
    home_source,
    joint_lines,
    loop_lines,
)
from bench.robot_check.singularity import SingularitySweep, singularity_of, sweep

SEED, FRESH = 20120601, 20120605  # FRESH: of states from which nothing was chosen


def check_robot(robot: Robot) -> RobotReport:
    """Check a robot that `bench.dataset.robot.load_robot` has read; faults are in the report's `failures`."""
    compiled = robot.mjcf_model()
    features = check_features(compiled)
    checks = (features, *locked_lines(robot), *notes(compiled, robot))
    report = RobotReport(robot, joint_lines(compiled, robot), (), None, None, None, checks)
    try:
        geometry = read_geometry(robot)
    except BenchError as error:
        if features.verdict == "failed":
            return report
        return _with(report, Check(CheckCode.GEOMETRY_UNREADABLE, "failed", {"fault": str(error)}))
    machine = make_machine(geometry)
    report = replace(report, loops=loop_lines(machine))
    report = _with(report, *_same_tree(machine))
    at_home = check_home(geometry, report.loops, home_source(compiled, robot))
    ranges = check_home_ranges(report.joints)
    if at_home.verdict != "failed":
        ranges = with_pose_in_ranges(geometry, ranges)
    report = _with(report, *_welds_too_much(geometry), at_home, ranges)
    if not report.failures:
        report = _with(report, *home_at_range_end(geometry))
        report = _assembled(report, machine)
    return with_tilts(report, geometry)


def _welds_too_much(geometry: Geometry) -> list[Check]:
    """Welds where a connect was meant: their orientation is open at home (failed), or makes motors redundant (note)."""
    motors = [actuator.joint for actuator in geometry.robot.redundant]
    turned = welds_as_connects(
        geometry, loop_residual(geometry, geometry.home[:, None])[:, 0], CLOSURE.assembled
    )
    if turned is not None:
        return [Check(CheckCode.WELD_TOO_MUCH, "failed", {"welds": list(turned.names), "motors": motors})]
    welds = welds_to_connect(geometry.robot.mjcf_model(), geometry.robot.driven) if motors else ()
    return [Check(CheckCode.WELD_TOO_MUCH, "note", {"welds": list(welds), "motors": motors})] if welds else []


def _with(report: RobotReport, *checks: Check) -> RobotReport:
    return replace(report, checks=report.checks + checks)


def _same_tree(machine: CheckedMachine) -> list[Check]:
    """Checks that both libraries read the same opened tree."""
    poses = random_open_poses(machine.geometry, AGREEMENT.poses, SEED)
    velocities = np.random.default_rng(SEED).normal(size=(AGREEMENT.poses, machine.geometry.nv))
    listed = agreement.check_joint_list(machine)
    if listed.verdict == "failed":
        return [listed]
    return [
        listed,
        agreement.check_joint_motion(machine, poses),
        agreement.check_body_poses(machine, poses, "opened"),
        agreement.check_total_mass(machine),
        agreement.check_mass_matrix(machine, poses),
        agreement.check_bias_forces(machine, poses, velocities),
    ]


def _assembled(report: RobotReport, machine: CheckedMachine) -> RobotReport:
    """Add the checks of a robot whose loops are closed at home."""
    geometry = machine.geometry
    mobility = mobility_of(geometry, geometry.home[None])
    report = _with(replace(report, mobility=mobility), check_mobility(geometry, mobility))
    if report.failures:
        return report
    report = _with(report, *couplings_and_spins(geometry))
    try:
        check_assembled(geometry)
        swept = sweep(geometry) if geometry.closed else None
        motion = random_motion(geometry, AGREEMENT.poses, SEED)
        fresh = random_motion(geometry, AGREEMENT.poses, FRESH)
        base = base_parameters(geometry)
    except LoosePosesError:
        return _with(report, Check(CheckCode.POSES_LOOSE, "failed"))
    except BenchError as error:
        return _with(report, Check(CheckCode.MOTION_FAULT, "failed", {"fault": str(error)}))
    report = _with(replace(report, base=base), check_rotors(geometry, base))
    if swept is not None:
        singularity = singularity_of(geometry, swept)
        report = _with(replace(report, singularity=singularity), _regular_home(singularity))
        if singularity.singular_at is not None:
            values = {"positions": singularity.singular_at, "units": singularity.units}
            report = _with(report, Check(CheckCode.SINGULARITY_WITHIN_RANGES, "note", values))
        report = _with(report, *_passive_ranges(geometry, swept))
        report = _with(report, check_constraints(machine, motion.q), check_closed_motion(machine, motion))
    return _with(
        report,
        *check_contacts(geometry, motion.q if swept is None else np.vstack((motion.q, swept.q))),
        agreement.check_body_poses(machine, motion.q, "closed"),
        agreement.check_motor_forces(machine, motion),
        check_base_parameters(machine, base, fresh),
    )


def _regular_home(singularity: Singularity) -> Check:
    fastest = singularity.amplification
    values = {
        "singular_value": singularity.home,
        "passive": fastest.passive,
        "amplification": fastest.value,
        "unit": fastest.unit,
        "motor": fastest.motor,
    }
    if singularity.home < PLAUSIBLE.singular or fastest.value > CLOSURE.amplification:
        return Check(CheckCode.HOME_SINGULAR, "failed", values)
    if fastest.value > PLAUSIBLE.fast:
        return Check(CheckCode.HOME_NEAR_SINGULAR, "note", values)
    return Check(CheckCode.HOME_REGULAR, "ok", values)


def _passive_ranges(geometry: Geometry, swept: SingularitySweep) -> list[Check]:
    """A note on joints without an independent motor that leave their ranges while the motors stay within theirs."""
    redundant = {actuator.joint for actuator in geometry.robot.redundant}
    joints: list[RangeLeft] = []
    for limit in passive_ranges(geometry):
        at, lower = limit.at(swept.q), limit.low if np.isfinite(limit.low) else 0.0
        allowed = ROUNDED * (limit.high - lower)  # a rounding of its numbers
        if at.min() < limit.low - allowed or at.max() > limit.high + allowed:
            lowest, highest, lower, upper = (
                float(end) + limit.offset for end in (at.min(), at.max(), lower, limit.high)
            )
            travel: RangeLeft = {
                "joint": limit.joint,
                "redundant": limit.joint in redundant,
                "lowest": lowest,
                "highest": highest,
                "lower": lower,
                "upper": upper,
            }
            joints.append(travel)
    return [Check(CheckCode.PASSIVE_RANGE_LEFT, "note", {"joints": joints})] if joints else []
