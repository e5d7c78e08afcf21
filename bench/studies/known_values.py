"""The true values of a simulated dataset, named as in an identification."""

from collections.abc import Mapping
from typing import Any

from bench.dataset.robot import Robot
from bench.document.numbers import effect_key
from bench.model.model import build_model
from bench.studies.sweep.true_parameters import true_values
from bench.studies.trial.true_effects import as_logged
from bench.studies.trial.true_effects import true_values as true_effect_values

WHOLE_ROBOT = "robot"


def known_values(robot: Robot, truth: Mapping[str, Any]) -> dict[str, float]:
    """True gains, base parameters and parameters of hidden effects; truth: the content of a truth file."""
    model = build_model(robot)
    values = true_values(model, truth)
    slides = {joint.name for joint in model.geometry.joints if joint.kind == "slide"}
    for hidden in as_logged(truth["hidden"]):
        joint = hidden.get("joint") or WHOLE_ROBOT
        parameters = true_effect_values(hidden["effect"], hidden, slide=joint in slides)
        values |= {effect_key(hidden["effect"], joint, name): value for name, value in parameters.items()}
    return values
