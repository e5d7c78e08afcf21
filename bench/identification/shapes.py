"""The shape in which an effect explains most of a model's error."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import product

import numpy as np

from bench.effects import Bracket, EffectInstance, JointSamples, ShapeParameter
from bench.identification.bounded import minimum_between
from bench.identification.decision import RULE
from bench.identification.joint_samples import joint_samples, stands_still
from bench.identification.newton import within_reach
from bench.identification.partial_regression import PartialRegression, RegressionProducts
from bench.identification.prepare import Prepared
from bench.identification.solve_only import candidate_columns, reshaped
from bench.identification.tolerances import TOLERANCES


def best_shape(prepared: Prepared, instance: EffectInstance, partial: PartialRegression) -> EffectInstance:
    """The instance with the shape values that explain most of the error.

    For every combination of discrete values, the other parameters are searched one after the other, from every start of
    the effect if the first explains a share that is worth an effect. At a motor at rest the shape stays, since nothing
    depends on it.
    """
    if stands_still(prepared, instance):
        return instance
    samples = joint_samples(prepared, instance, partial.lacks)
    shape = instance.effect.shape
    free = [parameter for parameter in shape if not parameter.discrete]
    if not free:
        free = list(shape)
    choices = [list(shape_parameter.candidates) for shape_parameter in shape if shape_parameter not in free]
    best, least = instance, np.inf
    starts = [
        replace(instance, effect=effect)
        for effect in instance.effect.starts(prepared.fitted_signals, instance.joint)
    ]
    for start, chosen in product(starts, product(*choices)):
        if start is not starts[0] and -least < RULE.material * partial.sum_of_squares:
            break
        names = [shape_parameter.name for shape_parameter in shape if shape_parameter not in free]
        tried = reshaped(start, dict(zip(names, chosen, strict=True)))
        for parameter in free:
            tried, cost = _searched(prepared, tried, parameter, samples, partial)
        if cost < least:
            best, least = tried, cost
    return best


def _searched(
    prepared: Prepared,
    instance: EffectInstance,
    parameter: ShapeParameter,
    samples: tuple[JointSamples, ...],
    partial: PartialRegression,
) -> tuple[EffectInstance, float]:
    """One shape parameter at its best value, and minus the squares explained with it.

    The present value competes, so that the effect never explains less.
    """

    def columns(values: Sequence[float]) -> np.ndarray:
        return candidate_columns(prepared, [reshaped(instance, {parameter.name: x}) for x in values])

    brackets = instance.effect.brackets(parameter, samples)
    if not parameter.discrete and any(low < high for low, _, high in brackets):
        present = instance.effect.shape_values()[parameter.name]
        low, high = within_reach(present, instance.effect.brackets_near(parameter, samples))
        nearby = TOLERANCES.shapes.nearby
        near = (max(present * (1.0 - nearby), low), present, min(present * (1.0 + nearby), high))
        brackets = (*brackets, near)
    tried = np.split(columns([value for _, value, _ in brackets]), len(brackets), axis=2)
    costs = [-partial.explained(values)[1] for values in tried]
    best = int(np.argmin(costs))
    (low, middle, high), cost = brackets[best], costs[best]
    if low < high:
        if all(seen.expands for seen in prepared.signals):
            unexplained = _between_nodes(columns, brackets[best], partial)
        else:

            def unexplained(value: float) -> float:
                return -partial.explained(columns([float(value)]))[1]

        place, value = minimum_between(
            unexplained, low, high, TOLERANCES.shapes.tolerance * max(abs(low), abs(high))
        )
        if value < cost:
            middle, cost = place, value
    return reshaped(instance, {parameter.name: middle}), cost


def _between_nodes(
    columns: Callable[[Sequence[float]], np.ndarray], bracket: Bracket, partial: PartialRegression
) -> Callable[[float], float]:
    """Minus the squares explained with a value, from columns interpolated between a bracket's Chebyshev points.

    Interpolated by the polynomial through them (Berrut and Trefethen, "Barycentric Lagrange interpolation", SIAM
    Review 46(3), 2004), of the value or of its logarithm.
    """
    low, _, high = bracket
    logarithmic = low > 0.0 and high > TOLERANCES.shapes.logarithmic * low
    ends = np.log([low, high]) if logarithmic else np.array([low, high])
    steps = np.arange(TOLERANCES.shapes.nodes)
    places = ends.mean() - 0.5 * (ends[1] - ends[0]) * np.cos(np.pi * steps / steps[-1])
    nodes = np.clip(np.exp(places) if logarithmic else places, low, high)
    signs = (-1.0) ** steps
    signs[[0, -1]] *= 0.5
    every = partial.products(columns(nodes.tolist()))
    nodes = TOLERANCES.shapes.nodes
    count = len(every.towards) // nodes
    inner, towards = every.inner.reshape(nodes, count, nodes, count), every.towards.reshape(nodes, count)
    lengths = every.lengths.reshape(nodes, count)

    def unexplained(value: float) -> float:
        off = (np.log(value) if logarithmic else value) - places
        near = np.abs(off) < 1e-14 * max(abs(ends[0]), abs(ends[1]))
        weights = near.astype(float) if near.any() else signs / off
        weights /= weights.sum()
        normal = np.einsum("a,aibj,b->ij", weights, inner, weights)
        return -RegressionProducts(normal, weights @ towards, np.abs(weights) @ lengths).explained()[1]

    return unexplained
