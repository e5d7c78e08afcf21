"""Which parameters are estimated, in which order: base, unknown payload parameters, redundant motors, effects."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from bench.basics.errors import BenchError
from bench.dataset.payload import Payload, inertia_matrix
from bench.identification.observation import Observation
from bench.model.base import independent_columns
from bench.model.model import IdentificationModel
from bench.model.regressor import PARAMETERS, UNITS


@dataclass(frozen=True)
class ParameterLayout:
    """The order of the estimated parameters: base, unknown payload parameters, redundant motors, effects.

    payloads: for each payload, the indices of its parameters that the recordings can distinguish. redundant: for each
    redundant motor, the difference of its drive gain from the nominal value; none if gains stay nominal.
    """

    base: int
    payloads: Mapping[str, np.ndarray]
    effects: int
    redundant: int = 0

    @property
    def size(self) -> int:
        """Number of parameters without the drive gains."""
        return self.base + sum(len(index) for index in self.payloads.values()) + self.redundant + self.effects

    @property
    def effect_slice(self) -> slice:
        """Indices of the effects, the last ones."""
        return slice(self.size - self.effects, self.size)

    @property
    def redundant_slice(self) -> slice:
        """Indices of redundant motors."""
        stop = self.size - self.effects
        return slice(stop - self.redundant, stop)

    def payload_slice(self, name: str) -> slice:
        """Indices of a payload's unknown parameters; BenchError if no payload has that name."""
        start = self.base
        for other, index in self.payloads.items():
            if other == name:
                return slice(start, start + len(index))
            start += len(index)
        raise BenchError(f"no payload {name!r}")


def payload_parameters(index: np.ndarray) -> list[tuple[str, str]]:
    """Symbol and unit of a payload's unknown standard parameters, such as mx in kg*m."""
    return [(PARAMETERS[i], UNITS[i]) for i in index]


def payload_parameter_names(payload: str, index: np.ndarray) -> list[str]:
    """Their names, such as mx(disc)."""
    return [f"{symbol}({payload})" for symbol, _ in payload_parameters(index)]


def regressor_rows(observation: Observation, layout: ParameterLayout) -> np.ndarray:
    """Phi of equation 11 in the layout's order, (M, n, p)."""
    samples, n = observation.current.shape
    rows = np.zeros((samples, n, layout.size))
    rows[:, :, : layout.base] = observation.rigid
    if observation.payload_name is not None and observation.payload is not None:
        index = layout.payloads[observation.payload_name]
        rows[:, :, layout.payload_slice(observation.payload_name)] = observation.payload[:, :, index]
    if layout.redundant:
        rows[:, :, layout.redundant_slice] = observation.redundant
    rows[:, :, layout.effect_slice] = observation.effects
    return rows


def known_rows(observation: Observation, payloads: Mapping[str, Payload]) -> np.ndarray:
    """The known part of the torque (M, n), N*m or N: of the known payload, and nominal of redundant motors.

    Redundant motors relieve the others of J_r' diag(i_r) g_r, J_r being their velocities for unit velocities of the
    others: the motion determines only the powers J' tau. Source: Briot, Gautier and Krut, "Dynamic parameter
    identification of actuation redundant parallel robots: application to the DualV", AIM 2013.
    """
    return payload_rows(observation, payloads) + observation.redundant @ observation.nominal


def payload_rows(observation: Observation, payloads: Mapping[str, Payload]) -> np.ndarray:
    """Torque of the known payload parameters, phi_kL chi_kL of equation 11: (M, n), N*m or N."""
    if observation.payload_name is None or observation.payload is None:
        return np.zeros(observation.current.shape)
    return observation.payload @ payload_columns(payloads[observation.payload_name]).known


def parameter_layout(
    model: IdentificationModel, payloads: Mapping[str, Payload], loaded: Sequence[str | None], effects: int
) -> ParameterLayout:
    """Omit the unknown payload parameters that no motion of this robot can distinguish.

    `loaded` names the payload of every fitted recording, None for one without. Decided at random noise-free states, so
    that it never depends on data. The known parameters count only for the size of columns: an unknown one with the same
    effect is kept, and then the payload fixes no drive gain.
    """
    used = [name for name in dict.fromkeys(loaded) if name is not None]
    indices: dict[str, np.ndarray] = {}
    if used:
        rows = model.random_rows[1].reshape(-1, 10)
        for name in used:
            columns = payload_columns(payloads[name])
            known = rows @ columns.known
            kept = independent_columns(np.column_stack((rows[:, columns.unknown], known))).kept
            indices[name] = columns.unknown[kept[kept < len(columns.unknown)]]
    return ParameterLayout(len(model.base.columns), indices, effects)


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
