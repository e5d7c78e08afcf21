"""What the comparison of Pinocchio, MuJoCo and the model says."""

from collections.abc import Callable, Sequence

from bench.robot_check.outcome import CheckCode


def count(number: int, noun: str) -> str:
    """A number with its noun: 1 loop, 2 loops."""
    return f"{number} {noun}{'' if number == 1 else 's'}"


def _trees_agree(joints: int, roots: int) -> str:
    return f"{count(joints, 'joint')}, {roots} on the base, the same in both"


def _joint_counts(mujoco: int, pinocchio: int) -> str:
    return f"MuJoCo has {mujoco} joints, Pinocchio {pinocchio}"


def _joint_names(mujoco: str, pinocchio: str) -> str:
    return f"joint {mujoco!r} is {pinocchio!r} in Pinocchio"


def _joint_kinds(joint: str, mujoco: str, pinocchio: str) -> str:
    return f"joint {joint!r} is a {mujoco}, in Pinocchio a {pinocchio}"


def _joint_coordinates(joint: str) -> str:
    return f"joint {joint!r} has different coordinates in Pinocchio"


def _joint_parents(joint: str) -> str:
    return f"joint {joint!r} has a different parent in Pinocchio"


def _agreement(difference: float) -> str:
    return f"agree {f'to {difference:.0e}' if difference else 'exactly'}"


def _axes_agree(joints: int, poses: int, difference: float) -> str:
    return f"{count(joints, 'joint')} at {poses} poses {_agreement(difference)}"


def _axes_differ(joint: str, place: float, axis: float) -> str:
    return f"joint {joint!r}: place differs by {place:.2e} m, axis by {axis:.2e}"


def _poses_agree(tree: str, poses: int, difference: float) -> str:
    return f"bodies at {poses} poses {_agreement(difference)}"


def _poses_differ(tree: str, body: str, difference: float) -> str:
    return f"the pose of body {body!r} differs by {difference:.2e}"


def _total_masses_agree(mass: float, difference: float) -> str:
    return f"{mass:.6g} kg of moving bodies {_agreement(difference)}"


def _total_masses_differ(pinocchio: float, mujoco: float) -> str:
    return f"{pinocchio:.9g} kg in Pinocchio, {mujoco:.9g} kg in MuJoCo"


def _mass_matrices_agree(size: int, poses: int, difference: float) -> str:
    return f"mass matrices {size} × {size} at {poses} poses {_agreement(difference)}"


def _mass_matrices_differ(joint: str, difference: float) -> str:
    return f"the inertia that joint {joint!r} moves differs by {difference:.2e} of the largest entry"


def _bias_forces_agree(forces: int, states: int, difference: float) -> str:
    return f"{count(forces, 'force')} at {states} states {_agreement(difference)}"


def _bias_forces_differ(joint: str, difference: float) -> str:
    return f"joint {joint!r} differs by {difference:.2e} of the largest force"


def _motor_forces_agree(states: int, difference: float) -> str:
    return f"regressor and dynamics at {states} closed states {_agreement(difference)}"


def _motor_forces_differ(motor: str, difference: float) -> str:
    return f"motor {motor!r} differs by {difference:.2e} of the largest force"


def _base_agree(parameters: int, difference: float, states: int, neglected: float) -> str:
    slack = (
        f"; closure errors of the drawing, {neglected:.0e} of the largest, are neglected" if neglected else ""
    )
    return (
        f"{parameters} reproduce MuJoCo's motor torques at {states} closed states, for every body's mass, to "
        f"{difference:.0e} of the largest{slack}"
    )


def _base_differ(parameters: int, difference: float, bodies: Sequence[str]) -> str:
    return (
        f"{parameters} do not reproduce the motor torques of {', '.join(bodies)}: they differ from MuJoCo's by up to "
        f"{difference:.0e} of the largest; give the joints narrower ranges around home, away from singular poses"
    )


AGREEMENT_WORDS: dict[CheckCode, tuple[str, Callable[..., str]]] = {
    CheckCode.JOINT_TREES_AGREE: ("joint tree", _trees_agree),
    CheckCode.JOINT_COUNTS_DIFFER: ("joint tree", _joint_counts),
    CheckCode.JOINT_NAMES_DIFFER: ("joint tree", _joint_names),
    CheckCode.JOINT_KINDS_DIFFER: ("joint tree", _joint_kinds),
    CheckCode.JOINT_COORDINATES_DIFFER: ("joint tree", _joint_coordinates),
    CheckCode.JOINT_PARENTS_DIFFER: ("joint tree", _joint_parents),
    CheckCode.JOINT_AXES_AGREE: ("joint places and axes", _axes_agree),
    CheckCode.JOINT_AXES_DIFFER: ("joint places and axes", _axes_differ),
    CheckCode.BODY_POSES_AGREE: ("body poses, {tree}", _poses_agree),
    CheckCode.BODY_POSES_DIFFER: ("body poses, {tree}", _poses_differ),
    CheckCode.TOTAL_MASSES_AGREE: ("total mass", _total_masses_agree),
    CheckCode.TOTAL_MASSES_DIFFER: ("total mass", _total_masses_differ),
    CheckCode.MASS_MATRICES_AGREE: ("masses and inertias", _mass_matrices_agree),
    CheckCode.MASS_MATRICES_DIFFER: ("masses and inertias", _mass_matrices_differ),
    CheckCode.BIAS_FORCES_AGREE: ("gravity and Coriolis forces", _bias_forces_agree),
    CheckCode.BIAS_FORCES_DIFFER: ("gravity and Coriolis forces", _bias_forces_differ),
    CheckCode.MOTOR_FORCES_AGREE: ("motor forces", _motor_forces_agree),
    CheckCode.MOTOR_FORCES_DIFFER: ("motor forces", _motor_forces_differ),
    CheckCode.BASE_PARAMETERS_AGREE: ("base parameters", _base_agree),
    CheckCode.BASE_PARAMETERS_DIFFER: ("base parameters", _base_differ),
}
