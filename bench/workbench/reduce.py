"""A few columns from which an effect's columns at every value are combined."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from bench.workbench.variants import Piece, Variants

KEPT = 1e-5  # of a column's length: what is left out of it at most
KEPT_FOLLOWING = 1e-4  # the same of an effect that follows the present model, small beside what it follows
DRAWN, DRAWN_FOLLOWING = 1e-2, 5e-2  # the same, where curves are drawn
MOST_BYTES = 800_000  # of the triangles of all motors together
FULL, SHORT = 4, 2  # bytes of a number
MOST_SHORT_BYTES = 900_000  # the same at half the length, where they are more


@dataclass(frozen=True)
class Reduced:
    """An effect by columns of its own: columns (M, n, b), torque at a value of one of whatever they stand for.

    tables: for every piece of the effect's scalar (one for a linear effect) coefficients (G, D, k, b): column k at
    node G is columns @ tables[piece][G, 0, k] in the found model; the other D add the directions in which the present
    model differs from it. drawn: how many of the columns a curve needs, the first ones. left_out (b,): of a column's
    length, what the columns before leave out; infinite where every column is a parameter's own.
    """

    variants: Variants
    columns: np.ndarray
    tables: tuple[np.ndarray, ...]
    drawn: int
    left_out: np.ndarray


def reduced(variants: Variants, rows: np.ndarray, seen: np.ndarray, parts: int = 1) -> Reduced:
    """Keep a few directions of the columns of all `variants.every`.

    rows (M, n, E D k): the columns of `every`, one effect after the other, each of D parts of the present model;
    seen (M, n): which rows are used.
    """
    parameters = len(variants.instance.effect.parameters)
    if variants.kind == "linear" and parts == 1:
        return Reduced(
            variants, rows, (np.eye(parameters)[None, None],), parameters, np.full(parameters, np.inf)
        )
    flat = (rows * seen[:, :, None]).reshape(-1, rows.shape[2])
    lengths = np.linalg.norm(flat, axis=0).reshape(-1, parts, parameters)
    lengths = (
        np.broadcast_to(lengths[:, :1], lengths.shape).reshape(-1).copy()
    )  # as long as in the found model
    lengths[lengths == 0.0] = 1.0
    triangle = np.linalg.qr(flat[flat.any(axis=1)] / lengths, mode="r")
    _, singular, right = np.linalg.svd(triangle, full_matrices=False)
    left_out = np.sqrt(np.cumsum((singular**2)[::-1])[::-1])
    kept, drawn = (KEPT_FOLLOWING, DRAWN_FOLLOWING) if variants.follows else (KEPT, DRAWN)
    size = max(int(np.sum(left_out > kept)), 1)
    # rows / lengths ~ (rows / lengths) V V', so that the kept columns are (rows / lengths) V
    vectors = right[:size].T
    columns = rows @ (vectors / lengths[:, None])
    coefficients = (vectors * lengths[:, None]).reshape(-1, parts, parameters, size)
    edges = np.cumsum([len(piece.nodes) for piece in variants.pieces])[:-1]
    tables = tuple(np.split(coefficients, edges))
    return Reduced(variants, columns, tables, max(int(np.sum(left_out > drawn)), 1), left_out[:size])


def many(parts: Sequence[Reduced], own: int) -> bool:
    """Whether the effects have more columns, beside the model's own, than a page can carry at full length."""
    return _numbers([_at_motors(one) for one in parts], own) * FULL > MOST_BYTES


def within_reach(parts: Sequence[Reduced], own: int, triangles: int = 2) -> tuple[Reduced, ...]:
    """The effects with as many columns as a page can carry beside the model's own: the least ones go first.

    triangles: how many a page carries of each motor.
    """
    if not many(parts, own):
        return tuple(parts)
    share = KEPT
    filled = [_at_motors(one) for one in parts]
    sizes = [len(one.left_out) for one in parts]
    while share < 1.0:
        kept = [one[:, :size] for one, size in zip(filled, sizes, strict=True)]
        if _numbers(kept, own) * SHORT * triangles <= 2 * MOST_SHORT_BYTES:
            break
        share *= 1.5
        sizes = [max(int(np.sum(one.left_out > share)), 1) for one in parts]
    return tuple(_shortened(one, size) for one, size in zip(parts, sizes, strict=True))


def _at_motors(part: Reduced) -> np.ndarray:
    """Which of an effect's columns are more than zero at each motor (n, b)."""
    return np.asarray(part.columns.any(axis=0))


def _numbers(filled: Sequence[np.ndarray], own: int) -> int:
    """In two triangles for each motor: of fitted and of judged recordings."""
    counts = own + sum(one.sum(axis=1) for one in filled)
    return int(2 * np.sum(counts * (counts + 1.0) / 2.0))


def _shortened(part: Reduced, size: int) -> Reduced:
    if size >= len(part.left_out):
        return part
    return replace(
        part,
        columns=part.columns[:, :, :size],
        tables=tuple(one[..., :size] for one in part.tables),
        drawn=min(part.drawn, size),
        left_out=part.left_out[:size],
    )


def coefficients_at(piece: Piece, table: np.ndarray, value: float) -> np.ndarray:
    """Coefficients (D, k, b) at a value within a piece: a polynomial through all nodes, in barycentric form.

    Source: Berrut and Trefethen, "Barycentric Lagrange interpolation", SIAM Review 46(3), 2004.
    """
    places = piece.places
    place = np.log(value) if piece.logarithmic else value
    place = min(max(place, places[0]), places[-1])
    near = np.abs(places - place)
    if near.min() <= 1e-14 * max(abs(places[0]), abs(places[-1])) or len(places) == 1:
        return np.asarray(table[int(near.argmin())])
    between = (places[:, None] - places) * (4.0 / (places[-1] - places[0])) + np.eye(len(places))
    shares = 1.0 / between.prod(axis=1) / (place - places)
    return np.asarray(np.tensordot(shares / shares.sum(), table, axes=1))
