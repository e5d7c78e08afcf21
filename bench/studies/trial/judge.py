"""Compare a diagnosis, and a law that it discovered, with the hidden effects."""

import json
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import permutations
from pathlib import Path

import numpy as np

from bench.diagnosis.discovery.law_files import law_effects
from bench.diagnosis.result import Diagnosis, Discovered
from bench.effects import CATALOGUE, EffectInstance, places_in, select_effects
from bench.effects.select import ROBOT
from bench.identification.nonlinear import converged
from bench.identification.prepare import Prepared, with_effects
from bench.identification.standstill import interpolated
from bench.signals.decimation import decimate
from bench.studies.sweep.journal import Row
from bench.studies.trial.compatible import expected, optional
from bench.studies.trial.unknown import LAW, TORQUES, named_parts
from bench.truth.hidden.laws.product_law import unit_torque
from bench.truth.simulate import Simulation


@dataclass(frozen=True)
class Named:
    """One effect in a diagnosis: its verdict and its alternatives."""

    effect: str
    verdict: str
    alternatives: tuple[str, ...]

    def may_be(self, effect: str) -> bool:
        """Whether it names the effect, or explicitly lists it as an indistinguishable alternative."""
        return effect == self.effect or (self.verdict == "indistinguishable" and effect in self.alternatives)


@dataclass(frozen=True)
class Judgement:
    """The score of a diagnosis.

    first: the first named effect is hidden; first_undecided: it is, or an alternative of it is. exact,
    exact_undecided: the same for the whole set. wrong: effects named with the verdict `missing` that are not hidden.
    """

    first: bool
    first_undecided: bool
    exact: bool
    exact_undecided: bool
    wrong: tuple[str, ...]


def judgement_of(
    drawn: Collection[str],
    wanted: Collection[str],
    missing: Sequence[Named],
    parts: Collection[str] = frozenset(),
) -> Judgement:
    """Compare a diagnosis (`missing`, strongest first) with the truth.

    drawn: hidden effects; wanted: these with their companions, which count in sets, but not as the first. parts:
    effects that are part of an unnamed hidden law. Effects that are part of a hidden one do not affect the score.
    """
    companions = set(expected(drawn)) - set(drawn)
    aside = (optional(drawn) | set(parts)) - set(wanted)
    missing = [named for named in missing if named.effect not in aside]
    leading = next((named for named in missing if named.effect not in companions), None)
    return Judgement(
        first=leading is not None and leading.effect in drawn,
        first_undecided=leading is not None and any(leading.may_be(effect) for effect in drawn),
        exact={named.effect for named in missing} == set(wanted),
        exact_undecided=_matches(missing, tuple(wanted)),
        wrong=tuple(
            named.effect for named in missing if named.effect not in wanted and named.verdict == "missing"
        ),
    )


def _matches(missing: Sequence[Named], wanted: Sequence[str]) -> bool:
    """Whether the named effects can be matched one to one with the hidden ones."""
    orders = permutations(wanted) if len(missing) == len(wanted) else ()
    return any(all(map(Named.may_be, missing, order)) for order in orders)


VARIABLES = {
    "direction": "velocity",
    "v": "velocity",
    "a": "acceleration",
    "tau": "load",
    "others": "load of others",
    "q": "position",
    "wave": "position",
    "T": "time",
}
"""Number of a hidden law -> variable that the law depends on if the number is not zero."""


def law_columns(simulation: Simulation, diagnosis: Diagnosis, prepared: Prepared) -> Row:
    """Errors of a discovered law: in torque, on recordings that are not fitted, and in structure.

    law.error: RMS of the difference between all identified and all hidden effects at the motor of the law while it
    moves, over the RMS of the hidden law's torque. It credits parts of the law that are identified as known effects,
    and includes the errors of known effects. law.alone: the same without the known effects that are identified there
    by name, whose errors may be many times a small law, except for those that are a part of the law. law.elsewhere:
    number of laws at motors that have none.
    """
    joint, numbers = _hidden_law(simulation)
    laws = [law for law in diagnosis.discovered if law.place == joint]
    known = {
        effect.effect
        for effect in simulation.scenario.settings.hidden
        if effect.joint in (None, joint) and joint in diagnosis.after.effect_parameters.get(effect.effect, ())
    } - named_parts(numbers)

    def error(but: Collection[str]) -> float:
        return _torque_error(simulation, diagnosis, prepared, joint, but) if laws else 1.0

    return {
        "law": json.dumps(numbers),
        "law.found": " | ".join(f"{law.place}: {law.formula}" for law in diagnosis.discovered),
        "law.elsewhere": sum(law.place != joint for law in diagnosis.discovered),
        "law.error": error(()),
        "law.alone": error(known),
        "law.structure": bool(laws) and _alike(numbers, laws),
    }


def _hidden_law(simulation: Simulation) -> tuple[str, dict[str, float]]:
    """The motor and the parameters of the hidden law."""
    hidden = next(effect for effect in simulation.scenario.settings.hidden if effect.effect == LAW)
    return str(hidden.joint), {name: float(value) for name, value in hidden.parameters.items()}


def _torque_error(
    simulation: Simulation, diagnosis: Diagnosis, prepared: Prepared, joint: str, but: Collection[str]
) -> float:
    """RMS error of all effects at the law's motor, except for those named in `but`, over the RMS of the law's torque.

    The true torque is interpolated at reversals of the motor and decimated, like the estimate.
    """
    motor = simulation.robot.joints.index(joint)
    model, values = _identified_model(diagnosis, prepared, but)
    difference = squares = 0.0
    for seen, rows in zip(model.measured, model.observations, strict=True):
        if rows.use != "validate":
            continue
        modelled = rows.effects[:, motor] @ values
        law, known, time = _true_torques(simulation, rows.name, motor, but)
        wanted, alone = (
            decimate(interpolated(entry[:, None], [seen.gaps[motor]]), model.settings.decimation)[:, 0]
            for entry in (np.interp(seen.time, time, torque) for torque in (law + known, law))
        )
        moving = rows.moving[:, motor]
        difference += float(((modelled - wanted)[moving] ** 2).sum())
        squares += float((alone[moving] ** 2).sum())
    return float(np.sqrt(difference / squares)) if squares else float("nan")


def _identified_model(
    diagnosis: Diagnosis, prepared: Prepared, but: Collection[str]
) -> tuple[Prepared, np.ndarray]:
    """The identified model, and the values of its effect columns in order, zero for the effects in `but`."""
    catalogue = {**CATALOGUE, **law_effects(diagnosis.discovered)}
    fitted = diagnosis.after.effect_parameters
    places = places_in(prepared.model.geometry, prepared.dataset.weighed)
    instances: list[EffectInstance] = []
    values: list[float] = []
    for name, at in fitted.items():
        for place, quantities in at.items():
            request = name if place == ROBOT else f"{name}:{place}"
            (instance,) = select_effects([request], places, catalogue)
            by_name = {label: quantity.value for label, quantity in quantities.items()}
            shape = {parameter.name: by_name[parameter.name] for parameter in instance.effect.shape}
            effect = replace(instance.effect, **shape).about(by_name)
            instances.append(replace(instance, effect=effect))
            values += [0.0 if name in but else by_name[parameter.name] for parameter in effect.parameters]
    model = with_effects(prepared, instances)
    return converged(model, nearly=True), np.array(values)


def _true_torques(
    simulation: Simulation, name: str, motor: int, but: Collection[str]
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Torques (N,) of the hidden law and of the known effects at its motor except for `but`, along a recording's true
    motion, and time (N,), s.
    """
    _, numbers = _hidden_law(simulation)
    motions = {recording.name: recording.motion for recording in simulation.recordings}
    motion, machine = motions[Path(name).stem], simulation.machine
    torque = motion.torque[:, motor]
    dof = machine.dofs[motor]
    position, velocity = motion.qpos[:, machine.addresses[motor]], motion.qvel[:, dof]
    others = motion.torque.sum(axis=1) - torque
    unit = unit_torque(numbers, position, velocity, motion.qacc[:, dof], torque, others, motion.time)
    known = np.zeros(len(torque))
    for hidden in simulation.scenario.settings.hidden:
        if hidden.effect not in (LAW, *but) and hidden.joint in (None, simulation.robot.joints[motor]):
            known += TORQUES[hidden.effect](hidden.parameters, position, velocity)
    return numbers["c"] * unit, known, motion.time


def _alike(numbers: Mapping[str, float], laws: Sequence[Discovered]) -> bool:
    """Whether the identified laws depend on the same variables, and oppose the motion if the hidden one does."""
    wanted = {variable for name, variable in VARIABLES.items() if numbers.get(name)}
    looks = [each for law in laws for term in law.terms for each in term.looks_at]
    seen = {f"{look.what} of others" if look.motor else look.what for look in looks}
    odd = any(
        each.what == "velocity" and not each.motor and each.role in ("direction", "signed", "memory")
        for each in looks
    )
    return seen == wanted and odd == bool(numbers.get("direction"))
