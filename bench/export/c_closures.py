"""The closures of a robot as tables of C: what `bench/export/c/closure_equations.c.in` reads."""

import numpy as np

from bench.export.c_tables import table
from bench.model.bounds import CLOSURE
from bench.model.closure import closures_of, loop_rows
from bench.model.elimination import elimination_order
from bench.model.follow import make_follower
from bench.model.geometry import POWERS, Geometry
from bench.model.kinematics import frames_of
from bench.model.spin import idle_spins

MOST_ITERATIONS = 8  # of Newton's method, a pose
MOST_POSES = 512  # a call: where motors go far, poses between are closed, too
NEARLY = 1e-8  # m or rad: after a smaller correction the loops are closed to rounding
CLOSED = 1e-9  # m or rad: what may stay open of closures that do not repeat one another


def passive_order(geometry: Geometry) -> tuple[int, ...]:
    """The velocities without a motor in the order in which they are solved for: those of the legs first."""
    closures = closures_of(geometry)
    _, rows = loop_rows(closures, frames_of(closures.links, np.ascontiguousarray(geometry.home[:, None])))
    passive = set(closures.passive)
    return elimination_order([{c: x for c, x in row.items() if c in passive} for row in rows])


def closure_tables(geometry: Geometry) -> dict[str, str]:
    """The values of the names in the templates of closed robots."""
    spins, passive = idle_spins(geometry), passive_order(geometry)
    equations = closures_of(geometry).equations
    ends = [(loop.first, loop.second) for loop in geometry.loops]
    terms, factors = [], []
    for g, coupling in enumerate(geometry.couplings):
        for second, side in enumerate((coupling.first, coupling.second)):
            for joint, factor in side:
                place = geometry.joints[joint]
                terms.append((g, second, place.q.start, place.v.start))
                factors.append(factor)
    points = [np.concatenate([end.placement.translation for end in pair]) for pair in ends]
    turns = [np.concatenate([end.placement.rotation.ravel() for end in pair]) for pair in ends]
    given = [coupling.polynomial for coupling in geometry.couplings]
    polynomials = [np.pad(polynomial, (0, POWERS - len(polynomial))) for polynomial in given]
    repeating = equations > len(passive)
    return {
        "passives": str(len(passive)),
        "equations": str(equations),
        "loops": str(len(geometry.loops)),
        "gears": str(len(geometry.couplings)),
        "terms": str(len(terms)),
        "spins": str(len(spins)),
        "passive": table(passive),
        "home": table(geometry.home),
        "unit": table(make_follower(geometry).units),
        "weld": table([int(loop.kind == "weld") for loop in geometry.loops]),
        "end_joint": table([[end.joint for end in pair] for pair in ends]),
        "end_point": table(points),
        "end_rotation": table(turns),
        "powers": str(POWERS),
        "polynomial": table(polynomials),
        "term": table(terms),
        "factor": table(factors),
        "spin_joint": table([spin.joint for spin in spins]),
        "spin_axis": table([spin.axis for spin in spins]),
        "iterations": str(MOST_ITERATIONS),
        "poses": str(MOST_POSES),
        "nearly": repr(NEARLY),
        "slack": repr(CLOSURE.slack if repeating else CLOSED),
        "amplified": f"{CLOSURE.amplification:g}",
        "largest_correction": repr(CLOSURE.correction),
        "largest_step": repr(CLOSURE.step),
        "largest_turn": repr(CLOSURE.turn),
        "smallest_step": repr(CLOSURE.share),
    }
