"""How large an effect must be to matter: parameters for a given share of the torque, for any robot."""

import numpy as np
from numpy.typing import NDArray

from bench.basics.errors import BenchError
from bench.truth.hidden import HIDDEN_EFFECTS, JointEffect
from bench.truth.hidden.machine_sizes import machine_sizes
from bench.truth.hidden.reference import Reference
from bench.truth.simulate import Simulation

Array = NDArray[np.float64]
DIGITS = 4  # that a parameter is given with


def typical(effect: str, reference: Reference, share: float, joint: str | None = None) -> dict[str, float]:
    """Parameters of an effect whose torque is about `share` of what the motor gives, RMS over RMS.

    reference: the same movements without hidden effects; no robot has special rules.
    joint: for an effect in a joint; the share is of its motor's torque, or of all motors' if it has none.
    For an effect of the whole machine, or in all passive joints, None; the share is of all motors' torque.
    An effect of the drive counts as the torque that it seems to take away: a delay, the change of the
    current during that time; a drive that gives way, the change of torque from the joint being elsewhere.

    Raises BenchError for an effect or a joint that there is not, or a share that the effect cannot have.
    """
    if not (np.isfinite(share) and share > 0):
        raise BenchError(f"the share of an effect should be greater than 0, not {share!r}")
    kind = HIDDEN_EFFECTS.get(effect)
    if kind is None:
        raise BenchError(f"no effect {effect!r}; there are {', '.join(HIDDEN_EFFECTS)}")
    if issubclass(kind, JointEffect) and kind.sized is not JointEffect.sized:
        if joint is None:
            raise BenchError(f"{effect}: name a joint: one of {', '.join(reference.simulation.robot.driven)}")
        sizes = kind.sized(reference.movement(joint), share) or {}
    else:
        try:
            sizes = machine_sizes(kind, reference, joint, share)
        except BenchError as error:
            raise BenchError(f"{effect} with a share of {share:g}: {error}") from error
    return {name: float(f"{value:.{DIGITS}g}") for name, value in sizes.items()}


def measured_share(simulation: Simulation, reference: Reference) -> Array:
    """How much an effect changed the current references (n,), RMS over RMS, of the same recordings.

    Includes what the controller makes of it, so that it differs a little from the share of the torque.
    """
    without = reference.simulation.recordings
    change = [a.current - b.current for a, b in zip(simulation.recordings, without, strict=True)]
    current = np.concatenate([recording.current for recording in without])
    ratio = np.mean(np.concatenate(change) ** 2, axis=0) / np.mean(current**2, axis=0)
    return np.asarray(np.sqrt(ratio))
