"""Hidden effects by their share of the torque: the same axis for every effect and every robot.

`hidden_effect` names an effect, and `hidden_share` is its share of the motors' torque (RMS over RMS; 0.1 is a tenth).
`hidden_joint` selects one joint instead of all. The parameters follow from the motion.
"""

import json
from collections.abc import Mapping
from functools import lru_cache
from typing import Any

from bench.basics.errors import BenchError
from bench.scenario.scenario import scenario_from_dict
from bench.scenario.trajectory import FourierTrajectory
from bench.truth.hidden import HIDDEN_EFFECTS, JointEffect
from bench.truth.hidden.reference import Reference
from bench.truth.hidden.sizes import typical
from bench.truth.simulate import simulate

KEYS = ("hidden_effect", "hidden_share", "hidden_joint")


def without_share(content: Mapping[str, Any]) -> dict[str, Any]:
    """The content of a scenario file without these keys. Raises BenchError if they are inconsistent or invalid."""
    effect, share = content.get("hidden_effect"), content.get("hidden_share")
    if (effect is None) != (share is None):
        raise BenchError("hidden_effect and hidden_share go together")
    if effect is not None and effect not in HIDDEN_EFFECTS:
        raise BenchError(f"hidden_effect: no effect {effect!r}; there are {', '.join(HIDDEN_EFFECTS)}")
    if share is not None and (
        isinstance(share, bool) or not isinstance(share, int | float) or not 0 <= share < 1
    ):
        raise BenchError(f"hidden_share: should be a number from 0 to 1, got {share!r}")
    return {key: value for key, value in content.items() if key not in KEYS}


def with_sized_effect(
    content: Mapping[str, Any], name: str, trajectories: Mapping[str, FourierTrajectory]
) -> dict[str, Any]:
    """The content with the effect in its `hidden` entries, sized for the motion; without it if the share is 0."""
    plain = without_share(content)
    if not content.get("hidden_share"):
        return plain
    effect, share = content["hidden_effect"], content["hidden_share"]
    motions = json.dumps({recording: motion.to_dict() for recording, motion in trajectories.items()})
    reference = _reference(json.dumps({**plain, "hidden": []}), name, motions)
    kind = HIDDEN_EFFECTS[effect]
    joints: tuple[str | None, ...] = reference.simulation.robot.joints
    if content.get("hidden_joint") is not None:
        joints = (content["hidden_joint"],)
    elif not issubclass(kind, JointEffect) or kind.where == "passive":
        joints = (None,)
    entries = []
    for joint in joints:
        entry = {"effect": effect, **typical(effect, reference, share, joint)}
        entries.append(entry if joint is None else {**entry, "joint": joint})
    return {**plain, "hidden": [*plain.get("hidden", []), *entries]}


@lru_cache(maxsize=2)
def _reference(content: str, name: str, trajectories: str) -> Reference:
    """The motion of a scenario with these trajectories, both as JSON."""
    motions = {name: FourierTrajectory.from_dict(entry) for name, entry in json.loads(trajectories).items()}
    return Reference(simulate(scenario_from_dict(json.loads(content), name), motions, threads=1))
