"""Columns of effects that the model's parameters absorb, so that no fit can distinguish them."""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from bench.effects import EffectInstance
from bench.effects.select import parameter_slices
from bench.identification.compressed import Stack, triangular_factors
from bench.identification.decision import RULE
from bench.identification.finding import Code, Finding, Unknown
from bench.identification.layout import ParameterLayout
from bench.identification.solution import NominalGains, Solution
from bench.identification.standard_errors import Deviations, Uncertainty, uncertainty
from bench.identification.tolerances import TOLERANCES


def identifiable_columns(
    stack: Stack,
    layout: ParameterLayout,
    gains: NominalGains,
    span: Callable[[np.ndarray], np.ndarray] | None = None,
) -> np.ndarray:
    """Indices of the columns of phi, without effect columns that depend on the columns before them.

    With known gains, those of redundant motors' gains are omitted. With unknown gains, the known payload's torque,
    which fixes the scale, counts among the columns before: an effect that imitates it, such as a wrong mass of the only
    payload, would remove the scale. span: gives an orthonormal basis (n, r, b) of these columns (k,) of the motors'
    factors, where known.
    """
    p, first = layout.size, layout.size - layout.effects
    kept = list(range(first if np.any(gains.fitted) else first - layout.redundant))
    if not layout.effects:
        return np.array(kept, dtype=int)
    rows = stack.factors.reshape(-1, p + 2)
    base_columns = np.array([*kept, p] if np.any(gains.fitted) else kept, dtype=int)
    basis = orthonormal(rows[:, base_columns]) if span is None else span(base_columns).reshape(len(rows), -1)
    scale = np.linalg.norm(rows[:, :first], axis=0).max(initial=0.0)
    if _all_independent(rows[:, first:p], basis, TOLERANCES.rank.torque * scale):
        return np.array([*kept, *range(first, p)])
    for index in range(first, p):
        column = rows[:, index]
        size = float(np.linalg.norm(column))
        if size <= TOLERANCES.rank.torque * scale:
            continue
        orthogonal = column / size
        for _ in range(2):
            orthogonal = orthogonal - basis @ (basis.T @ orthogonal)
        remainder = float(np.linalg.norm(orthogonal))
        if remainder > TOLERANCES.rank.independent:
            kept.append(index)
            basis = np.column_stack((basis, orthogonal / remainder))
    return np.array(kept)


def _all_independent(columns: np.ndarray, basis: np.ndarray, nothing: float) -> bool:
    """Whether every column (R, e) exceeds `nothing`, and keeps enough outside a basis (R, r) and the columns before it.

    All at once: the diagonal of their triangular factor holds each remainder.
    """
    sizes = np.linalg.norm(columns, axis=0)
    if sizes.min(initial=np.inf) <= nothing:
        return False
    orthogonal = columns / sizes
    for _ in range(2):
        orthogonal = orthogonal - basis @ (basis.T @ orthogonal)
    triangle = np.asarray(np.linalg.qr(orthogonal, mode="r"))
    return len(triangle) == len(sizes) and bool(
        np.all(np.abs(triangle.diagonal()) > TOLERANCES.rank.independent)
    )


def orthonormal(columns: np.ndarray) -> np.ndarray:
    """An orthonormal basis (R, r) of the span of columns (R, p)."""
    norms = np.linalg.norm(columns, axis=0)
    norms[norms == 0.0] = 1.0
    vectors, singular, _ = np.linalg.svd(columns / norms, full_matrices=False)
    return np.asarray(vectors[:, singular > 1e-12 * singular[0]])


def collinear(
    effects: Sequence[EffectInstance], covariance: np.ndarray, rows: Sequence[Unknown]
) -> list[Finding]:
    """A finding for each combination of effects that change the model itself (encoder zeros, a tilt, lengths) that is
    known far better than its parameters one by one.

    covariance (P, P), its rows named. The eigenvector of a small eigenvalue of their correlation is the known
    combination; each parameter by itself is known 1 / sqrt(eigenvalue) times less precisely.
    """
    changing = {instance.key for instance in effects if instance.effect.depends_on_model}
    indices = [
        i
        for i, row in enumerate(rows)
        if row.kind == "effect" and (row.effect, row.place) in changing and covariance[i, i] > 0.0
    ]
    if len(indices) < 2:
        return []
    std = np.sqrt(np.diag(covariance)[indices])
    values, vectors = np.linalg.eigh(covariance[np.ix_(indices, indices)] / np.outer(std, std))
    findings = []
    for value, vector in zip(values, vectors.T, strict=True):
        if value * TOLERANCES.findings.widened**2 >= 1.0:
            break
        part = np.flatnonzero(np.abs(vector) >= TOLERANCES.findings.takes_part * np.abs(vector).max())
        together = tuple(rows[indices[i]] for i in part)
        if len({(unknown.effect, unknown.place) for unknown in together}) > 1:
            wider = float(1.0 / np.sqrt(max(value, np.finfo(float).eps)))
            findings.append(Finding(Code.HARDLY_APART, of=together, numbers={"wider": wider}))
    return findings


def unsettled(
    effects: Sequence[EffectInstance], values: np.ndarray, std: np.ndarray
) -> list[tuple[int, Unknown]]:
    """Indices of effect parameters away from where their effect was linearised: their search did not converge.

    values, std (k,): of all parameters of all effects, one effect after the other.
    """
    findings = []
    for instance, part in parameter_slices(effects):
        about = instance.effect.about_values()
        for at, parameter in enumerate(instance.effect.parameters, part.start):
            value, place = float(values[at]), about.get(parameter.name, 0.0)
            off = abs(value - place)
            if (
                place
                and off > RULE.shows * std[at]
                and off > TOLERANCES.steps.linearisation_reached * max(abs(value), abs(place))
            ):
                findings.append((at, Unknown("effect", parameter.name, instance.place, instance.name)))
    return findings


Solve = Callable[[Stack, np.ndarray], Solution]


def reduced(stack: Stack, kept: np.ndarray) -> Stack:
    """The equations with only columns kept (k,) of phi."""
    p = stack.phi.shape[2]
    factors = triangular_factors(stack.factors[:, :, [*kept, p, p + 1]].swapaxes(0, 1))
    return replace(stack, phi=stack.phi[:, :, kept], factors=factors)


def essential_columns(stack: Stack, candidates: int, solve: Solve, deviations: Deviations) -> np.ndarray:
    """Indices of the columns to keep: some of the first `candidates` are omitted one by one.

    The one with the largest relative deviation goes first, as long as that deviation is above 30 % and the
    error of the currents grows by less than 1 % in all (Gautier and Khalil; Khalil and Dombre 2002, 12.3).
    """
    kept = np.arange(stack.phi.shape[2])
    solution = solve(stack, kept)
    reference = _current_error(stack, solution)
    current = stack
    while True:
        spread = uncertainty(current, solution, deviations)
        std = np.sqrt(np.maximum(np.diag(spread.covariance)[: len(kept)], 0.0))
        size = np.abs(solution.theta)
        relative = np.where(kept < candidates, std / np.maximum(size, np.finfo(float).tiny), 0.0)
        worst = int(np.argmax(relative))
        if relative[worst] <= RULE.loose:
            return kept
        fewer = np.delete(kept, worst)
        smaller = reduced(stack, fewer)
        candidate = solve(smaller, fewer)
        if _current_error(smaller, candidate) > TOLERANCES.findings.omitted_growth * reference:
            return kept
        kept, current, solution = fewer, smaller, candidate


def expanded(
    solution: Solution, spread: Uncertainty, kept: np.ndarray, size: int
) -> tuple[Solution, Uncertainty]:
    """The solution with zeros for the parameters that were omitted.

    The covariance, of [kept parameters, shape parameters, gains], is put in the order [all parameters, gains,
    shape parameters].
    """
    theta = with_zeros(solution.theta, kept, size)
    n, k = len(solution.gains), len(kept)
    shapes = len(spread.covariance) - k - n
    index = np.concatenate((kept, size + n + np.arange(shapes), size + np.arange(n)))
    covariance = np.zeros((size + n + shapes,) * 2)
    covariance[np.ix_(index, index)] = spread.covariance
    return replace(solution, theta=theta), replace(spread, covariance=covariance)


def with_zeros(values: np.ndarray, kept: np.ndarray, size: int) -> np.ndarray:
    """An array (size,) of zeros with values (k,) at indices kept (k,)."""
    every = np.zeros(size)
    every[kept] = values
    return every


def _current_error(stack: Stack, solution: Solution) -> float:
    modelled = (stack.phi @ solution.theta + stack.kappa) / solution.gains
    return float(np.sqrt(((stack.current - modelled) ** 2).mean()))
