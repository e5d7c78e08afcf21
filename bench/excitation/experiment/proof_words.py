"""What a proof says, in words."""

from bench.excitation.experiment.open_limits import Kept
from bench.excitation.experiment.proof import Unproven


def limit_in_words(told: Unproven) -> str:
    """A limit that could not be proven, when, and why the loops could not be closed there."""
    if told.limit is Kept.WORKSPACE:
        what = f"workspace[{told.where}]"
    else:
        what = f"the {told.limit}" + (f" of {told.where}" if told.where else "")
    when = "" if told.time is None else f" at t = {told.time:.4f} s"
    why = f" ({told.why})" if told.why else ""
    return f"{what}{when}{why}"
