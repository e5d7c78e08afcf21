"""What a proof says, in words."""

from bench.excitation.experiment.open_limits import Kept
from bench.excitation.experiment.proof import Unproven


def limit_in_words(told: Unproven) -> str:
    """A limit that could not be proven, and when."""
    if told.limit is Kept.WORKSPACE:
        what = f"workspace[{told.where}]"
    else:
        what = f"the {told.limit}" + (f" of {told.where}" if told.where else "")
    return what if told.time is None else f"{what} at t = {told.time:.4f} s"
