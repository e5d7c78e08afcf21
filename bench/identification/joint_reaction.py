"""What joints without a motor bear across their axes, by the present model: see bench.model.reaction."""

from collections.abc import Callable
from functools import cache

import numpy as np

from bench.effects.signals import JointReaction, ReactionModel
from bench.identification.filtered import Measured
from bench.model.model import IdentificationModel
from bench.model.reaction import (
    HeldMotion,
    bearing_of,
    bearing_rows,
    bearing_torques,
    mass_on_axis,
    with_motors_held,
)
from bench.model.regressor import payload_transform, redundant_columns


def joint_reactions(
    model: IdentificationModel,
    measured: Measured,
    base: np.ndarray,
    payload: np.ndarray | None,
    redundant_torques: Callable[[], np.ndarray],
) -> ReactionModel:
    """The forces in joints of one recording.

    base (nb,): the present base parameters; payload (10,): what is carried, in the tool frame; redundant_torques:
    torque (N, r) of redundant motors. The base parameters represent all others with the same torques of the motors: of
    those, a mass on a joint's axis can sit on either side of it.
    """
    geometry = model.geometry
    known, loads = base, np.zeros(0, dtype=int)
    if payload is not None and geometry.tool is not None:
        known, loads = (
            np.concatenate((base, payload_transform(geometry.tool) @ payload)),
            model.payload_columns,
        )
    extra = redundant_columns(geometry)

    def moving(every: int) -> HeldMotion:
        if every not in measured.held:
            tree = measured.tree.at(slice(None, None, every))
            measured.held[every] = with_motors_held(geometry, tree)
        return measured.held[every]

    @cache  # asked for again by every effect that is tried, with the same answer
    def joint_reaction(joint: str, every: int) -> JointReaction:
        index = geometry.joint_index(joint)
        columns = np.concatenate((model.base.columns, loads, [10 * index], extra))
        key = (index, every, columns.tobytes())
        rows = measured.reactions.get(key)
        if rows is None:
            rows = bearing_rows(bearing_of(geometry, index), moving(every), columns)
            measured.reactions.keep(key, rows)
        mass, nb = len(known), len(base)
        first = rows[:, :, :nb] @ model.guessed  # of equal bars: how much heavier the model is, forces tell
        square = float(np.vdot(first, first))
        heavier = float(np.vdot(first, rows[:, :, :nb] @ base)) / square if square > 0.0 else 0.0
        force = rows[:, :, :mass] @ known
        if len(extra):
            force = force + np.einsum("kur,kr->ku", rows[:, :, mass + 1 :], redundant_torques()[::every])

        def by_torque(other: str) -> np.ndarray:
            second = geometry.joint_index(other)
            key = (index, every, second)
            along = measured.reactions.get(key)
            if along is None:
                along = bearing_torques(bearing_of(geometry, index), moving(every), second)
                measured.reactions.keep(key, along)
            return along

        of_mass = rows[:, :, mass].copy()  # without the other rows
        return JointReaction(force, of_mass, max(heavier, 0.0) * mass_on_axis(geometry, index)[0], by_torque)

    return joint_reaction
