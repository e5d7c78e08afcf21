"""Numbers in a sentence."""


def in_percent(share: float | None) -> str:
    """A share as a percentage of three digits; "–" where there is none."""
    return "–" if share is None else f"{100.0 * share:.3g} %"
