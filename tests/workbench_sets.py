"""What a workbench's page carries, as the system of inner products that `solve_set` solves."""

import base64
from dataclasses import dataclass, replace

import numpy as np

from bench.diagnosis.batched_sets import solve_set
from bench.diagnosis.motor_products import MotorProducts
from bench.diagnosis.system import Candidate, SetFit, System, squared_errors
from bench.identification.solution import Solution

REWEIGHTINGS = 20


def numbers(text, kind="<f4"):
    return np.frombuffer(base64.b64decode(text), dtype=kind).astype(float)


@dataclass(frozen=True)
class Answer:
    fitted: float
    held_out: float
    gains: np.ndarray
    values: dict


class Carried:
    """`fit({key, ...})`: least squares of the current's error, by `solve_set`; a key is EFFECT:PLACE, or EFFECT."""

    def __init__(self, data):
        self.data, self.own, self.count = data, data["own"], data["columns"]
        reference = numbers(data["reference"], "<f8")
        motors = data["motors"]
        gains = np.array([one["gain"] for one in motors])
        known = np.append(-reference, [0.0, 0.0])
        known[: self.own] = 0.0
        inner = {}
        for use in ("fitted", "judged"):
            grams = []
            for motor, gain in zip(motors, gains, strict=True):
                change = np.eye(self.count + 2)  # the found model without its effects, and what that leaves
                change[:, -2] = gain * change[:, -2] + known
                change[:, -1] -= known / gain
                factor = self._factor(motor, use)
                grams.append((factor @ change).T @ (factor @ change))
            inner[use] = np.array(grams)
        self.squares = {use: np.array([one[use]["squares"] for one in motors]) for use in inner}
        self.places = {}
        for effect in data["effects"]:
            for place in effect["places"]:
                key = f"{effect['name']}:{place['place']}" if place["place"] else effect["name"]
                self.places[key] = place
        candidates = tuple(
            Candidate((), np.arange(one["start"], one["stop"]), np.ones(one["stop"] - one["start"]))
            for one in self.places.values()
        )
        weights = np.sqrt(data["rows"] / np.maximum(inner["fitted"][:, -1, -1], 1e-300))
        start = Solution(reference[: self.own], gains, weights, "current", data["fits_gains"])
        products = [
            MotorProducts(
                np.pad(inner[use], ((0, 0), (0, 1), (0, 1))),
                data["rows"],
                float(self.squares[use].sum()),
                np.full(len(inner[use]), data["rows"] / len(inner[use])),
            )
            for use in ("fitted", "judged")
        ]
        self.system = System(candidates, self.own, start, *products, 1.0)

    def _factor(self, motor, use):
        """Triangular factor of [columns, modelled, error] in its places among all (c, C + 2)."""
        size = len(motor["columns"]) + 2
        factor = np.zeros((size, size))
        if motor[use]["triangle"]:
            factor[np.triu_indices(size)] = numbers(motor[use]["triangle"])
        every = np.zeros((size, self.count + 2))
        every[:, [*motor["columns"], self.count, self.count + 1]] = factor
        return every

    def keys(self, requests):
        """The keys of EFFECT, which means everywhere, or EFFECT:PLACE."""
        return {key for key in self.places if {key, key.partition(":")[0]} & set(requests)}

    def fit(self, keys):
        system = self.system
        chosen = [i for i, key in enumerate(self.places) if key in keys]
        fit: SetFit = solve_set(system, chosen)
        for _ in range(REWEIGHTINGS):
            left = squared_errors(system.fitted, fit, system.start)
            start = replace(system.start, weights=np.sqrt(self.data["rows"] / left))
            fit = solve_set(replace(system, start=start, solved={}), chosen)
        shares = {}
        for use, products in (("fitted", system.fitted), ("judged", system.held_out)):
            left = squared_errors(products, fit, system.start)
            shares[use] = float(np.sqrt(left.sum() / (self.squares[use].sum() or 1.0)))
        values, at = {}, self.own
        for key in (list(self.places)[i] for i in sorted(chosen)):
            names = [one["name"] for one in self.places[key]["parameters"]]
            values[key] = dict(zip(names, fit.values[at : at + len(names)], strict=True))
            at += len(names)
        return Answer(shares["fitted"], shares["judged"], fit.gains, values)
