"""Units of laws: powers of N*m or N, rad or m, and s, multiplied and written."""

from collections.abc import Mapping

Unit = Mapping[str, float]
"""Powers by symbol: `{effort}` and `{angle}` of the motor at which the law sits, or units such as s."""


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
