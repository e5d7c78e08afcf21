"""Whether two motors' columns of a log were swapped: tried if the model explains little."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import combinations

import numpy as np

from bench.basics.deadline import NEVER, Deadline
from bench.basics.threads import on_one_thread
from bench.dataset.payload import Payload
from bench.identification.compressed import triangular_factors
from bench.identification.current_error import minimum_on_factors, squared_errors
from bench.identification.finding import Code, Finding
from bench.identification.layout import ParameterLayout, known_rows, regressor_rows
from bench.identification.observation import Observation, all_currents
from bench.identification.prepare import Prepared, prepare
from bench.identification.problem import Problem
from bench.identification.result import Identification
from bench.identification.solution import NominalGains, scaled_lstsq, solved_gains, torque_system
from bench.identification.tolerances import TOLERANCES


def friction_columns(observation: Observation) -> np.ndarray:
    """Dry and viscous friction of every motor at the fit's rate, (M, n, 2 n): nearly every machine has them."""
    motors = np.arange(observation.velocity.shape[1])
    columns = np.zeros((*observation.velocity.shape, 2 * len(motors)))
    columns[:, motors, 2 * motors] = np.sign(observation.velocity)
    columns[:, motors, 2 * motors + 1] = observation.velocity
    return columns


def with_friction(layout: ParameterLayout, motors: int) -> ParameterLayout:
    """The layout of equations in which every motor has dry and viscous friction, and no other effect."""
    return replace(layout, effects=2 * motors)


def rows_with_friction(
    observation: Observation, layout: ParameterLayout, payloads: Mapping[str, Payload]
) -> np.ndarray:
    """Rows (M, n, p + 1) of [phi, kappa] with friction; layout: from `with_friction`."""
    rows = np.empty((*observation.velocity.shape, layout.size + 1))
    rows[:, :, :-1] = regressor_rows(replace(observation, effects=friction_columns(observation)), layout)
    rows[:, :, -1] = known_rows(observation, payloads)
    return rows


def least_squares(factors: np.ndarray, known: NominalGains) -> tuple[np.ndarray, np.ndarray]:
    """Parameters (p,) and gains (n,) by least squares in torque, of factors (n, r, p + 2) of [phi, kappa, current]."""
    solution = scaled_lstsq(*torque_system(factors, known.held))
    size = factors.shape[2] - 2
    return solution[:size], solved_gains(factors, known.with_fitted(solution[size:]), known.values)


def rigid_equations(problem: Problem, result: Identification) -> Prepared:
    """A problem's equations, without effects and with the filters of a result."""
    return prepare(replace(problem, effects=(), filters=result.settings))


@on_one_thread
def swapped_columns(
    problem: Problem,
    result: Identification,
    prepared: Prepared | None = None,
    deadline: Deadline = NEVER,
    trial: "ColumnsTrial | None" = None,
) -> list[Finding]:
    """The two motors whose columns, when exchanged, lower the error most; none if none do.

    Tried one pair at a time, in all fitted recordings and in each of them, with the filters of the result, and with dry
    and viscous friction in addition to the rigid bodies, so that friction does not hide the swap. The error must fall
    far below that of the result and below that with friction only. If the error of the result is small, nothing is
    tried. prepared: the problem's equations with these filters, and trial: with all currents, if available. Raises
    TimeUpError after the deadline.
    """
    error = result.error.identify
    joints = list(result.joints)
    if error is None or error < TOLERANCES.findings.large_error or len(joints) < 2:
        return []
    if trial is None:
        trial = ColumnsTrial(
            prepared or rigid_equations(replace(problem, fit_gains=result.gains_fitted), result)
        )

    def error_with(swap: tuple[tuple[str, ...], int, int]) -> float:
        deadline.check()
        return trial.error(trial.exchanged(*swap))

    names, a, b = min(_swaps(tuple(trial.parts), len(joints)), key=error_with)
    reached = trial.error(trial.exchanged(names, a, b), least=True)
    both = trial.error(trial.exchanged((), a, b), least=True)
    if not reached < TOLERANCES.findings.swapped_error * min(error, both, 1.0):
        return []
    first, second = joints[a], joints[b]
    where = () if len(names) == len(trial.parts) else (names[0],)
    return [Finding(Code.COLUMNS_SWAPPED, (first, second, *where), numbers={"error": reached})]


def _swaps(names: tuple[str, ...], motors: int) -> Iterator[tuple[tuple[str, ...], int, int]]:
    """Names of recordings, and the two motors whose columns may be exchanged in them."""
    for chosen in dict.fromkeys([names, *((name,) for name in names)]):
        for a, b in combinations(range(motors), 2):
            yield chosen, a, b


class ColumnsTrial:
    """The equations of all fitted recordings with all currents in every motor's rows, and friction.

    parts: for each recording triangular factors (n, r, p + 1 + n) of [phi, kappa, all currents], formed once: an
    exchange only selects other currents. Currents are interpolated where the motor of the rows is at rest.
    """

    def __init__(self, prepared: Prepared) -> None:
        n = len(prepared.dataset.robot.nominal_gains)
        layout = with_friction(prepared.layout, n)
        self.size = layout.size
        self.gains = prepared.gains
        self.parts: dict[str, np.ndarray] = {}
        for observation, measured in zip(prepared.observations, prepared.measured, strict=True):
            if observation.use != "identify":
                continue
            rows = np.empty((len(observation.time), n, self.size + 1 + n))
            rows[:, :, : self.size + 1] = rows_with_friction(observation, layout, prepared.dataset.payloads)
            rows[:, :, self.size + 1 :] = all_currents(measured)
            rows *= observation.moving[:, :, None]
            self.parts[observation.name] = triangular_factors(rows)

    def exchanged(self, names: Sequence[str], a: int, b: int) -> np.ndarray:
        """Factors (n, p + 2, p + 2) of [phi, kappa, current] with two motors' currents exchanged in some recordings."""
        order = np.arange(len(self.gains.values))
        order[[a, b]] = b, a
        return self._with_currents(names, order, np.ones(len(order)))

    def reversed_in(self, names: Sequence[str], motors: Sequence[int]) -> np.ndarray:
        """Factors (n, p + 2, p + 2) of [phi, kappa, current] with the signs of some currents changed in recordings."""
        signs = np.ones(len(self.gains.values))
        signs[list(motors)] = -1.0
        return self._with_currents(names, np.arange(len(signs)), signs)

    def _with_currents(self, names: Sequence[str], order: np.ndarray, factors: np.ndarray) -> np.ndarray:
        """Factors in which every motor has, in some recordings, the current of another, times a factor."""
        at, p = np.arange(len(order)), self.size
        picked = []
        for name, part in self.parts.items():
            changed = name in names
            current = part[at, :, p + 1 + (order if changed else at)]
            current = current * factors[:, None] if changed else current
            picked.append(np.concatenate((part[:, :, : p + 1], current[:, :, None]), axis=2))
        return triangular_factors(np.concatenate(picked, axis=1).swapaxes(0, 1))

    def solved(self, factors: np.ndarray, *, nominal: bool = False) -> tuple[np.ndarray, np.ndarray]:
        """Parameters (p,) and gains (n,) by least squares in torque; nominal: with the nominal gains."""
        return least_squares(factors, replace(self.gains, fitted=False) if nominal else self.gains)

    def error(self, factors: np.ndarray, *, least: bool = False, nominal: bool = False) -> float:
        """Relative error of the currents by least squares in torque, or `least`: its minimum, from there.

        nominal: with the nominal gains.
        """
        theta, gains = self.solved(factors, nominal=nominal)
        if least:
            theta, gains = minimum_on_factors(factors, theta, gains, np.ones(len(gains)), self.gains.fitted)
        return float(np.sqrt(squared_errors(factors, theta, gains).sum() / (factors[:, :, -1] ** 2).sum()))
