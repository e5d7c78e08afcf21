"""Select effects by name and place."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import accumulate, pairwise

from bench.basics.errors import BenchError, meant
from bench.effects.catalogue import CATALOGUE
from bench.effects.effect import Effect, Place
from bench.effects.places import Places
from bench.model.reaction import undetermined_by

ROBOT = "robot"  # the place of an effect of the whole robot, among the joints
TAG = "@recording"  # behind an effect or its place: a value for each recording

NOWHERE: dict[Place, str] = {
    "actuator": "the robot has no motor",
    "passive": "the robot has no joint without a motor that can have it",
    "bearing": "the robot has no joint without a motor whose force follows from the motion",
    "body": "no body of the robot has a length",
    "payload": "the dataset has no payload of known mass",
}


UNDETERMINED = {
    "closures": "closures of loops repeat one another there, so that others could bear it as well",
    "masses": "it depends on where bodies have their mass in a way that no motor's torque shows",
}


@dataclass(frozen=True)
class EffectInstance:
    """An effect at one place (empty: the whole robot); `request` is how the user named it.

    recording: the one to which this value belongs, of those `among` which the effect has a value each; empty if one
    value holds for all.
    """

    effect: Effect
    joint: str
    request: str
    recording: str = ""
    among: tuple[str, ...] = ()

    @property
    def name(self) -> str:
        """The name of its effect."""
        return self.effect.name

    @property
    def seat(self) -> tuple[str, str]:
        """Its effect and joint, whatever the recording of its value."""
        return self.effect.name, self.joint

    @property
    def key(self) -> tuple[str, str]:
        """Its effect and the name of its values."""
        return self.effect.name, self.place

    @property
    def place(self) -> str:
        """The name of its values: left, robot, or left@unloaded.csv."""
        return (self.joint or ROBOT) + (f"@{self.recording}" if self.recording else "")

    def share(self, log: str) -> float:
        """Share of its columns in a recording: one without a value gets the mean of all values."""
        if not self.recording:
            return 1.0
        if log in self.among:
            return float(log == self.recording)
        return 1.0 / len(self.among)

    def everywhere(self) -> "EffectInstance":
        """The same effect with one value for all recordings."""
        return replace(self, recording="", among=()) if self.recording else self


def at_joint(effect: Effect, joint: str) -> EffectInstance:
    """An effect at one joint, with one value for all recordings."""
    return EffectInstance(effect, joint, f"{effect.name}:{joint}")


def with_value_each(effect: Effect, joint: str, logs: tuple[str, ...]) -> list[EffectInstance]:
    """An effect at one joint, with a value for each of the logs."""
    return [EffectInstance(effect, joint, f"{effect.name}:{joint}{TAG}", log, logs) for log in logs]


def parameter_slices(effects: Sequence[EffectInstance]) -> list[tuple[EffectInstance, slice]]:
    """Every effect, and the slice of its parameters among those of all."""
    ends = accumulate((len(instance.effect.parameters) for instance in effects), initial=0)
    return [(instance, slice(*part)) for instance, part in zip(effects, pairwise(ends), strict=True)]


def select_effects(
    requests: Sequence[str],
    places: Places,
    catalogue: Mapping[str, Effect] = CATALOGUE,
    recordings: Sequence[str] = (),
) -> tuple[EffectInstance, ...]:
    """Effects named as EFFECT (at all its places) or EFFECT:PLACE, in the order given.

    With @recording behind it an effect has a value for each of the `recordings`, the fitted ones by name.
    Raises BenchError that names an unknown effect, place or tag, an effect given twice for one place, or one that
    cannot have a value for each recording.
    """
    instances: list[EffectInstance] = []
    for request in requests:
        name, joint, each = _parts(request, places)
        if name not in catalogue:
            raise BenchError(f"unknown effect {name!r}; {meant(name, catalogue, 'known:')}")
        effect = catalogue[name]
        possible = places.where(effect)
        if effect.place == "bearing" and joint in places.passive and joint not in possible:
            assert places.geometry is not None  # else there were no passive joints
            why = undetermined_by(places.geometry, places.geometry.joint_index(joint))
            raise BenchError(
                f"effect {request!r}: the force in joint {joint!r} does not follow from the motion: {UNDETERMINED[why]}"
            )
        if joint and joint not in possible:
            near = meant(
                joint, [word for word in possible if word] or ["only the robot as a whole"], "there are:"
            )
            what = "joint" if effect.place in ("actuator", "passive", "bearing", "robot") else effect.place
            raise BenchError(f"effect {request!r}: no {what} {joint!r} where it can sit; {near}")
        if not possible:
            raise BenchError(f"effect {request!r}: {NOWHERE[effect.place]}")
        if each and not can_differ(effect):
            able = ", ".join(
                sorted(key for key, known_effect in catalogue.items() if can_differ(known_effect))
            )
            raise BenchError(
                f"effect {request!r}: {name} cannot have a value for each recording; those that can: {able}"
            )
        among = tuple(recordings) if each else ()
        for at in [joint] if joint else possible:
            if any(instance.name == name and instance.joint == at for instance in instances):
                raise BenchError(f"effect {name!r} is given twice for {at or 'the robot'!r}")
            instances += [
                EffectInstance(places.effect_at(effect, at), at, request, word, among)
                for word in among or [""]
            ]
    return tuple(instances)


def can_differ(effect: Effect) -> bool:
    """Whether an effect can have a value for each recording: no shape parameter, and not a length or payload, which do
    not change.
    """
    return not effect.shape and effect.place in {"actuator", "passive", "bearing", "robot"}


def _parts(request: str, places: Places) -> tuple[str, str, bool]:
    """Name, place (empty: everywhere) and whether a value for each recording is requested."""
    named = request.removesuffix(TAG)
    name, _, joint = named.partition(":")
    plain = request.partition(":")[2]
    if plain in places.names:  # may have an @ in it
        return name, plain, False
    joint_or_name = joint or name
    if "@" in joint_or_name and joint not in places.names:
        tag = joint_or_name[joint_or_name.rindex("@") :]
        raise BenchError(
            f"effect {request!r}: {tag!r} has no meaning; {TAG} estimates values for each fitted recording; "
            "without it one value holds for all"
        )
    return name, joint, named != request
