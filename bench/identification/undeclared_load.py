"""Whether a recording carries a load that nobody declares: tried where the model explains little."""

from dataclasses import replace

import numpy as np

from bench.basics.deadline import NEVER, Deadline
from bench.basics.errors import BenchError
from bench.basics.threads import on_one_thread
from bench.dataset.payload import Payload
from bench.identification.finding import Code, Finding
from bench.identification.problem import Problem
from bench.identification.result import Identification
from bench.identification.swapped_columns import ColumnsTrial, rigid_equations
from bench.identification.tolerances import TOLERANCES

LOAD = "an undeclared load"


@on_one_thread
def undeclared_load(
    problem: Problem, result: Identification, trial: ColumnsTrial, deadline: Deadline = NEVER
) -> list[Finding]:
    """The fitted recording without a payload that an unknown payload explains, with its mass; none where none does.

    Tried with the nominal gains and with dry and viscous friction, in one recording after the other. Of two recordings
    the one is named whose load has a positive mass. With a payload of known mass in another one, that mass may be what
    is wrong, and nothing is tried. trial: equations with the filters of the result. Raises
    TimeUpError after the deadline.
    """
    bounds, dataset = TOLERANCES.findings, problem.dataset
    fitted = [recording for recording in dataset.recordings if recording.use == "identify"]
    weighed = any(recording.payload in dataset.weighed for recording in fitted)
    if dataset.robot.tool_site is None or len(fitted) < 2 or weighed:
        return []
    before = trial.error(trial.reversed_in((), ()), nominal=True)
    if before < bounds.large_error:
        return []
    best: tuple[float, float, str] | None = None
    for name in [recording.name for recording in fitted if recording.payload is None]:
        deadline.check()
        try:
            after, mass = _with_load(problem, result, name)
        except BenchError:
            continue
        if mass > 0.0 and (best is None or after < best[0]):
            best = after, mass, name
    if best is None or not best[0] < min(bounds.swapped_error * before, bounds.large_error):
        return []
    after, mass, name = best
    return [
        Finding(Code.LOAD_UNDECLARED, (name,), (), {"before": before, "after": after, "mass": mass}, "kg")
    ]


def _with_load(problem: Problem, result: Identification, name: str) -> tuple[float, float]:
    """Error with an unknown payload on the tool in one recording, and its mass, kg."""
    dataset = problem.dataset
    recordings = tuple(
        replace(recording, payload=LOAD) if recording.name == name else recording
        for recording in dataset.recordings
    )
    payloads = {**dataset.payloads, LOAD: Payload(LOAD, None)}
    loaded = replace(dataset, recordings=recordings, payloads=payloads)
    prepared = rigid_equations(replace(problem, dataset=loaded, fit_gains=False), result)
    index = prepared.layout.payloads.get(LOAD, np.empty(0))
    if 0 not in index:
        return np.inf, 0.0  # no motion of this robot shows the mass of a payload
    trial = ColumnsTrial(prepared)
    factors = trial.reversed_in((), ())
    theta, _ = trial.solved(factors, nominal=True)
    return trial.error(factors, nominal=True), float(theta[prepared.layout.payload_slice(LOAD)][0])
