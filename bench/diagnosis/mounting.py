"""Whether a payload is mounted the same way in all recordings that name it."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from bench.basics.threads import on_one_thread
from bench.dataset.payload import Payload
from bench.diagnosis.block_cross_validation import block_cross_validation
from bench.identification.decision import RULE
from bench.identification.finding import Code, Finding
from bench.identification.layout import parameter_layout, payload_parameters
from bench.identification.observation import Observation
from bench.identification.prepare import Prepared
from bench.identification.solve_only import solved_quickly
from bench.identification.standard_errors import uncertainty


@on_one_thread
def mounted_otherwise(prepared: Prepared) -> list[Finding]:
    """Payloads whose centre and inertia differ between their recordings, with the most influential parameter.

    Includes recordings that are not fitted. Estimates by recording are judged, against one for all, on every other part
    of the recordings.
    """
    logs = {
        observation.name: log for observation, log in zip(prepared.observations, _logs(prepared), strict=True)
    }
    carried: dict[str, list[str]] = {}
    for observation in prepared.observations:
        if observation.payload_name is not None and logs[observation.name] not in carried.setdefault(
            observation.payload_name, []
        ):
            carried[observation.payload_name].append(logs[observation.name])
    differing = [_differing(prepared, name, logs) for name, of in carried.items() if len(of) > 1]
    return [finding for finding in differing if finding is not None]


def _differing(prepared: Prepared, payload: str, logs: Mapping[str, str]) -> Finding | None:
    common = _mounted(prepared, payload, dict.fromkeys(logs, payload))
    each = _mounted(prepared, payload, {name: f"{payload}@{log}" for name, log in logs.items()})
    names = [name for name in each.layout.payloads if name.startswith(f"{payload}@")]
    index = each.layout.payloads[names[0]]
    if not len(index):
        return None
    stack, solution = solved_quickly(each)
    slices = [each.layout.payload_slice(name) for name in names]
    further = np.concatenate([stack.phi[:, :, rows] for rows in slices[:-1]], axis=2)
    validation = block_cross_validation(*solved_quickly(common), further)
    before, after = validation.held_out_squares([]), validation.held_out_squares(range(further.shape[2]))
    if validation.evidence(before, after) < RULE.prior or not np.any(after / before < RULE.most):
        return None
    covariance = uncertainty(stack, solution, "autocorrelated").covariance
    values = np.array([solution.theta[rows] for rows in slices])
    variances = np.array([np.diag(covariance)[rows] for rows in slices])
    low, high = values.argmin(axis=0), values.argmax(axis=0)
    k = np.arange(len(index))
    apart = (values[high, k] - values[low, k]) / np.sqrt(variances[high, k] + variances[low, k])
    most = int(np.nanargmax(apart))
    if not apart[most] > RULE.certain:
        return None
    first, second = int(high[most]), int(low[most])
    symbol, unit = payload_parameters(index)[most]
    labels = [name.removeprefix(f"{payload}@") for name in (names[first], names[second])]
    std = np.sqrt(variances[:, most])
    return Finding(
        Code.MOUNTED_OTHERWISE,
        (payload, symbol, *labels),
        numbers={
            "first": float(values[first, most]),
            "first_std": float(std[first]),
            "second": float(values[second, most]),
            "second_std": float(std[second]),
        },
        unit=unit,
    )


def _mounted(prepared: Prepared, payload: str, named: Mapping[str, str]) -> Prepared:
    """All recordings, as if fitted, with a payload of which only the mass is known; named: the load of each."""
    declared = prepared.dataset.payloads[payload]

    def renamed(observation: Observation) -> Observation:
        name = named[observation.name] if observation.payload_name == payload else observation.payload_name
        return replace(observation, use="identify", payload_name=name)

    observations = tuple(renamed(observation) for observation in prepared.observations)
    new = [
        observation.payload_name
        for observation in observations
        if observation.payload_name not in prepared.dataset.payloads
    ]
    payloads = dict(prepared.dataset.payloads) | {
        name: Payload(name, declared.mass, None, None) for name in [payload, *new] if name is not None
    }
    layout = parameter_layout(
        prepared.model,
        payloads,
        [observation.payload_name for observation in observations],
        prepared.layout.effects,
    )
    dataset = replace(prepared.dataset, payloads=payloads)
    return replace(prepared, dataset=dataset, observations=observations, layout=layout)


def _logs(prepared: Prepared) -> list[str]:
    return [measurement.recording.log for measurement in prepared.measured]
