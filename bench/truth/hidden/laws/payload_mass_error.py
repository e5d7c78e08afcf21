"""A payload whose mass differs from the declared one."""

from dataclasses import dataclass, replace

from bench.basics.errors import BenchError
from bench.dataset.payload import Payload
from bench.truth.hidden.base import Draft, HiddenEffect


@dataclass(frozen=True)
class PayloadMassError(HiddenEffect):
    """True mass = mass of the scenario's payload + error; the inertia scales with the mass.

    The dataset declares the values of the scenario.

    error: kg, either sign, for every payload of the scenario.
    """

    name = "payload_mass_error"
    law = "every payload weighs this much more than its table says; of the whole machine"
    needs = "payload"
    scaled = ("error", 0.01)
    error: float

    def change(self, draft: Draft) -> None:
        if not draft.payloads:
            raise BenchError(f"{self.name}: the scenario has no payload")

    def weigh(self, payload: Payload) -> Payload:
        if payload.mass is None or payload.inertia is None:
            return payload
        mass = payload.mass + self.error
        if mass <= 0:
            raise BenchError(f"{self.name}: payload {payload.name!r} would weigh {mass:g} kg")
        return replace(payload, mass=mass, inertia=payload.inertia * (mass / payload.mass))
