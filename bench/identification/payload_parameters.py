"""A payload's standard parameters in the tool frame: which are known."""

from dataclasses import dataclass

import numpy as np

from bench.dataset.payload import Payload, inertia_matrix


@dataclass(frozen=True)
class PayloadColumns:
    """Which of a payload's 10 standard parameters in the tool frame are known.

    known (10,): their values, zero where unknown; unknown: the indices that are estimated.
    """

    known: np.ndarray
    unknown: np.ndarray


def payload_columns(payload: Payload) -> PayloadColumns:
    """Known and unknown standard parameters of a payload (chi_kL and chi_uL of equation 11).

    Without a centre of mass its first moments are unknown and so is the inertia about the tool; without a
    mass, all ten are.
    """
    known = np.zeros(10)
    if payload.mass is None:
        return PayloadColumns(known, np.arange(10))
    known[0] = payload.mass
    if payload.center_of_mass is None:
        return PayloadColumns(known, np.arange(1, 10))
    c = np.asarray(payload.center_of_mass)
    known[1:4] = payload.mass * c
    if payload.inertia is None:
        return PayloadColumns(known, np.arange(4, 10))
    inertia = inertia_matrix(payload.inertia) + payload.mass * (np.dot(c, c) * np.eye(3) - np.outer(c, c))
    known[4:] = inertia[[0, 0, 1, 0, 1, 2], [0, 1, 1, 2, 2, 2]]
    return PayloadColumns(known, np.arange(0))
