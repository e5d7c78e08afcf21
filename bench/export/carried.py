"""What moves the motors of a robot that carries a payload: parameters in the columns of its regressor."""

import numpy as np

from bench.basics.errors import BenchError
from bench.export.identified import IdentifiedModel
from bench.identification.payload_parameters import payload_columns


def unknown_payload(model: IdentifiedModel, payload: str) -> BenchError:
    """What is said of a payload of which the model does not know enough."""
    known = ", ".join(sorted({*model.payloads, *model.declared})) or "none"
    return BenchError(
        f"{model.path}: neither the model nor its dataset knows payload {payload!r} in full ({known})"
    )


def payload_values(model: IdentifiedModel, payload: str) -> np.ndarray:
    """A payload's standard parameters (10,) in the tool frame, declared and estimated; zero where none moves a motor.

    Raises BenchError where some of them are neither.
    """
    estimated = model.payloads.get(payload)
    declared = model.declared.get(payload)
    if estimated is None and (declared is None or len(payload_columns(declared).unknown)):
        raise unknown_payload(model, payload)
    values = np.zeros(10) if declared is None else payload_columns(declared).known
    for index, value in (estimated or {}).items():
        values[index] = value
    return values


def carried(model: IdentifiedModel, payload: str | None = None) -> tuple[np.ndarray, np.ndarray]:
    """Columns of the regressor (k,), standard parameters by number, and their values (k,): base, then the payload's.

    Raises BenchError for a payload of which the model does not know enough, and for a robot without a tool.
    """
    built = model.model
    if payload is None:
        return built.base.columns, model.base
    columns, values = built.payload_columns, payload_values(model, payload)
    if built.payload is None:
        raise unknown_payload(model, payload)
    return np.concatenate((built.base.columns, columns)), np.concatenate((model.base, built.payload @ values))
