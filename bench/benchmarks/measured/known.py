"""Known values of the measured machines, from known.toml, and their comparison with estimates."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from math import hypot
from pathlib import Path
from typing import Annotated, Any, Self

from pydantic import Field, model_validator

from bench.basics.files.toml_input import UserTable, read_toml

DRIVE_GAIN, PARAMETER = "drive_gain", "parameter"
WITHIN = 2.0  # standard errors: allowed difference of an estimate, in addition to the reference's uncertainty
Share = Annotated[float, Field(ge=0.0, allow_inf_nan=False)]


class KnownValue(UserTable):
    """[[machines.NAME.known]]: values of one quantity; the first lines of the file explain the keys."""

    of: str
    parameter: str = ""
    called: str = ""
    values: Mapping[str, Annotated[float, Field(allow_inf_nan=False)]]
    uncertainty: Share = 0.0
    goal: Share | Mapping[str, Share] | None = None
    felt: Mapping[str, Mapping[str, float]] = Field(default_factory=dict)
    source: Annotated[str, Field(min_length=1)]

    @model_validator(mode="after")
    def _places(self) -> Self:
        goals = set(self.goal) if isinstance(self.goal, Mapping) else set()
        if unknown := (goals | set(self.felt)) - set(self.values):
            raise ValueError(f"should have values for {', '.join(sorted(unknown))}")
        if (self.of in (DRIVE_GAIN, PARAMETER)) == bool(self.parameter):
            raise ValueError("should name the effect's parameter, and none for a gain or a base parameter")
        return self

    def goal_at(self, place: str) -> float | None:
        """The largest acceptable relative difference of the estimate at a place; None without a goal."""
        return self.goal.get(place) if isinstance(self.goal, Mapping) else self.goal


class MachineTable(UserTable):
    """[machines.NAME]: a machine with its logs, the effects that `identify` fits, and those with which each `diagnose`
    starts.
    """

    machine: str
    log: str
    note: str = ""
    error_goal: Share | None = None
    effects: tuple[str, ...]
    diagnose_with: tuple[tuple[str, ...], ...] = ((),)
    known: tuple[KnownValue, ...]


class _KnownFile(UserTable):
    machines: Mapping[str, MachineTable]


@dataclass(frozen=True)
class AgainstKnown:
    """An estimate and its known value. value, std: None if the model has no such quantity or no standard error.

    uncertainty: of the reference, goal: for the estimate, both relative to `known`. fixed: whether the value was given,
    not estimated.
    """

    quantity: str
    place: str
    unit: str
    value: float | None
    std: float | None
    known: float | None
    uncertainty: float = 0.0
    goal: float | None = None
    fixed: bool = False

    @property
    def off(self) -> float | None:
        """Difference of the estimate from the reference, relative to the reference's size."""
        if self.value is None or not self.known:
            return None
        return (self.value - self.known) / abs(self.known)

    @property
    def claimed(self) -> float | None:
        """Twice the standard error, relative to the reference's size."""
        if self.std is None or not self.known:
            return None
        return WITHIN * self.std / abs(self.known)

    @property
    def inside(self) -> bool | None:
        """Whether the difference is within twice the standard error plus the reference's uncertainty.

        None without an estimate or a reference, or if the value was given.
        """
        if self.off is None or self.fixed:
            return None
        if self.claimed is None:  # not determined
            return False
        return abs(self.off) <= self.claimed + self.uncertainty

    @property
    def reached(self) -> bool | None:
        """Whether the goal is reached; None without a goal, or if the value was given."""
        if self.goal is None or self.fixed:
            return None
        return self.off is not None and abs(self.off) <= self.goal


@cache
def known_machines() -> Mapping[str, MachineTable]:
    """Machines by name, sorted."""
    return read_toml(Path(__file__).with_name("known.toml"), _KnownFile).machines


def compared(model: Mapping[str, Any], known: tuple[KnownValue, ...]) -> tuple[AgainstKnown, ...]:
    """All drive gains, and all other known quantities, with their known values. model: as in its JSON file."""
    rows = [_row(model, known_value, place) for known_value in known for place in known_value.values]
    determined = {row.place for row in rows if row.quantity == DRIVE_GAIN}
    others = [_gain(model, joint, None) for joint in model["drive_gains"] if joint not in determined]
    return (*others, *rows)


def _gain(model: Mapping[str, Any], joint: str, known: KnownValue | None) -> AgainstKnown:
    gain = model["drive_gains"].get(joint)
    fitted = model["gains_fitted"] if gain is None else gain.get("fitted", model["gains_fitted"])
    return _comparison_row(DRIVE_GAIN, joint, gain, known, fixed=not fitted)


def _row(model: Mapping[str, Any], known: KnownValue, place: str) -> AgainstKnown:
    if known.of == DRIVE_GAIN:
        return _gain(model, place, known)
    if known.of == PARAMETER:
        estimate = next((parameter for parameter in model["parameters"] if parameter["name"] == place), None)
        return _comparison_row(PARAMETER, place, estimate, known)
    return _comparison_row(f"{known.of} {known.parameter}", place, _felt(model, known, place), known)


def _felt(model: Mapping[str, Any], known: KnownValue, place: str) -> Mapping[str, Any] | None:
    """An effect's parameter, or the weighted sum over motors that acts at a joint, with independent standard errors."""
    by_place = model["effect_parameters"].get(known.of, {})
    factors = known.felt.get(place, {place: 1.0})
    if any(known.parameter not in by_place.get(motor, {}) for motor in factors):
        return None
    parts = [(factor, by_place[motor][known.parameter]) for motor, factor in factors.items()]
    stds = [factor * part["std"] for factor, part in parts if part["std"] is not None]
    return {
        "value": sum(factor * part["value"] for factor, part in parts),
        "std": hypot(*stds) if len(stds) == len(parts) else None,
        "unit": parts[0][1]["unit"],
    }


def _comparison_row(
    quantity: str,
    place: str,
    parameter: Mapping[str, Any] | None,
    known: KnownValue | None,
    *,
    fixed: bool = False,
) -> AgainstKnown:
    estimate = parameter or {"value": None, "std": None, "unit": ""}
    return AgainstKnown(
        quantity,
        place,
        estimate["unit"],
        estimate["value"],
        estimate["std"],
        None if known is None else known.values[place],
        0.0 if known is None else known.uncertainty,
        None if known is None else known.goal_at(place),
        fixed,
    )
