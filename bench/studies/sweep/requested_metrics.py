"""Whether a sweep's summary and figures ask for something that its runs will have."""

from __future__ import annotations

from collections.abc import Iterable

from bench.basics.errors import BenchError
from bench.studies.sweep.axes import GridAxis
from bench.studies.sweep.metrics import METRICS
from bench.studies.sweep.plan import Plan

USES = ("identify", "validate")


def check_asked(plan: Plan, joints: Iterable[str]) -> None:
    """Check every metric of `show` and every axis of `plots`; joints: of all robots of the sweep.

    Raises BenchError, one line that names the metric and the cure.
    """
    table, path = plan.sweep.table, plan.sweep.path
    for metric in table.show:
        if fault := _fault(plan, metric, sorted(joints)):
            raise BenchError(f"{path}: show: {fault}")
    for plot in table.plots:
        if fault := _fault(plan, plot.y, sorted(joints)):
            raise BenchError(f"{path}: plots: {fault}")
        for axis in (plot.x, *([plot.lines] if plot.lines else [])):
            if axis in (*plan.axis_names, "seed"):
                continue
            if axis.split(".")[0] not in METRICS:
                raise BenchError(
                    f"{path}: plots: {axis!r} is not an axis; there are {', '.join((*plan.axis_names, 'seed'))}"
                )
            if fault := _fault(plan, axis, sorted(joints)):
                raise BenchError(f"{path}: plots: {fault}")


def _fault(plan: Plan, metric: str, joints: list[str]) -> str | None:
    """What is wrong with a metric, or None."""
    name, _, of = metric.partition(".")
    table = plan.sweep.table
    if name not in METRICS:
        return f"no metric {metric!r}; there are {', '.join(METRICS)}"
    known = METRICS[name]
    if known.group and known.group not in table.record:
        groups = ", ".join(f'"{group}"' for group in (*table.record, known.group))
        return f"{metric!r} is not recorded: record = [{groups}]"
    if name == "diagnosis" and not _diagnoses(plan):
        return f"{metric!r} needs `diagnose = true` in [identify]"
    if known.of == "use" and of not in USES:
        return f"{metric!r}: should be {name}.identify or {name}.validate"
    one_joint = known.of == "joint" or (known.of == "joint or all" and of)
    if one_joint and of not in joints:
        return f"{metric!r}: should be {name}.JOINT, with one of {', '.join(joints)}"
    return None


def _diagnoses(plan: Plan) -> bool:
    varied = {path for axis in plan.sweep.axes if isinstance(axis, GridAxis) for path in axis.paths}
    return plan.sweep.table.identify.diagnose or "diagnose" in varied
