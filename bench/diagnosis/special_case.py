"""A special case of an identified effect in the shape that this has, so that both are compared at their best."""

from collections.abc import Sequence

from bench.diagnosis.candidates import Context
from bench.effects import EffectInstance
from bench.identification.decision import RULE
from bench.identification.solve_only import candidate_columns, reshaped


def with_shapes_of(
    wholes: Sequence[EffectInstance], parts: Sequence[EffectInstance]
) -> tuple[EffectInstance, ...]:
    """The special cases of an effect with the values that this has at their joints of parameters of the same name."""
    values = {whole.joint: whole.effect.shape_values() for whole in wholes}
    result = []
    for part in parts:
        there = values.get(part.joint, {})
        result.append(
            reshaped(part, {name: there[name] for name in part.effect.shape_values() if name in there})
        )
    return tuple(result)


def explaining_most(context: Context, *tried: tuple[EffectInstance, ...]) -> tuple[EffectInstance, ...]:
    """The instances that explain most, all together, of what a model leaves."""
    return max(tried, key=lambda instances: _explained(context, instances))


def explains(context: Context, instances: Sequence[EffectInstance]) -> bool:
    """Whether instances take a clear share away of what a model leaves of the fitted recordings."""
    return (
        _explained(context, instances)
        > (1.0 - (1.0 - RULE.material) ** 2) * context.regression.sum_of_squares
    )


def _explained(context: Context, instances: Sequence[EffectInstance]) -> float:
    return float(context.regression.explained(candidate_columns(context.prepared, instances))[1])
