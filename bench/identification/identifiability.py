"""Whether recordings of these kinds can give the drive gains at all, whatever the movement."""

from collections.abc import Mapping, Sequence

import numpy as np

from bench.basics.errors import BenchError
from bench.dataset.payload import Payload
from bench.identification.layout import ParameterLayout
from bench.identification.payload_parameters import payload_columns
from bench.model.model import IdentificationModel

DEPENDENT = 1e-9
SEED = 20120604  # of the currents of redundant motors at the random states


def check_gains_identifiable(
    model: IdentificationModel,
    layout: ParameterLayout,
    payloads: Mapping[str, Payload],
    loaded: Sequence[str | None],
) -> None:
    """Raise BenchError that names the gains which the kinds of recordings leave open.

    `loaded` names the payload of every fitted recording. At random noise-free states of a robot with guessed
    masses the columns of equation 13 but the last must be independent; a null vector that holds a gain
    means that this gain and parameters can grow together. Redundant motors have random currents.
    """
    geometry = model.geometry
    rigid, loads = model.random_rows
    n = rigid.shape[1]
    unit = (
        model.random_redundant
        * np.random.default_rng(SEED).normal(size=model.random_redundant.shape[::2])[:, None]
    )
    extra = geometry.robot.redundant
    blocks = []
    for name in dict.fromkeys(loaded):
        torque = rigid @ model.guessed
        torque = torque + unit @ np.array([actuator.gain for actuator in extra])
        block = np.zeros((len(rigid), n, layout.size - layout.effects + n))
        block[:, :, : layout.base] = rigid
        block[:, :, block.shape[2] - n - len(extra) : block.shape[2] - n] = unit
        if name is not None:
            torque = torque + loads @ payload_columns(payloads[name]).known
            block[:, :, layout.payload_slice(name)] = loads[:, :, layout.payloads[name]]
        block[:, np.arange(n), block.shape[2] - n + np.arange(n)] = -torque
        blocks.append(block.reshape(-1, block.shape[2]))
    stacked = np.vstack(blocks)
    norms = np.linalg.norm(stacked, axis=0)
    norms[norms == 0.0] = 1.0
    singular, vectors = np.linalg.svd(np.linalg.qr(stacked / norms, mode="r"))[1:]
    open_directions = vectors[singular < DEPENDENT * singular[0]][:, -n - len(extra) :]
    joints = [actuator.joint for actuator in (*extra, *geometry.robot.actuators)]
    undetermined = [
        joint
        for joint, size in zip(joints, np.abs(open_directions).max(axis=0, initial=0.0), strict=True)
        if size > 1e-6
    ]
    if not undetermined:
        return
    advice = (
        "record one trajectory without the payload as well"
        if None not in loaded
        else "the payload does not load these motors differently from the robot's own bodies"
    )
    raise BenchError(
        f"robot {geometry.robot.name}: the drive gain of {', '.join(undetermined)} cannot be identified from these "
        f"recordings: {advice}, or keep the gains nominal"
    )
