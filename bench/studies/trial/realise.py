"""From a case to a machine: parameters of the hidden effects for the requested sizes."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from bench.basics.errors import BenchError
from bench.basics.joint_units import units_of_gain
from bench.basics.quiet import stop_step_timers
from bench.basics.sentence import and_list
from bench.dataset.robot import load_robot
from bench.effects import CATALOGUE
from bench.scenario.scenario import Scenario, scenario_from_dict
from bench.scenario.trajectory import FourierTrajectory
from bench.studies.trial.cases import GAIN_ERROR, Case, Hide
from bench.studies.trial.compatible import COMPANIONS, PARTS
from bench.studies.trial.setup import Setup, where
from bench.studies.trial.unknown import sized
from bench.truth.hidden.reference import Reference
from bench.truth.hidden.sizes import real_sizes, typical
from bench.truth.simulate import Simulation, simulate

ATTEMPTS = 4  # simulations: if one fails, the effects are halved for the next
Entry = dict[str, Any]
"""One [[hidden]] entry of a scenario."""


def reference_scenario(setup: Setup) -> Scenario:
    """The scenario without hidden effects."""
    return scenario_from_dict(setup.content, setup.name)


def realised(
    setup: Setup, case: Case, reference: Reference, trajectories: Mapping[str, FourierTrajectory]
) -> tuple[Case, Simulation]:
    """The case as realised, and its simulation: shares are halved until the simulation succeeds.

    Raises BenchError if the last attempt fails as well.
    """
    stop_step_timers()
    for _ in range(ATTEMPTS - 1):
        try:
            return case, simulate(case_scenario(setup, case, reference), trajectories, threads=1)
        except BenchError:
            case = replace(case, hides=tuple(replace(hide, share=0.5 * hide.share) for hide in case.hides))
    return case, simulate(case_scenario(setup, case, reference), trajectories, threads=1)


def case_scenario(setup: Setup, case: Case, reference: Reference) -> Scenario:
    """The scenario of a case: hidden effects, noise, gains and seed."""
    return _scenario(setup, case, [entry for hide in case.hides for entry in entries(hide, reference)])


def check_scenario(setup: Setup, case: Case) -> None:
    """Raise BenchError if the motions and sensors, which all cases share, do not suit the robot."""
    sensors = setup.content.get("sensors", {})
    robot = load_robot(setup.content["robot"])
    turns = {motor.joint: units_of_gain(motor.gain_unit).rotates for motor in robot.motors}
    if not all(turns.values()) and not sensors.get("encoder_resolution"):
        steps = ", ".join(f"{joint} = {'6e-6' if turns[joint] else '1e-6'}" for joint in turns)
        unit = "rad or m" if any(turns.values()) else "m"
        slides = and_list([joint for joint, rotates in turns.items() if not rotates])
        raise BenchError(
            f"trial: the encoder of a slide joint ({slides}) has no bits per turn: add `encoder_resolution = "
            f"{{ {steps} }}` ({unit}, from your data sheets) under [sensors] in the scenario"
        )
    _scenario(setup, case, [])


def _scenario(setup: Setup, case: Case, hidden: Sequence[Entry]) -> Scenario:
    content = dict(setup.content)
    sensors = {
        key: value
        for key, value in content.get("sensors", {}).items()
        if key not in ("encoder_bits", "current_noise", "current_noise_ratio")
    }
    sensors["current_noise_ratio"] = case.noise
    if not sensors.get("encoder_resolution"):
        sensors["encoder_bits"] = case.encoder_bits
    content |= {
        "seed": case.seed,
        "sensors": sensors,
        "gains": {"error_within": GAIN_ERROR},
        "hidden": list(hidden),
    }
    return scenario_from_dict(content, setup.name)


def entries(hide: Hide, reference: Reference) -> list[Entry]:
    """Entries of the effect in each of its joints with the requested size, if a real machine can have it, and of its
    companions.
    """
    if where(hide.effect) == "passive" and len(hide.joints) > 1:
        return [_entry(hide.effect, None, typical(hide.effect, reference, hide.share))]
    all_entries: list[Entry] = []
    for joint in hide.joints or (None,):
        if hide.numbers and joint is not None:
            sizes = sized(dict(hide.numbers), reference, joint, hide.share)
        else:
            sizes = typical(hide.effect, reference, hide.share, joint)
            sizes = real_sizes(hide.effect, reference, joint, sizes)
        all_entries.append(_entry(hide.effect, joint, sizes))
        all_entries += [
            _entry(name, joint, size(sizes)) for name, size in COMPANIONS.get(hide.effect, {}).items()
        ]
    return all_entries


def _entry(effect: str, joint: str | None, sizes: Mapping[str, float]) -> Entry:
    return {"effect": effect, **({} if joint is None else {"joint": joint}), **sizes}


def hidden_places(setup: Setup, hidden: Sequence[Entry]) -> list[tuple[str, str, Entry]]:
    """(effect, place, entry) of every hidden entry in the catalogue, named as in a model.

    An effect that has another as a part also gets a triple for that part.
    """
    triples = []
    for entry in hidden:
        effect, joint = entry["effect"], entry.get("joint")
        if effect not in setup.catalogued:
            continue
        if CATALOGUE[effect].place == "payload":
            places: Sequence[str] = setup.payloads
        elif where(effect) == "machine":
            places = ("",)
        elif where(effect) == "link":
            places = (setup.links[str(joint)],)
        else:
            everywhere = setup.passive if where(effect) == "passive" else setup.motors
            places = (str(joint),) if joint is not None else everywhere
        for place in places:
            triples += [(name, place, entry) for name in (effect, *PARTS.get(effect, ()))]
    return triples
