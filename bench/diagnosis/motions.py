"""Which motion brings an effect out, in a few words."""

from collections.abc import Sequence

from bench.effects import CATALOGUE, Effect


def telling_motions(effects: Sequence[str]) -> list[str]:
    """What to do to tell these effects apart, without repetitions."""
    return list(dict.fromkeys(CATALOGUE.get(name, Effect).shown_by for name in effects))
