"""Result of a proof in words."""

from bench.excitation.experiment.open_limits import Kept
from bench.excitation.experiment.proof import Unproven


def limit_in_words(unproven: Unproven) -> str:
    """A limit that could not be proven, when, and why the loops could not be closed there."""
    if unproven.limit is Kept.WORKSPACE:
        what = f"workspace[{unproven.where}]"
    else:
        what = f"the {unproven.limit}" + (f" of {unproven.where}" if unproven.where else "")
    when = "" if unproven.time is None else f" at t = {unproven.time:.4f} s"
    why = f" ({unproven.why})" if unproven.why else ""
    return f"{what}{when}{why}"


def refused(unproven: Unproven) -> str:
    """`limit_in_words`, and what relaxes the limit."""
    return f"{limit_in_words(unproven)}; {_CURES[unproven.limit]}"


def made_smaller(name: str, unproven: Unproven) -> str:
    """A sentence on the motion of that name, which was made smaller: the limit, where, what relaxes it."""
    when = "" if unproven.time is None else f"at t = {unproven.time:.4g} s "
    because = _IN_THE_WAY[unproven.limit].format(unproven.where)
    return f"The motion {name!r} was reduced, because {when}{because}; {_CURES[unproven.limit]}."


_IN_THE_WAY = {
    Kept.LOOPS: "it could not be proven that the loops stay closed in one assembly mode",
    Kept.AMPLIFICATION: "{0} would move too fast for the motors' speed",
    Kept.SINGULAR: "it came too close to a singular pose",
    Kept.PASSIVE_RANGE: "{0} would leave its range",
    Kept.WORKSPACE: "the tool would leave workspace[{0}]",
    Kept.TORQUE: "{0} would need too much torque",
}
_CURES = {
    Kept.LOOPS: "smaller ranges (`position` in the file of --limits) avoid such poses",
    Kept.AMPLIFICATION: "a larger `amplification` in the file of --limits allows it",
    Kept.SINGULAR: "smaller ranges (`position` in the file of --limits) avoid it",
    Kept.PASSIVE_RANGE: "a larger `range` in the MJCF, or a home further inside it, allows it",
    Kept.WORKSPACE: "a larger box in the file of --limits allows it",
    Kept.TORQUE: "a larger `torque` or `current` in the file of --limits allows it",
}
