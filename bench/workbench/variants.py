"""An effect's columns at every value that they may be asked for, from a few columns that are kept."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from bench.effects import ActuatorEffect, Bracket, Effect, EffectInstance, RobotSignals, ShapeParameter
from bench.identification.newton import NEARBY
from bench.identification.nonlinear import MOST_ROUNDS

NODES, FEW_NODES = (
    26,
    18,
)  # at which a continuous shape parameter is evaluated within its range; of many effects
WINDOW_NODES = 11  # the same within a narrow bracket
WINDOW = 2.0  # ratio of a bracket's ends below which it counts as narrow
TIME_NODES = 9  # of a time, or a share, about which columns are linearised
PHASE = 1.2  # rad that a delay may turn the highest frequency that the fit sees
SCALES = ("none", "gain", "gain_size")


@dataclass(frozen=True)
class Piece:
    """A stretch of a scalar on which columns are interpolated between nodes (G,), rising.

    logarithmic: between logarithms. One node alone is a value with nothing around it. branch: of the effect's
    branches, the one to which it belongs.
    """

    nodes: np.ndarray
    logarithmic: bool
    branch: int = 0

    @property
    def places(self) -> np.ndarray:
        """The nodes as the interpolation sees them (G,)."""
        return np.log(self.nodes) if self.logarithmic else self.nodes


@dataclass(frozen=True)
class Variants:
    """An effect at one place, and the scalar by which its columns change.

    kind: "linear" (they do not), "shape" (a shape parameter, searched in `brackets`) or "value" (the value of its
    linear parameter). branches: combinations of values of its other, discrete shape parameters; brackets: of each.
    approximate: the columns also follow the present model in a way that is left out. scale: what multiplies columns,
    see SCALES: the motor's drive gain, its size, or nothing. windows: `brackets` follow from the error that other
    effects leave. follows: what of the present model the columns are linear in: "" nothing, "rigid" its rigid-body
    parameters, "needed" the torque that it needs at the joint.
    """

    instance: EffectInstance
    kind: str
    pieces: tuple[Piece, ...]
    branches: tuple[tuple[float, ...], ...]
    brackets: tuple[tuple[Bracket, ...], ...]
    scale: str
    approximate: bool
    windows: bool
    follows: str = ""

    def at(self, value: float, branch: int = 0) -> EffectInstance:
        """The effect with the scalar at a value."""
        effect = self.instance.effect
        if self.kind == "linear":
            return self.instance
        if self.kind == "shape":
            free, others = shape_order(effect)
            values = dict(zip((one.name for one in others), self.branches[branch], strict=True))
            return replace(self.instance, effect=replace(effect, **{free.name: value}, **values))
        return replace(self.instance, effect=effect.about({effect.parameters[0].name: value}))

    @property
    def typical(self) -> EffectInstance:
        """The effect in some shape within reach: its own where that is."""
        if self.kind != "shape":
            return self.instance
        free, others = shape_order(self.instance.effect)
        own = float(getattr(self.instance.effect, free.name))
        branch = tuple(float(getattr(self.instance.effect, one.name)) for one in others)
        if branch in self.branches:
            i = self.branches.index(branch)
            for piece in self.pieces:
                if piece.branch == i and piece.nodes[0] <= own <= piece.nodes[-1]:
                    return self.instance
        return self.at(self.brackets[0][0][1], 0)

    @property
    def every(self) -> tuple[EffectInstance, ...]:
        """The effect at all nodes of all pieces."""
        if self.kind == "linear":
            return (self.instance,)
        return tuple(self.at(float(value), piece.branch) for piece in self.pieces for value in piece.nodes)


def shape_order(effect: Effect) -> tuple[ShapeParameter, list[ShapeParameter]]:
    """The shape parameter that is searched along a line, and the discrete ones that are tried in all combinations."""
    free = next((one for one in effect.shape if not one.discrete), effect.shape[0])
    return free, [one for one in effect.shape if one is not free]


def searchable(effect: Effect) -> bool:
    """Whether one shape parameter at most has to be searched along a line."""
    return bool(effect.shape) and (
        len(effect.shape) == 1 or sum(not one.discrete for one in effect.shape) == 1
    )


def shape_stays(effect: Effect) -> bool:
    """Whether the page leaves the shape as it is: where there is none, or none to search for an effect of size zero."""
    if not effect.shape:
        return True
    nothing = effect.about({parameter.name: 0.0 for parameter in effect.parameters})
    brackets = [nothing.brackets(one, ()) for one in effect.shape]
    return all(len(one) == 1 and one[0][0] == one[0][2] for one in brackets)


def linear(instance: EffectInstance, scale: str, approximate: bool, follows: str = "") -> Variants:
    """An effect whose columns change with nothing but the present model."""
    return Variants(instance, "linear", (), (), (), scale, approximate, False, follows)


def branches_of(effect: Effect) -> tuple[tuple[float, ...], ...]:
    """All combinations of the discrete shape parameters beside the one that is searched."""
    return tuple(product(*(one.candidates for one in shape_order(effect)[1])))


def shaped(
    instance: EffectInstance,
    found: Sequence[tuple[tuple[Bracket, ...], ...]],
    scale: str,
    approximate: bool,
    nodes: int = NODES,
) -> Variants:
    """An effect with a shape parameter; found: its brackets in every branch, beside several models."""
    windows = any(one != found[0] for one in found[1:])
    brackets = tuple(
        tuple(sorted(set(each[0]).union(*each[1:]))) if windows else each[0]
        for each in zip(*found, strict=True)
    )
    own = float(getattr(instance.effect, shape_order(instance.effect)[0].name))
    around = () if windows else _around(own, brackets)
    pieces = tuple(piece for i, one in enumerate(brackets) for piece in _pieces((*one, *around), i, nodes))
    return Variants(
        instance, "shape", pieces, branches_of(instance.effect), brackets, scale, approximate, windows
    )


def timed(instance: EffectInstance, band: float) -> Variants:
    """An effect of one motor whose columns are linearised about its one parameter, a time in s. band: Hz."""
    return of_needed(instance, PHASE / (2.0 * np.pi * band))


def of_needed(instance: EffectInstance, size: float) -> Variants:
    """An effect made of the torque that one motor needs, linearised about its one parameter, up to a size."""
    piece = Piece(_chebyshev(-size, size, TIME_NODES), False)
    return Variants(instance, "value", (piece,), (), (), "none", False, False, "needed")


def valued(instance: EffectInstance, size: float) -> Variants:
    """An effect through the loops whose columns are linearised about its one parameter, up to a size.

    Three nodes give the second order; none is zero, about which the effect itself takes a finite step.
    """
    piece = Piece(size * np.array([-1.0, 0.25, 1.0]), False)
    return Variants(instance, "value", (piece,), (), (), "none", False, False, "rigid")


def scale_of(
    instance: EffectInstance, unit: RobotSignals, doubled: RobotSignals, turned: RobotSignals
) -> str:
    """How an effect's columns go with the motor's gain, from a recording seen with gains of 1, 2 and -1.

    Empty where they follow it, or the rest of the present model, in another way.
    """
    effect = instance.effect
    if not effect.depends_on_model:
        return "none"
    if not isinstance(effect, ActuatorEffect):
        return ""
    columns, twice, minus = (effect.columns(one, instance.joint) for one in (unit, doubled, turned))
    close = 1e-9 * float(np.abs(columns).max(initial=0.0))
    if np.abs(twice - 2.0 * columns).max(initial=0.0) > close:
        return ""
    if np.abs(minus + columns).max(initial=0.0) <= close:
        return "gain"
    return "gain_size" if np.abs(minus - columns).max(initial=0.0) <= close else ""


def _around(own: float, brackets: Sequence[Sequence[Bracket]]) -> tuple[Bracket, ...]:
    """The neighbourhood of an effect's own value, which competes when its shape is searched; none where it is near."""
    every = [one for branch in brackets for one in branch if one[0] < one[2]]
    if own <= 0.0 or not every or min(one[0] for one in every) <= own <= max(one[2] for one in every):
        return ()
    reach = (1.0 + NEARBY) ** (MOST_ROUNDS + 1)
    return ((own / reach, own, own * reach),)


def _pieces(brackets: Sequence[Bracket], branch: int, count: int) -> tuple[Piece, ...]:
    """Wide brackets that overlap become one stretch; values without a surrounding stay alone."""
    pieces: list[Piece] = []
    wide: list[float] = []
    for low, value, high in brackets:
        if low == high:
            pieces.append(Piece(np.array([value]), False, branch))
        elif low > 0.0 and high / low < WINDOW:
            pieces.append(Piece(_chebyshev(low, high, WINDOW_NODES), False, branch))
        else:
            wide += [low, high]
    if wide:
        low, high = min(wide), max(wide)
        logarithmic = low > 0.0 and high / low > 4.0
        ends = np.log([low, high]) if logarithmic else (low, high)
        nodes = _chebyshev(float(ends[0]), float(ends[1]), count)
        pieces.insert(0, Piece(np.exp(nodes) if logarithmic else nodes, logarithmic, branch))
    return tuple(pieces)


def _chebyshev(low: float, high: float, count: int) -> np.ndarray:
    """Chebyshev's points of the second kind between two ends, these included, rising."""
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    nodes = middle - half * np.cos(np.pi * np.arange(count) / (count - 1))
    nodes[0], nodes[-1] = low, high
    return np.asarray(nodes)
