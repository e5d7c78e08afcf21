"""Check a sweep before it starts, so that an error in run 900 is reported at once."""

from collections.abc import Collection, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field

import numpy as np
from pydantic import ValidationError

from bench.basics.errors import BenchError
from bench.basics.files.toml_input import first_mistake
from bench.dataset.robot import Robot, load_robot
from bench.effects import places_in, select_effects
from bench.identification.estimators import ESTIMATORS
from bench.model.model import build_model
from bench.scenario.scenario import Scenario, scenario_from_dict
from bench.studies.sweep.axes import DrawnAxis
from bench.studies.sweep.hidden_share import without_share
from bench.studies.sweep.metrics import METRICS
from bench.studies.sweep.plan import Plan, Run, digest
from bench.studies.sweep.sweep_file import IdentifyTable
from bench.truth.machine import build_machine, nominal_gains, true_gains

USES = ("identify", "validate")
MOST_CHECKED = 3000
MOST_BUILT = 8


def check_asked(plan: Plan, joints: Iterable[str]) -> None:
    """Check every metric of `show` and every metric and axis of `plots`; joints: of all robots of the sweep.

    Raises BenchError, one line that names the metric and the cure.
    """
    table, axes = plan.sweep.table, (*plan.axis_names, "seed")
    asked = [("show", metric) for metric in table.show]
    for plot in table.plots:
        drawn = [axis for axis in (plot.x, plot.lines) if axis is not None and axis not in axes]
        for axis in drawn:
            if axis.split(".")[0] not in METRICS:
                raise BenchError(
                    f"{plan.sweep.path}: plots: {axis!r} is not an axis; there are {', '.join(axes)}"
                )
        asked += [("plots", metric) for metric in (plot.y, *drawn)]
    for key, metric in asked:
        if fault := _fault(plan, metric, sorted(joints)):
            raise BenchError(f"{plan.sweep.path}: {key}: {fault}")


def _fault(plan: Plan, metric: str, joints: list[str]) -> str | None:
    """The fault of a metric, or None."""
    name, _, of = metric.partition(".")
    table = plan.sweep.table
    if name not in METRICS:
        return f"no metric {metric!r}; there are {', '.join(METRICS)}"
    known = METRICS[name]
    if known.group and known.group not in table.record:
        groups = ", ".join(f'"{group}"' for group in (*table.record, known.group))
        return f"{metric!r} is not recorded: record = [{groups}]"
    varied = {path for axis in plan.sweep.grid for path in axis.paths}
    if name == "diagnosis" and not (table.identify.diagnose or "diagnose" in varied):
        return f"{metric!r} needs `diagnose = true` in [identify]"
    if known.of == "use" and of not in USES:
        return f"{metric!r}: should be {name}.identify or {name}.validate"
    one_joint = known.of == "joint" or (known.of == "joint or all" and of)
    if one_joint and of not in joints:
        return f"{metric!r}: should be {name}.JOINT, with one of {', '.join(joints)}"
    return None


@dataclass
class _Seen:
    robots: dict[str, Robot] = field(default_factory=dict)
    effects: set[str] = field(default_factory=set)
    payloads: set[str] = field(default_factory=set)
    """Payloads on the tool in some recording."""


def check_plan(plan: Plan) -> None:
    """Check every grid point and every draw (3000 of each at most), and build some of the machines.

    Raises BenchError, one line that names the run and its fault.
    """
    seen = _Seen()
    scenarios: dict[str, tuple[Run, Scenario]] = {}
    for number in _representative(plan):
        run = plan.run(number)
        with _about(plan, run):
            scenario = _checked(run, seen)
        machine = digest([run.content.get(key) for key in ("robot", "hidden", "payloads")])
        scenarios.setdefault(machine, (run, scenario))
    check_asked(plan, {joint for robot in seen.robots.values() for joint in robot.driven})
    _check_payloads(plan, seen.payloads)
    pairs = list(scenarios.values())
    for i in _spread(len(pairs), MOST_BUILT):
        run, scenario = pairs[i]
        with _about(plan, run):
            build_machine(scenario)


def _checked(run: Run, seen: _Seen) -> Scenario:
    name = run.content.get("robot")
    if isinstance(name, str) and name not in seen.robots:
        seen.robots[name] = load_robot(name)
    content = without_share(run.content)
    scenario = scenario_from_dict(content, run.base, run.base, seen.robots.get(str(name)))
    seen.payloads.update(table.payload for table in scenario.settings.recordings if table.payload is not None)
    _check_joints(run, scenario)
    try:
        identify = IdentifyTable.model_validate(run.identify)
    except ValidationError as error:
        raise BenchError(first_mistake(error)) from error
    if identify.method not in ESTIMATORS:
        raise BenchError(f"method: {identify.method!r} is not one of {', '.join(ESTIMATORS)}")
    key = digest([name, identify.effects, sorted(scenario.settings.payloads)])
    if key not in seen.effects:
        if identify.effects:
            places = places_in(build_model(scenario.robot).geometry, scenario.settings.payloads)
            select_effects(identify.effects, places)
        seen.effects.add(key)
    return scenario


def _check_joints(run: Run, scenario: Scenario) -> None:
    """Raise BenchError if a named joint does not exist or a gain changes its sign (an error of 20 % is 0.2)."""
    robot, joint = scenario.robot, run.content.get("hidden_joint")
    if joint is not None and joint not in robot.driven:
        raise BenchError(f"hidden_joint: no actuated joint {joint!r}; there are {', '.join(robot.driven)}")
    for name, true, nominal in zip(robot.driven, true_gains(scenario), nominal_gains(robot), strict=True):
        if true * nominal <= 0:
            raise BenchError(
                f"gains: {name} would have {true:g}, nominal {nominal:g}: an error of 20 % is 0.2"
            )


def _check_payloads(plan: Plan, used: Collection[str]) -> None:
    """Raise BenchError if an axis varies a payload that no recording has."""
    for axis in plan.sweep.axes:
        for path in axis.paths:
            head, *rest = path.split(".")
            if head == "payloads" and rest and rest[0] not in used:
                known = ", ".join(sorted(used)) or "none"
                where = f"{plan.sweep.path}: axes.{axis.name}"
                raise BenchError(f"{where}: no recording has the payload {rest[0]!r}; used: {known}")


def fixed_declarations(plan: Plan) -> list[str]:
    """A note on each property of a payload that an axis varies while the dataset declares a fixed value."""
    axis_of = {path: axis.name for axis in plan.sweep.axes for path in axis.paths}
    payloads = plan.run(0).content.get("payloads") or {}
    notes = []
    for path, axis in axis_of.items():
        head, *rest = path.split(".")
        if head != "payloads" or len(rest) != 2 or rest[1] == "declared":
            continue
        name, key = rest
        table = f"payloads.{name}.declared"
        declared = (payloads.get(name, {}).get("declared") or {}).get(key)
        if declared is None or table in axis_of or f"{table}.{key}" in axis_of:
            continue
        notes.append(
            f"note: axes.{axis} varies the true {key} of {name}, while the dataset declares {declared} in every run: "
            f"gains are off by the difference. Vary {table}.{key} along, or remove {table} to declare the truth."
        )
    return notes


def _representative(plan: Plan) -> Iterator[int]:
    """Numbers of runs: all grid points with the first seed, then all seeds if something is drawn."""
    numbers = np.arange(plan.size).reshape(plan.shape)
    seeds = plan.axes.index(None)
    grid = numbers.take(0, axis=seeds).ravel()
    yield from (int(grid[i]) for i in _spread(len(grid), MOST_CHECKED))
    if any(isinstance(axis, DrawnAxis) for axis in plan.sweep.axes):
        drawn = np.moveaxis(numbers, seeds, 0).reshape(plan.shape[seeds], -1)[:, 0]
        yield from (int(drawn[i]) for i in _spread(len(drawn), MOST_CHECKED))


def _spread(count: int, most: int) -> Sequence[int]:
    """At most `most` of the indices below `count`, including the first and the last."""
    return sorted({int(i) for i in np.linspace(0, count - 1, min(count, most)).round()})


@contextmanager
def _about(plan: Plan, run: Run) -> Iterator[None]:
    """A BenchError raised inside names the run."""
    try:
        yield
    except BenchError as error:
        values = ", ".join(f"{name} = {value}" for name, value in run.axes.items()) or f"seed {run.seed}"
        raise BenchError(f"{plan.sweep.path}: run {run.number} ({values}): {error}") from error
