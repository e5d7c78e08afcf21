"""The variables of laws: a motor's motion and load, those of other motors, the load of all others together, the tool's
speed, and the time.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from bench.basics.joint_units import joint_units

Unit = Mapping[str, float]
"""Powers by symbol: `{effort}` and `{angle}` of the law's motor, or units such as s."""


def times(*units: Unit, power: float = 1.0) -> dict[str, float]:
    """The product of units, raised to a power."""
    total: dict[str, float] = {}
    for unit in units:
        for symbol, exponent in unit.items():
            total[symbol] = total.get(symbol, 0.0) + power * exponent
    return {symbol: exponent for symbol, exponent in total.items() if exponent}


def written(unit: Unit) -> str:
    """Such as "{effort}*s^2/{angle}"; "1" of nothing."""
    over = [_raised(symbol, exponent) for symbol, exponent in unit.items() if exponent > 0.0]
    under = [_raised(symbol, -exponent) for symbol, exponent in unit.items() if exponent < 0.0]
    below = f"({'*'.join(under)})" if len(under) > 1 else "".join(under)
    return f"{'*'.join(over) or '1'}{'/' if below else ''}{below}"


def _raised(symbol: str, exponent: float) -> str:
    return symbol if exponent == 1.0 else f"{symbol}^{exponent:.3g}"


Kind = Literal["position", "velocity", "acceleration", "load", "time", "tool_speed", "others_load"]
SYMBOLS: dict[Kind, str] = {
    "position": "q",
    "velocity": "v",
    "acceleration": "a",
    "load": "load",
    "time": "t",
    "tool_speed": "tool_speed",
    "others_load": "others_load",
}
MEANINGS: dict[Kind, str] = {
    "position": "position, rad or m",
    "velocity": "velocity, rad/s or m/s",
    "acceleration": "acceleration, rad/s2 or m/s2",
    "load": "torque or force of the motor, N*m or N",
    "time": "time from the start of the recording, s",
    "tool_speed": "speed of the tool, m/s",
    "others_load": "torque or force of all other motors together, N*m or N",
}
OF_A_MOTOR: tuple[Kind, ...] = ("position", "velocity", "acceleration", "load")
UNITS: dict[Kind, Unit] = {
    "position": {"{angle}": 1.0},
    "velocity": {"{angle}": 1.0, "s": -1.0},
    "acceleration": {"{angle}": 1.0, "s": -2.0},
    "load": {"{effort}": 1.0},
    "time": {"s": 1.0},
    "tool_speed": {"m": 1.0, "s": -1.0},
    "others_load": {"{effort}": 1.0},
}


@dataclass(frozen=True, order=True)
class Variable:
    """A variable; ahead: of the motor that many places further in the robot's order, 0: of the law's motor."""

    kind: Kind
    ahead: int = 0

    @property
    def depends_on_model(self) -> bool:
        """Whether its values depend on the model."""
        return self.kind in ("load", "others_load")

    def motor(self, place: "Place") -> str:
        """The motor whose variable it is, for a law at a place."""
        return place.motors[(place.index + self.ahead) % len(place.motors)]

    def symbol(self, place: "Place") -> str:
        """Such as v, or v_right of another motor."""
        name = SYMBOLS[self.kind]
        return f"{name}_{self.motor(place)}" if self.ahead else name

    def unit(self, place: "Place") -> Unit:
        """In symbols of the law's motor, or in plain units for a motor of another kind."""
        exponents = UNITS[self.kind]
        rotates = place.rotates[(place.index + self.ahead) % len(place.motors)]
        if rotates == place.rotates[place.index]:
            return exponents
        units = joint_units(rotates)
        plain = {"{effort}": units.effort, "{angle}": units.position}
        return {plain.get(symbol, symbol): exponent for symbol, exponent in exponents.items()}


@dataclass(frozen=True)
class Place:
    """The motor at which a law acts, among all motors of the robot."""

    motors: tuple[str, ...]
    rotates: tuple[bool, ...]
    index: int

    @property
    def name(self) -> str:
        """The name of the motor."""
        return self.motors[self.index]


@dataclass(frozen=True)
class Seen:
    """Signals for a law at a motor, M samples of all recordings one after the other.

    values (M,) by variable; parts: the recordings; interval s between samples.
    """

    values: Mapping[Variable, np.ndarray]
    parts: Sequence[slice]
    interval: float
