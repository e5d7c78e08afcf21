"""Whether an encoder or a current has the wrong sign, or an angle and a travel are swapped; tried for large errors."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from bench.basics.deadline import NEVER, Deadline
from bench.basics.errors import BenchError
from bench.basics.joint_units import units_of_gain
from bench.basics.threads import on_one_thread
from bench.dataset.logs.units import UNITS
from bench.dataset.robot import Robot
from bench.identification.finding import Code, Finding
from bench.identification.problem import Problem
from bench.identification.result import Identification
from bench.identification.swapped_columns import ColumnsTrial, rigid_equations
from bench.identification.tolerances import TOLERANCES


@dataclass(frozen=True, eq=False)
class PositionChange:
    """Other positions, and their meaning. order, factors (n,): the column that each joint gets, and its factor."""

    code: Code
    joints: tuple[str, ...]
    order: tuple[int, ...]
    factors: np.ndarray

    def of(self, position: np.ndarray) -> np.ndarray:
        """The changed positions (N, n) of a log."""
        return np.ascontiguousarray(position[:, list(self.order)] * self.factors)


@on_one_thread
def reversed_positions(
    problem: Problem,
    result: Identification,
    trial: ColumnsTrial,
    deadline: Deadline = NEVER,
    *,
    other: float | None = None,
) -> list[Finding]:
    """The position whose sign change, or the two whose exchange, lowers the error far; none if none does.

    Tried in all recordings, with nominal gains and dry and viscous friction, only if the error is so large that a wrong
    column is likely: each requires closing the loops again. Positions that the loops cannot follow are no candidates.
    The sign of the current may change with that of the position: numbers say whether. trial: equations with the filters
    of the result. other: the error with another sign of a current, which this must halve; if it is small, nothing is
    tried. Raises TimeUpError after the deadline.
    """
    bounds, robot = TOLERANCES.findings, problem.dataset.robot
    before = _error(trial)
    if before < bounds.wrong_position or (other is not None and other < bounds.large_error):
        return []
    tried: list[tuple[float, float, PositionChange]] = []
    for change in changes(robot):
        deadline.check()
        recordings = tuple(
            replace(recording, position=change.of(recording.position))
            for recording in problem.dataset.recordings
        )
        dataset = replace(problem.dataset, recordings=recordings)
        changed = replace(problem, dataset=dataset, fit_gains=result.gains_fitted)
        try:
            equations = rigid_equations(changed, result)
        except BenchError:
            continue
        there = ColumnsTrial(equations)
        tried.append((_error(there), 0.0, change))
        if change.code is Code.POSITION_REVERSED:
            tried.append((_error(there, robot.joints.index(change.joints[0])), 1.0, change))
    if not tried:
        return []
    after, current, change = min(tried, key=lambda trial: trial[0])
    least = before if other is None else other
    if not after < min(bounds.swapped_error * least, bounds.explained):
        return []
    return [
        Finding(change.code, change.joints, numbers={"before": before, "after": after, "current": current})
    ]


def _error(trial: ColumnsTrial, *motors: int) -> float:
    """The error with nominal gains, for any signs of the motors' currents."""
    return trial.error(trial.reversed_in(tuple(trial.parts), motors), nominal=True)


def changes(robot: Robot) -> Iterator[PositionChange]:
    """Each joint's sign, and each exchange of an angle with a travel."""
    joints = robot.joints
    turns = [units_of_gain(actuator.gain_unit).rotates for actuator in robot.actuators]
    motors = range(len(joints))
    for j, joint in enumerate(joints):
        signs = np.where(np.arange(len(joints)) == j, -1.0, 1.0)
        yield PositionChange(Code.POSITION_REVERSED, (joint,), tuple(motors), signs)
    for a, b in combinations(motors, 2):
        if turns[a] == turns[b]:
            continue  # swaps of like motors are tried with their currents
        order = list(motors)
        order[a], order[b] = b, a
        for scale in (
            1.0,
            UNITS["mm"].factor / UNITS["deg"].factor,
        ):  # in SI, or in what a log states of each column
            factors = np.ones(len(joints))
            factors[a], factors[b] = (1.0 / scale, scale) if turns[a] else (scale, 1.0 / scale)
            yield PositionChange(Code.POSITIONS_SWAPPED, (joints[a], joints[b]), tuple(order), factors)


_Reversal = tuple[tuple[str, ...], tuple[int, ...]]
"""Names of recordings, and the motors whose currents have the other sign in them."""


@on_one_thread
def reversed_currents(
    result: Identification, trial: ColumnsTrial, deadline: Deadline = NEVER
) -> list[Finding]:
    """The currents whose sign change lowers the error far; none if none does.

    Tried with nominal gains, since fitted ones would only change their sign, and with dry and viscous friction in
    addition to the rigid bodies: one motor in all fitted recordings or in one, or all motors. trial: equations with the
    filters of the result. Raises TimeUpError after the deadline.
    """
    bounds = TOLERANCES.findings

    def error_with(change: _Reversal) -> float:
        deadline.check()
        return trial.error(trial.reversed_in(*change), nominal=True)

    before = error_with(((), ()))
    if before < bounds.large_error:
        return []
    names, motors = min(_changes(tuple(trial.parts), len(result.joints)), key=error_with)
    after = error_with((names, motors))
    if not after < min(bounds.swapped_error * before, bounds.explained):
        return []
    where = () if len(names) == len(trial.parts) else names
    numbers = {"before": before, "after": after}
    return [
        Finding(Code.CURRENT_REVERSED, (result.joints[motor], *where), numbers=numbers) for motor in motors
    ]


def _changes(names: tuple[str, ...], motors: int) -> Iterator[_Reversal]:
    each = [(motor,) for motor in range(motors)]
    for chosen in dict.fromkeys([names, *((name,) for name in names)]):
        for some in dict.fromkeys([*each, tuple(range(motors))]):
            yield chosen, some
