"""A first solution of a model, as exact as inner products are: for a search, which looks at thousands.

Every motor's compressed factors are multiplied once, in a basis in which they are nearly orthonormal. Each start, each
reweighting and each step then takes sums of these products alone.
"""

from dataclasses import replace

import numpy as np

from bench.identification.bilinear import TINY, least, squares_of
from bench.identification.centred import Centred, FactorProducts, products_of
from bench.identification.compressed import Stack
from bench.identification.current_error import current_error, error_weights, from_products, squared_errors
from bench.identification.least_squares import REWEIGHTINGS, weighted_least_squares
from bench.identification.solution import NominalGains, Solution

CHANCE = 1e-3  # nats: steps that creep are followed no further where chance makes more of the errors
ANEW = 100  # times that products are counted anew as gains run away
UNLIKE = 100.0  # ratio of the motors' scales from which a basis is made anew for others
FLOOR = 1e-9  # least error of a motor, of the largest torque


def solved_from_products(stack: Stack, gains: NominalGains, near: np.ndarray) -> Solution:
    """The current-domain solution, nearer to the best one than any deviation; near (n,): gains of a model much like it.

    It starts from weighted least squares with the gains among the unknowns, or held near, whichever leaves less.
    """
    lengths = np.linalg.norm(stack.factors[:, :, -1], axis=1)
    scale = 1.0 / np.maximum(np.abs(gains.values) * lengths, TINY)
    products = products_of(stack.factors, scale)
    starts = []
    if gains.fitted:
        about, values = _held(products, gains.values, lengths)
        about = products.about(about.theta_at(values), gains.values)  # from where products are exact enough
        values, first = _weighted(about, lengths, fit_gains=True)
        starts.append((about.theta_at(values), first))
    if not gains.fitted or not np.array_equal(near, gains.values):
        about, values = _held(products, near, lengths)
        starts.append((about.theta_at(values), near))
    errors = [squared_errors(stack.factors, *start) for start in starts]
    best = int(np.argmin([np.log(np.maximum(squares, TINY)).sum() for squares in errors]))
    start = Solution(*starts[best], np.ones(len(near)), "torque", gains.fitted)
    weights = error_weights(stack, errors[best])
    ratio = weights / np.abs(start.gains) / scale
    if ratio.max() > UNLIKE * ratio.min():
        products = products_of(stack.factors, weights / start.gains)
    unseen = 2.0 * CHANCE / max(int(stack.moving.sum()), 1)
    found = from_products(stack, products, start, weights, unseen=unseen, anew=ANEW)
    if found is None:
        return current_error(stack, weighted_least_squares(stack, gains))
    return replace(
        found, weights=error_weights(stack, squared_errors(stack.factors, found.theta, found.gains))
    )


def _held(products: FactorProducts, gains: np.ndarray, lengths: np.ndarray) -> tuple[Centred, np.ndarray]:
    """The same with the gains (n,) held: the system about no parameters, and the values (b,)."""
    about = products.about(np.zeros(len(products.basis)), gains)
    return about, _weighted(about, lengths, fit_gains=False)[0]


def _weighted(about: Centred, lengths: np.ndarray, *, fit_gains: bool) -> tuple[np.ndarray, np.ndarray]:
    """Values (b,) and gains (n,) of weighted least squares of the torques' errors; see `weighted_least_squares`.

    lengths (n,): of the currents.
    """
    start, b, n = about.gains, about.basis.shape[1], len(about.gains)
    columns, current = np.zeros((n, b + 2, b + (n if fit_gains else 0))), np.zeros((n, b + 2))
    columns[:, :b, :b] = np.eye(b)
    current[:, b], current[:, b + 1] = 1.0 / start, 1.0  # every motor's, of [columns, torque, error]
    right = np.zeros((n, b + 2))
    right[:, b + 1] = start
    if fit_gains:
        columns[np.arange(n), :, b + np.arange(n)] = -current
    normal = columns.swapaxes(1, 2) @ about.inner @ columns
    towards = (columns.swapaxes(1, 2) @ (about.inner @ right[:, :, None]))[:, :, 0]
    weights = np.ones(n)
    for left in range(REWEIGHTINGS, -1, -1):
        squares = weights**2
        found = least(np.tensordot(squares, normal, axes=1), squares @ towards)
        gains = start + found[b:] if fit_gains else start
        if left:
            errors = right - columns @ found
            size = lengths * np.abs(gains)
            weights = 1.0 / np.maximum(np.sqrt(squares_of(about.inner, errors)), FLOOR * size.max() + TINY)
    return found[:b], gains
