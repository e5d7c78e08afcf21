"""A feed-forward as C without dependencies: recursive Newton-Euler over constant tables; loops are closed by Newton's
method, and the torques of joints without a motor carried to the motors by virtual work.
"""

import re
from pathlib import Path
from string import Template

import numpy as np

from bench.basics.files.atomic import write_text_atomically
from bench.effects.laws.gain_saturation import LEAST as LEAST_SATURATED
from bench.effects.laws.gain_saturation import SOLVING
from bench.export.c_closures import closure_tables, passive_order
from bench.export.c_laws import LAWS, PASSIVE_LAWS, motor_lines, passive_lines
from bench.export.c_tables import table
from bench.export.carried import carried
from bench.export.feedforward import chosen_effects
from bench.export.identified import EffectValues, IdentifiedModel

TEMPLATES = Path(__file__).with_name("c")
KINDS = {"hinge": "HINGE", "slide": "SLIDE", "ball": "BALL", "free": "FREE"}


def c_name(robot: str) -> str:
    """The robot's name as that of C functions."""
    name = re.sub(r"\W", "_", robot, flags=re.ASCII)
    return name if not name[0].isdigit() else f"_{name}"


def c_text(model: IdentifiedModel, payload: str | None = None) -> tuple[str, tuple[str, ...]]:
    """The source, and what of the model is not in it. payload: name of the one that the robot carries.

    The bodies' tables hold base parameters at the places of the standard parameters that they are named after, all
    others zero but those of the payload: the same torques with fewer numbers. Raises BenchError for a payload of which
    the model does not know enough.
    """
    geometry = model.model.geometry
    chosen = chosen_effects(model)
    at_motors = (*chosen.at_motors, *chosen.between)
    known = [effect for effect in at_motors if effect.name in LAWS]
    balls = {joint.name for joint in geometry.joints if joint.kind == "ball"}
    passive = [
        effect for effect in chosen.in_passive if effect.name in PASSIVE_LAWS and effect.place not in balls
    ]
    unknown = [
        *(f"{effect.name} at {effect.place}" for effect in at_motors if effect.name not in LAWS),
        *(
            f"{effect.name} at {effect.place}: a ball joint"
            for effect in chosen.in_passive
            if effect.place in balls
        ),
    ]
    left_out = (*chosen.left_out, *unknown)
    units = ", ".join(f"{motor.joint} ({motor.gain_unit.split('/')[-1]})" for motor in model.robot.actuators)
    names = {
        "name": c_name(geometry.robot.name),
        "robot": _comment(geometry.robot.name),
        "currents": _comment(units),
        "load": "with no payload" if payload is None else f"with payload {_comment(payload)}",
        "left_out": "".join(f"\n * Not in it: {_comment(line)}." for line in left_out),
        **(closure_tables(geometry) if geometry.closed else {}),
        **_body_tables(model, payload),
    }
    names |= _effect_lines(model, known)
    parts = ["rigid_bodies", *(("closure_equations", "closing") if geometry.closed else ())]
    if geometry.closed:
        names["passive_effects"] = passive_lines(geometry, passive_order(geometry), passive)
    names |= {part: _filled(part, names) for part in parts}
    return _filled("closed" if geometry.closed else "tree", names), left_out


def write_c(path: Path, model: IdentifiedModel, payload: str | None = None) -> tuple[str, ...]:
    """Write it, whole or not at all; returns what of the model is not in it."""
    text, left_out = c_text(model, payload)
    write_text_atomically(path, text)
    return left_out


def _filled(part: str, names: dict[str, str]) -> str:
    return Template((TEMPLATES / f"{part}.c.in").read_text(encoding="utf-8")).substitute(names)


def _body_tables(model: IdentifiedModel, payload: str | None) -> dict[str, str]:
    geometry = model.model.geometry
    joints, motors = geometry.joints, len(geometry.active)
    parameters = np.zeros(10 * len(joints) + motors)
    np.add.at(parameters, *carried(model, payload))
    return {
        "joints": str(len(joints)),
        "nq": str(geometry.nq),
        "nv": str(geometry.nv),
        "motors": str(motors),
        "balls": str(sum(joint.kind == "ball" for joint in joints)),
        "frees": str(sum(joint.kind == "free" for joint in joints)),
        "kind": ", ".join(KINDS[joint.kind] for joint in joints),
        "parent": table([joint.parent for joint in joints]),
        "at_q": table([joint.q.start for joint in joints]),
        "at_v": table([joint.v.start for joint in joints]),
        "motor_q": table(geometry.active_configuration),
        "motor_v": table(geometry.active),
        "offset": table(geometry.active_offset),
        "axis": table(np.array([joint.axis for joint in joints])),
        "rotation": table(np.array([joint.placement.rotation.ravel() for joint in joints])),
        "translation": table(np.array([joint.placement.translation for joint in joints])),
        "bodies": table(parameters[: 10 * len(joints)].reshape(-1, 10)),
        "rotors": table(parameters[10 * len(joints) :]),
        "gain": table(model.gains),
        "gravity": table(geometry.gravity),
        "solving": str(SOLVING),
        "least": repr(LEAST_SATURATED),
    }


def _effect_lines(model: IdentifiedModel, effects: list[EffectValues]) -> dict[str, str]:
    first = [effect for effect in effects if not effect.instance.effect.before_torque]
    last = [effect for effect in effects if effect.instance.effect.before_torque]
    return {"effects": motor_lines(model, first), "between": motor_lines(model, last)}


def _comment(text: str) -> str:
    return text.replace("*/", "* /")
