"""Geoms that touch, in words, and how an MJCF keeps them from colliding."""

from collections.abc import Mapping, Sequence
from typing import Any

from bench.robot_check.bounds import PLAUSIBLE
from bench.robot_check.contacts import GeomPair


def pairs_in_words(pairs: Sequence[GeomPair]) -> str:
    """The pairs, the first ones by name."""
    alike = list(dict.fromkeys(map(_pair, pairs)))
    named, others = alike[: PLAUSIBLE.named], len(alike) - PLAUSIBLE.named
    return "; ".join([*named, f"{others} more"] if others > 0 else named)


def without_contacts(pairs: Sequence[GeomPair]) -> str:
    """What to write in the MJCF, as an imperative."""
    bodies = list(dict.fromkeys(pair.bodies for pair in pairs if not pair.listed))
    cures = ["delete the <pair> of these geoms"] if any(pair.listed for pair in pairs) else []
    if bodies:
        excluded = "".join(
            f'<exclude body1="{first}" body2="{second}"/>' for first, second in bodies[: PLAUSIBLE.named]
        )
        more = " and so on" if len(bodies) > PLAUSIBLE.named else ""
        cures.append(
            f'write contype="0" conaffinity="0" at these geoms, or <contact>{excluded}</contact>{more}'
        )
    return "; ".join(cures)


def geoms_touch(pairs: Sequence[Mapping[str, Any]], at_home: bool, touching: int, poses: int) -> str:
    """The note of `bench robot check`."""
    both = [GeomPair(**pair) for pair in pairs]
    where = "at home" if at_home else f"in {touching} of {poses} poses within the ranges"
    return (
        f"geoms touch {where}: {pairs_in_words(both)}; MuJoCo pushes them apart, the model and `bench simulate` have "
        f"no contacts: {without_contacts(both)}"
    )


def _pair(pair: GeomPair) -> str:
    first, second = (
        f"{repr(name) if name else shape} of {body}"
        for name, shape, body in zip(pair.geoms, pair.shapes, pair.bodies, strict=True)
    )
    return f"{first} and {second}"
