"""Sets of effects, solved together, which share the overhead of Python."""

from collections.abc import Iterable, Iterator, Sequence

import numpy as np

from bench.diagnosis.motor_products import MotorProducts, products_of_sets
from bench.diagnosis.system import SetFit, System, fit_of, start_of
from bench.identification.bilinear import OnProducts
from bench.identification.gauss_newton import Until, minimised
from bench.identification.tolerances import TOLERANCES


def solve_set(system: System, chosen: Sequence[int]) -> SetFit:
    """Least squares of the current's error with the base columns and the chosen candidates."""
    (fit,) = solve_sets(system, [chosen])
    return fit


def solve_sets(system: System, sets: Iterable[Sequence[int]]) -> list[SetFit]:
    """As `solve_set` for each, in their order."""
    keys = [tuple(sorted(members)) for members in sets]
    unknown = dict.fromkeys(key for key in keys if key not in system.solved)
    for chunk in _alike(system, sorted((len(system.independent(key)), key) for key in unknown)):
        system.solved.update(_together(system, chunk))
    return [system.solved[key] for key in keys]


def enlarged(chosen: Sequence[int], others: Sequence[int]) -> list[tuple[int, ...]]:
    """The chosen ones with each of the others added."""
    return [(*chosen, i) for i in others]


def reduced(chosen: Sequence[int]) -> list[tuple[int, ...]]:
    """The chosen without each of them."""
    return [tuple(c for c in chosen if c != k) for k in chosen]


def swapped(chosen: Sequence[int], others: Sequence[int]) -> list[tuple[int, ...]]:
    """The chosen with each of the others in the place of each."""
    return [(*(c for c in chosen if c != k), i) for i in others for k in chosen]


def _alike(system: System, sized: Sequence[tuple[int, tuple[int, ...]]]) -> Iterator[list[tuple[int, ...]]]:
    """Groups of sets with similar numbers of unknowns, the fewest first, that fit into the cache."""
    chunk: list[tuple[int, ...]] = []
    fewest = 0
    for size, key in sized:
        added = size - system.base + 2
        room = TOLERANCES.memory.set_bytes // (
            8 * (len(system.start.gains) * (size + 2) * added + (size + 2) ** 2)
        )
        if chunk and (size > TOLERANCES.search.together_unknowns * fewest or len(chunk) >= room):
            yield chunk
            chunk = []
        if not chunk:
            fewest = size
        chunk.append(key)
    if chunk:
        yield chunk


def _together(system: System, keys: Sequence[tuple[int, ...]]) -> dict[tuple[int, ...], SetFit]:
    """Sets with similar numbers of unknowns; the smaller ones are padded with zero columns."""
    start, base, bounds = system.start, system.base, TOLERANCES.steps
    columns, begun, gains = zip(*(start_of(system, key) for key in keys), strict=True)
    wide = max(map(len, columns))
    values = np.array([np.pad(each, (0, wide - len(each))) for each in begun])
    added = [each[base:] for each in columns]

    def at(products: MotorProducts, values: np.ndarray, gains: np.ndarray) -> OnProducts:
        of_sets = products_of_sets(products, base, added, wide - base)
        return OnProducts.at(of_sets, start.gains, start.gains_fitted, values, gains)

    until = Until(
        bounds.set_converged, reach=bounds.runaway_factor, tolerance_beyond=bounds.runaway_set_converged
    )
    fitted = minimised(at(system.fitted, values, np.array(gains)), start.gains, start.weights, until)
    held_out = at(system.held_out, fitted.values, fitted.gains)
    return {
        key: fit_of(
            system,
            key,
            columns[i],
            fitted.values[i, : len(columns[i])],
            fitted.gains[i],
            float(fitted.squares[i] @ start.weights**2),
            np.stack((fitted.squares[i], held_out.squares[i])),
        )
        for i, key in enumerate(keys)
    }
