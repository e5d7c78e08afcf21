"""In which directions the models that one may tick differ from the found one.

An effect that is made of the present model's torque has columns linear in that model. For all models in reach a few
directions are enough: the main components of what sets of effects change in the torque.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from bench.effects import EffectInstance, RobotSignals
from bench.identification.effect_columns import PresentModel, robot_signals
from bench.identification.filtered import Measured
from bench.workbench.found_model import FoundModel

NEGLIGIBLE = 3e-5  # of the torque: smaller changes are left out
MOST_RIGID, FEW_RIGID = 6, 1
MOST_NEEDED, FEW_NEEDED = 12, 2
REWEIGHTINGS = 3  # of the motors, by what a model leaves
FIRST = 10.0  # times that the model without any effect counts


@dataclass(frozen=True)
class Terms:
    """The model's own columns, then those of effects that do not follow the present model, in one shape each.

    rows (M, n, I) of the fitted recordings; own: how many are the model's own; instances, and the places of their
    columns among the I. following (M, n, F): columns of effects that follow the present model, beside the found one,
    with places from I on: of each effect, and of the found ones.
    """

    rows: np.ndarray
    own: int
    instances: tuple[EffectInstance, ...]
    places: tuple[np.ndarray, ...]
    following: np.ndarray
    following_sets: tuple[np.ndarray, ...]
    following_found: tuple[np.ndarray, ...]


@dataclass(frozen=True)
class Directions:
    """rigid (own, m): of the model's own parameters; needed: for each motor (I, m), of all terms."""

    model: FoundModel
    terms: Terms
    rigid: np.ndarray
    needed: tuple[np.ndarray, ...]

    def rigid_models(self) -> PresentModel:
        """The found model and the rigid directions beside each other: base (nb, 1 + m), payloads (10, 1 + m)."""
        own = self.model.solution.theta[: self.terms.own]
        return self._models(np.column_stack((own, self.rigid)), 1)

    def needed_torques(self, measured: Measured, signals: RobotSignals) -> list[list[np.ndarray]]:
        """For each motor the torque (N,) that the found model needs, and that of each of its directions."""
        found, terms = self.model.found, self.terms
        rigid = np.concatenate([one[: terms.own] for one in self.needed], axis=1)
        coarse = robot_signals(found.model, measured, self._models(rigid, 0)).coarse.torque
        effects = [one.effect.columns(signals, one.joint) for one in terms.instances]
        torques: list[list[np.ndarray]] = []
        at = 0
        for j, (joint, directions) in enumerate(zip(signals.joints.values(), self.needed, strict=True)):
            count = directions.shape[1]
            total = signals.refined(coarse[:, j, at : at + count])
            at += count
            for columns, places in zip(effects, terms.places, strict=True):
                total = total + columns[:, j] @ directions[places]
            torques.append([joint.needs(), *np.ascontiguousarray(total.T)])
        return torques

    def _models(self, own: np.ndarray, declared_in: int) -> PresentModel:
        """Several models at once; the declared parameters of payloads stand in the first so many."""
        found = self.model.found
        payloads = {}
        for name, declared in found.present.declared.items():
            values = np.zeros((10, own.shape[1]))
            values[:, :declared_in] = declared[:, None]
            if name in found.layout.payloads:
                values[found.layout.payloads[name]] = own[found.layout.payload_slice(name)]
            payloads[name] = values
        return replace(found.present, base=own[: found.layout.base], payloads=payloads)


def directions_of(
    model: FoundModel, terms: Terms, known: np.ndarray, current: np.ndarray, roomy: bool
) -> Directions:
    """Directions in which models with one effect, or with one more or fewer than the found ones, differ.

    known, current (M, n): torque of the known payload, and current, of the fitted recordings. roomy:
    whether effects through the loops are few.
    """
    weights = model.solution.weights / model.solution.gains
    differences = _differences(model, terms, known, current)
    grams = [rows.T @ rows for rows in terms.rows.swapaxes(0, 1)]
    torque = ((current * model.solution.gains) ** 2).sum(axis=0)
    own = terms.own
    gram = np.sum([w * w * one[:own, :own] for w, one in zip(weights, grams, strict=True)], axis=0)
    rigid = _main(differences[:own], gram, float(weights**2 @ torque), MOST_RIGID if roomy else FEW_RIGID)
    needed = [
        _main(differences, one, float(size), MOST_NEEDED if roomy else FEW_NEEDED)
        for one, size in zip(grams, torque, strict=True)
    ]
    return Directions(model, terms, rigid, tuple(needed))


def rigid_coordinates(directions: Directions, columns: int) -> np.ndarray:
    """Coordinates (m, C) of a model's difference in the rigid directions, by the page's C columns, own ones first."""
    terms, rigid, model = directions.terms, directions.rigid, directions.model
    weights = model.solution.weights / model.solution.gains
    rows = (terms.rows[:, :, : terms.own] * weights[:, None]).reshape(-1, terms.own)
    found = np.zeros((rigid.shape[1], columns))
    torque = rows @ rigid
    found[:, : terms.own] = (torque.T @ rows) / (torque**2).sum(axis=0)[:, None]
    return found


def needed_coordinates(directions: Directions, motor: int, columns: np.ndarray) -> np.ndarray:
    """Coordinates (m, C) of a model's difference in a motor's directions, by the page's columns (M, C) there."""
    torque = directions.terms.rows[:, motor] @ directions.needed[motor]
    return np.asarray((torque.T @ columns) / (torque**2).sum(axis=0)[:, None])


def _differences(model: FoundModel, terms: Terms, known: np.ndarray, current: np.ndarray) -> np.ndarray:
    """How models with various effects differ from the found one, (I, S): weighted least squares in torque."""
    n = terms.rows.shape[1]
    count = terms.rows.shape[2]
    size = count + terms.following.shape[2]
    grams = []
    for j in range(n):
        rows = np.zeros((len(terms.rows), size + n + 1))
        rows[:, :count], rows[:, count:size] = -terms.rows[:, j], -terms.following[:, j]
        rows[:, size + j] = current[:, j]
        rows[:, -1] = known[:, j]
        if not model.fit_gains:
            rows[:, -1] -= current[:, j] * model.solution.gains[j]
        grams.append(rows.T @ rows)
    gains = size + np.arange(n if model.fit_gains else 0)

    def solved(places: Sequence[np.ndarray]) -> np.ndarray:
        index = np.concatenate([np.arange(terms.own), *places, gains]).astype(int)
        found = np.zeros(size + n + 1)
        found[-1] = -1.0
        weights = model.solution.weights / model.solution.gains
        for _ in range(REWEIGHTINGS):
            gram = np.sum([w * w * one for w, one in zip(weights, grams, strict=True)], axis=0)
            normal, right = gram[np.ix_(index, index)], gram[index, -1]
            norms = np.sqrt(np.diag(normal))
            norms[norms == 0.0] = 1.0
            scaled = normal / np.outer(norms, norms)
            found[index] = np.linalg.lstsq(scaled, right / norms, rcond=1e-13)[0] / norms
            left = np.array([found @ one @ found for one in grams])
            weights = 1.0 / np.sqrt(np.maximum(left, 1e-12 * left.max() + np.finfo(float).tiny))
        return found[:count]

    names = [one.effect.name for one in terms.instances]
    of_found = {(one.effect.name, one.joint) for one in model.effects}
    found = [i for i, one in enumerate(terms.instances) if (one.effect.name, one.joint) in of_found]
    base = [terms.places[i] for i in found] + list(terms.following_found)
    reference = solved(base)
    sets: list[list[np.ndarray]] = [[]]
    sets += [
        [*(terms.places[i] for i in found if names[i] != name), *terms.following_found]
        for name in dict.fromkeys(names[i] for i in found)
    ]
    for name in dict.fromkeys(names):
        places = [terms.places[i] for i, other in enumerate(names) if other == name]
        more = [terms.places[i] for i, other in enumerate(names) if other == name and i not in found]
        sets += [places, [*base, *more]]
    for one in terms.following_sets:
        sets += [[one], [*base, np.setdiff1d(one, np.concatenate([np.empty(0), *base]))]]
        sets += [
            [*(terms.places[i] for i in found if names[i] != name), one]
            for name in dict.fromkeys(names[i] for i in found)
        ]
    return np.column_stack([solved(one) - reference for one in sets])


def _main(differences: np.ndarray, gram: np.ndarray, whole: float, most: int) -> np.ndarray:
    """Main components (I, m) of differences (I, S) by their torque, those of some share of the whole.

    Differences larger than the first, of the model without any effect, count no more than that one: a set that
    fits badly must not decide. The first counts FIRST times.
    """
    lengths = np.sqrt(np.maximum(np.einsum("is,ik,ks->s", differences, gram, differences), 0.0))
    limit = max(float(lengths[0]), 1e-3 * np.sqrt(whole))
    weighted = differences / np.maximum(lengths / limit, 1.0)
    weighted[:, 0] *= FIRST
    inner = weighted.T @ gram @ weighted
    values, vectors = np.linalg.eigh(0.5 * (inner + inner.T))
    kept = np.flatnonzero(values > NEGLIGIBLE**2 * whole)[::-1][:most]
    return np.asarray(weighted @ vectors[:, kept])
