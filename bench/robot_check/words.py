"""The results of a robot's checks as text: for each code what was checked, and a sentence from its values.

A template contains both, "what: sentence".
"""

import shlex
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from bench.basics.plural import plural
from bench.basics.sentence import say
from bench.dataset.robot_locked import locked_from_data, locked_in_words
from bench.dataset.robot_redundancy import use_connect
from bench.dataset.robot_toml import no_tool
from bench.model.cures import narrower_ranges
from bench.robot_check.bounds import PLAUSIBLE
from bench.robot_check.contact_words import geoms_touch
from bench.robot_check.outcome import Check, CheckCode
from bench.robot_check.range_words import (
    at_range_end,
    coupling_equation,
    home_key,
    outside_range,
    ranges_left,
    without_rounding,
)
from bench.robot_check.report import Singularity

TERMS = {  # of an MJCF's joint
    "stiffness": "spring (stiffness)",
    "damping": "damping",
    "frictionloss": "friction (frictionloss)",
    "armature": "rotor inertia (armature)",
}


def name_of(check: Check) -> str:
    """What was checked, in a word or two."""
    words = WORDS[check.code]
    name = words.partition(": ")[0] if isinstance(words, str) else words[0]
    return name.format(**check.values)


def detail_of(check: Check) -> str:
    """What was measured, or what is wrong and where."""
    words = WORDS[check.code]
    if not isinstance(words, str):
        return words[1](**check.values)
    sentence = words.partition(": ")[2]
    derived = {name: of(check.values) for name, of in DERIVED.items() if f"{{{name}}}" in sentence}
    return say(sentence, **check.values, **derived)


def nearest_singularity(singularity: Singularity) -> str:
    """Where the nearest singularity lies, as a sentence."""
    if singularity.singular_at is None:
        return (
            f"none within the joint ranges: over {singularity.poses} poses the smallest singular value stays "
            f"above {singularity.lowest:.2g}, lowest at {_positions(singularity.lowest_at, singularity.units)}"
        )
    travel = {
        name: value for name, value in (singularity.travel or {}).items() if abs(value) > PLAUSIBLE.still
    }
    return (
        f"{_positions(travel, singularity.units, '+')} from home, at "
        f"{_positions(singularity.singular_at, singularity.units)}: in that pose "
        f"{_first(singularity.loose)} can move while the motors are held"
    )


def _unsupported(features: Sequence[str]) -> str:
    others = features[1:]
    return "".join(features[:1]) + (f" (and {len(others)} more: {'; '.join(others)})" if others else "")


def _files_left_out(files: Sequence[str], bodies: Sequence[str]) -> str:
    said = (
        f"{plural(len(files), 'file')} of meshes or textures cannot be read ({_first(files)}): read without them, as "
        "identification needs no shapes"
    )
    if bodies:
        said += (
            f"; simulations and predicted currents depend on the masses of {_first(list(map(repr, bodies)))}, which "
            "have no <inertial> and lack these shapes"
        )
    return said


def _first(names: Sequence[str]) -> str:
    more = f" and {len(names) - PLAUSIBLE.named} more" if len(names) > PLAUSIBLE.named else ""
    return ", ".join(names[: PLAUSIBLE.named]) + more


def _joint_force(
    term: str,
    joints: Sequence[str],
    effects: Sequence[str],
    unfitted: Sequence[str],
    as_a_whole: Sequence[str],
) -> str:
    said = f"{TERMS[term]} on {', '.join(joints)}: the simulator adds it, the model does not contain it"
    if effects:
        said += f"; fit it with --with {' --with '.join(map(shlex.quote, effects))}"
    if as_a_whole:
        said += (
            f"; in a ball joint ({', '.join(as_a_whole)}) law and simulated machine oppose the angular velocity as a "
            "whole, MuJoCo by itself brakes each of its axes"
        )
    if unfitted:
        said += (
            f"; the catalogue has no such effect for a ball or free joint ({', '.join(unfitted)}): for a simulation "
            "without hidden effects, set it to zero in the MJCF"
        )
    return said


def _locked(joints: Mapping[str, Mapping[str, Any]]) -> str:
    return locked_in_words(locked_from_data(joints))


def _masses_large(masses: Mapping[str, float]) -> str:
    heavy = ", ".join(f"body {body!r} {mass:.3g} kg" for body, mass in masses.items())
    return (
        f"{heavy}: MuJoCo assumes 1000 kg/m³ for bodies without a mass, and an MJCF is in metres and kg. "
        "Identification does not read masses, but simulations and the predicted currents of a plan depend on them"
    )


def _base_agree(parameters: int, difference: float, states: int, neglected: float) -> str:
    slack = (
        f"; closure errors of the drawing, {neglected:.0e} of the largest, are neglected" if neglected else ""
    )
    return (
        f"{parameters} reproduce MuJoCo's motor torques at {states} closed states, for every body's mass, to "
        f"{difference:.0e} of the largest{slack}"
    )


def _base_differ(parameters: int, difference: float, bodies: Sequence[str], motors: Mapping[str, str]) -> str:
    return (
        f"{parameters} do not reproduce the motor torques of {', '.join(bodies)}: they differ from MuJoCo's by up to "
        f"{difference:.0e} of the largest; {narrower_ranges(motors)}"
    )


def _source(given: int | None, positions: int) -> str:
    """Source of the home pose: a keyframe that gives `given` of the positions, or qpos0."""
    if given is None:
        return "qpos0, as there is no keyframe home"
    if given < positions:
        return f"keyframe home with {given} of {positions} positions, the others from qpos0"
    return "keyframe home"


def _closed(gap: float, unit: str, given: int | None, positions: int) -> str:
    source = _source(given, positions)
    return f"widest gap {gap:.1e} {unit} ({source})" if gap else f"no gap ({source})"


def _no_closed_pose(fixed_gaps: Mapping[str, Sequence[float]]) -> str:
    if not fixed_gaps:
        return "no closing pose exists near it, with the motors held or free: check the lengths"
    by_loop = "; ".join(
        f"{name} {' '.join(f'{value:g}' for value in apart)} m" for name, apart in fixed_gaps.items()
    )
    return (
        f"no joint changes these parts of the gaps (x y z in the world, second anchor less first): {by_loop}; move one "
        "site or anchor of each loop by that"
    )


def _weld_too_much(welds: Sequence[str], motors: Sequence[str]) -> str:
    redundant = f", so that {', '.join(motors)} cannot move independently" if motors else ""
    return f"{use_connect(welds)}{redundant}"


def _mobility(tree: int, rank: int, spins: int, remaining: int, motors: int, redundant: Sequence[str]) -> str:
    less = f"{rank} of rank" + (f" and {plural(spins, 'idle spin')}" if spins else "")
    redundant_text = f" and redundant ones at {', '.join(redundant)}" if redundant else ""
    return f"{tree} of the tree minus {less} are {remaining}, for {plural(motors, 'motor')}{redundant_text}"


def _rotors(identified: Sequence[str], within_bodies: Sequence[str]) -> str:
    parts = []
    if identified:
        parts.append(f"of {', '.join(identified)} a separate base parameter, Ia")
    if within_bodies:
        parts.append(f"of {', '.join(within_bodies)} part of a body's inertia")
    return "; ".join(parts)


def _positions(positions: Mapping[str, float], units: Mapping[str, str], sign: str = "") -> str:
    """Positions of motors, with units if there are both hinges and slides."""
    mixed = len({*units.values()}) > 1
    of = {name: f" {units.get(name, '')}" if mixed else "" for name in positions}
    return ", ".join(
        f"{name} {without_rounding(value):{sign}.3g}{of[name]}" for name, value in positions.items()
    )


DERIVED: Mapping[
    str, Callable[[Mapping[str, Any]], str]
] = {  # values that templates name, from those of a check
    "agree": lambda v: f"agree to {v['difference']:.0e}" if v["difference"] else "agree exactly",
    "few_joints": lambda v: _first(v["joints"]),
    "few_keyframes": lambda v: _first(list(map(repr, v["keyframes"]))),
    "source": lambda v: _source(v["given"], v["positions"]),
    "closing": lambda v: home_key(v["closed_qpos"]),
    "why_open": lambda v: _no_closed_pose(v["fixed_gaps"]),
    "at": lambda v: _positions(v["positions"], v["units"]),
}
OPEN = "home assembled: loop {loop!r} is open by {gap:.3g} {unit} ({source}); "
REGULAR = (
    "smallest singular value {singular_value:.2g}; {passive} moves at {amplification:.3g} {unit} of {motor}"
)

WORDS: Mapping[CheckCode, str | tuple[str, Callable[..., str]]] = {
    CheckCode.MJCF_SUPPORTED: "supported MJCF: only bodies, joints and supported equalities",
    CheckCode.MJCF_UNSUPPORTED: ("supported MJCF", _unsupported),
    CheckCode.GEOMETRY_UNREADABLE: "geometry: {fault}",
    CheckCode.FILES_LEFT_OUT: ("note", _files_left_out),
    CheckCode.RANGES_IN_DEGREES: "note: the ranges of {few_joints} count as degrees, within a few degrees of zero; if "
    'they are meant in radians, write <compiler angle="radian"/>',
    CheckCode.RANGES_OF_A_TURN: "note: the ranges of {few_joints} are a whole turn or more and no motor moves these "
    "hinges: no end stops",
    CheckCode.KEYFRAMES_UNUSED: "note: home is qpos0, as no keyframe is named home: if {few_keyframes} is the "
    "assembled pose, rename it home",
    CheckCode.EQUALITY_INACTIVE: "note: equality {equality!r} is inactive and ignored",
    CheckCode.JOINT_FORCE_NOT_MODELLED: ("note", _joint_force),
    CheckCode.MEDIUM_NOT_MODELLED: "note: the simulator applies air drag (density, viscosity), the model does not "
    "contain it",
    CheckCode.GRAVITY_ZERO: "note: gravity is zero in the MJCF, so the model has no weights: remove `gravity` from its "
    "<option> unless that is meant",
    CheckCode.PLUGINS_NOT_MODELLED: "note: {plugins} MuJoCo plug-ins: the model does not contain them",
    CheckCode.ACTUATORS_UNUSED: "note: {actuators} actuators of the MJCF are not used: robot.toml names the motors",
    CheckCode.TENDON_UNUSED: "note: tendon {tendon!r} is ignored",
    CheckCode.TOOL_MISSING: ("note", no_tool),
    CheckCode.LENGTHS_LARGE: "note: lengths of up to {length:.3g} m: an MJCF is in metres, and lengths look like "
    "millimetres or inches; divide every pos by 1000, or by 39.37",
    CheckCode.MASSES_LARGE: ("note", _masses_large),
    CheckCode.JOINTS_LOCKED: ("locked", _locked),
    CheckCode.JOINT_TREES_AGREE: "joint tree: {joints:# joint}, {roots} on the base, the same in both",
    CheckCode.JOINT_COUNTS_DIFFER: "joint tree: MuJoCo has {mujoco} joints, Pinocchio {pinocchio}",
    CheckCode.JOINT_NAMES_DIFFER: "joint tree: joint {mujoco!r} is {pinocchio!r} in Pinocchio",
    CheckCode.JOINT_KINDS_DIFFER: "joint tree: joint {joint!r} is a {mujoco}, in Pinocchio a {pinocchio}",
    CheckCode.JOINT_COORDINATES_DIFFER: "joint tree: joint {joint!r} has different coordinates in Pinocchio",
    CheckCode.JOINT_PARENTS_DIFFER: "joint tree: joint {joint!r} has a different parent in Pinocchio",
    CheckCode.JOINT_AXES_AGREE: "joint places and axes: {joints:# joint} at {poses} poses {agree}",
    CheckCode.JOINT_AXES_DIFFER: "joint places and axes: joint {joint!r}: place differs by {place:.2e} m, axis by "
    "{axis:.2e}",
    CheckCode.BODY_POSES_AGREE: "body poses, {tree}: bodies at {poses} poses {agree}",
    CheckCode.BODY_POSES_DIFFER: "body poses, {tree}: the pose of body {body!r} differs by {difference:.2e}",
    CheckCode.TOTAL_MASSES_AGREE: "total mass: {mass:.6g} kg of moving bodies {agree}",
    CheckCode.TOTAL_MASSES_DIFFER: "total mass: {pinocchio:.9g} kg in Pinocchio, {mujoco:.9g} kg in MuJoCo",
    CheckCode.MASS_MATRICES_AGREE: "masses and inertias: mass matrices {size} × {size} at {poses} poses {agree}",
    CheckCode.MASS_MATRICES_DIFFER: "masses and inertias: the inertia that joint {joint!r} moves differs by "
    "{difference:.2e} of the largest entry",
    CheckCode.BIAS_FORCES_AGREE: "gravity and Coriolis forces: {forces:# force} at {states} states {agree}",
    CheckCode.BIAS_FORCES_DIFFER: "gravity and Coriolis forces: joint {joint!r} differs by {difference:.2e} of the "
    "largest force",
    CheckCode.MOTOR_FORCES_AGREE: "motor forces: regressor and dynamics at {states} closed states {agree}",
    CheckCode.MOTOR_FORCES_DIFFER: "motor forces: motor {motor!r} differs by {difference:.2e} of the largest force",
    CheckCode.BASE_PARAMETERS_AGREE: ("base parameters", _base_agree),
    CheckCode.BASE_PARAMETERS_DIFFER: ("base parameters", _base_differ),
    CheckCode.LOOP_COUNTS_DIFFER: "loop closures: MuJoCo has {mujoco} loops, the model {model}",
    CheckCode.LOOP_CLOSURES_AGREE: "loop closures: residuals and Jacobians at {poses} closed poses agree to "
    "{difference:.0e}",
    CheckCode.LOOP_CLOSURES_DIFFER: "loop closures: {closure!r}: MuJoCo's residual differs by {residual:.2e}, its "
    "Jacobian by {jacobian:.2e}",
    CheckCode.LOOP_OPENING_IN_MOTION: "closed motion: velocities open the loops by {velocity:.0e} of their size, "
    "accelerations by {acceleration:.0e}",
    CheckCode.COUPLING: ("coupling", coupling_equation),
    CheckCode.HOME_WITHOUT_LOOPS: "home assembled: no loops to close ({source})",
    CheckCode.HOME_CLOSED: ("home assembled", _closed),
    CheckCode.DRAWING_ROUNDED: "note: as drawn, home is open by {gap:.1e} {unit}, a rounding error that is "
    "corrected when the robot is read; the loops of the model and of the simulated machine close",
    CheckCode.WELD_TOO_MUCH: ("loop closures", _weld_too_much),
    CheckCode.NEARLY_PARALLEL: "axes: hinges {first!r} and {second!r} are {angle:.1e} rad from parallel, as an angle "
    "such as 1.57 or 3.14 makes them: if they are parallel in the robot, write the angle with all digits "
    "(1.5707963267948966)",
    CheckCode.HOME_OPEN: OPEN + "this pose closes: {closing}",
    CheckCode.HOME_OPEN_AND_NO_CLOSED_POSE: OPEN + "{why_open}",
    CheckCode.HOME_OPEN_AS_LOOPS_DISAGREE: OPEN + "redundant loops disagree, even after a least-squares "
    "closure",
    CheckCode.HOME_WITHIN_RANGES: "home within ranges: {ranged} of {joints} joints have a range",
    CheckCode.HOME_OUTSIDE_RANGE: ("home within ranges", outside_range),
    CheckCode.HOME_AT_RANGE_END: ("note", at_range_end),
    CheckCode.HOME_REGULAR: f"home is regular: {REGULAR}",
    CheckCode.HOME_NEAR_SINGULAR: f"home is regular: home is near a singularity: {REGULAR}",
    CheckCode.HOME_SINGULAR: f"home is regular: home is singular or nearly so: {REGULAR}",
    CheckCode.MOBILITY: ("degrees of freedom", _mobility),
    CheckCode.MOBILITY_FAULT: "degrees of freedom: {fault}",
    CheckCode.ROD_SPINS: "note: {bodies:quoted}: free to spin about the line through the joints at both ends, the "
    "motors held. The model assumes no spin, which is exact if a rod's mass lies on that line",
    CheckCode.MOTION_FAULT: "motion within the joint ranges: {fault}",
    CheckCode.POSES_LOOSE: "motion within the joint ranges: there are poses in which the loop closures do not "
    "determine the passive joints; give the joints narrower ranges around home, away from singular poses",
    CheckCode.ROTOR_INERTIA: ("rotor inertia", _rotors),
    CheckCode.GEOMS_TOUCH: ("note", geoms_touch),
    CheckCode.SINGULARITY_WITHIN_RANGES: "note: the joint ranges contain a singularity, at {at}: keep "
    "trajectories away from it",
    CheckCode.PASSIVE_RANGE_LEFT: ("note", ranges_left),
}
