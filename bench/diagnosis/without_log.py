"""The answer with each log omitted: names that stay, and names that depend on one log."""

from collections.abc import Sequence
from dataclasses import replace

from bench.diagnosis.batched_sets import reduced
from bench.diagnosis.candidates import Proposal
from bench.diagnosis.motor_products import summed
from bench.diagnosis.result import WithoutLog
from bench.diagnosis.search import Selection, possible, score_set, scored
from bench.diagnosis.system import System
from bench.identification.prepare import Prepared


def without_logs(
    model: Prepared, system: System, selection: Selection, proposals: Sequence[Proposal]
) -> tuple[WithoutLog, ...]:
    """For every fitted log of several: the effects of the best set that the others do not support.

    Sets are solved about the identified model, in the equations of the other logs.
    """
    fitted = [log for log, by_use in system.by_log.items() if "identify" in by_use]
    joints = model.dataset.robot.joints
    rows = []
    for log in fitted if len(fitted) > 1 else ():
        others = _without(system, log)
        chosen = selection.selected.fit.chosen
        whole = score_set(others, chosen)
        fewer = scored(others, reduced(chosen))
        gone = [
            proposals[i].name
            for i, without in zip(chosen, fewer, strict=True)
            if without.total >= whole.total and possible(others, without.fit)
        ]
        gains = dict(zip(joints, whole.fit.gains.tolist(), strict=True)) if _scaled(model, log) else {}
        rows.append(WithoutLog(log, tuple(gone), gains))
    return tuple(rows)


def _without(system: System, log: str) -> System:
    """The equations of all logs but one."""
    fitted, held_out = (
        summed(
            [by_use[use] for name, by_use in system.by_log.items() if name != log and use in by_use],
            len(products.with_zeros[0]),
            len(products.with_zeros),
        )
        for use, products in (("identify", system.fitted), ("validate", system.held_out))
    )
    return replace(system, fitted=fitted, held_out=held_out, by_log={}, solved={})


def _scaled(model: Prepared, log: str) -> bool:
    """Whether gains are fitted and the other fitted logs carry different loads, one of known mass: body parameters
    absorb a load that is always present, and leave the scale open.
    """
    weighed = model.dataset.weighed
    carried = {
        measured.recording.payload
        for measured in model.measured
        if measured.recording.use == "identify" and measured.recording.log != log
    }
    return model.fit_gains and len(carried) > 1 and any(payload in weighed for payload in carried)
