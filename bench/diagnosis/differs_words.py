"""What differs from run to run, in a sentence or two."""

from collections.abc import Sequence

from bench.diagnosis.result import Differing
from bench.effects.display_names import spoken
from bench.identification.wording import in_percent

DOMINANT = 3.0  # times what is left with it, must be left without it, where no effect explains that


def from_run_to_run(differs: Sequence[Differing], *, clear: bool) -> tuple[str, ...]:
    """The strongest with its values, then the others; clear: whether nothing is left that no effect explains."""
    if not differs:
        return ()
    first, *others = differs
    sure = clear or first.error_before > DOMINANT * first.error_after
    verb = "differs" if sure else "seems to differ"
    low = min(first.values, key=lambda log: first.values[log].value)
    high = max(first.values, key=lambda log: first.values[log].value)
    doubt = "" if sure else ", or something that no effect explains does the same"
    told = (
        f"The {_named(first)} {verb} from run to run: {_value(first, low)} and {_value(first, high)}{doubt}. "
        f"With a value for each recording the error of {first.joint} falls from {in_percent(first.error_before)} to "
        f"{in_percent(first.error_after)} on parts that were not fitted; `--with {first.request}` gives them."
    )
    said = [told]
    if others:
        names = [_named(differing) for differing in others]
        listed = names[0] if len(names) == 1 else f"{', '.join(names[:-1])} and {names[-1]}"
        requests = " ".join(f"--with {differing.request}" for differing in others)
        said.append(f"So {'does' if len(names) == 1 else 'do'} {listed} (`{requests}`).")
    return tuple(said)


def _named(differing: Differing) -> str:
    return f"{spoken(differing.effect)} at {differing.joint}"


def _value(differing: Differing, log: str) -> str:
    value = differing.values[log]
    return f"{value.value:.3g} ± {value.std:.1g} {value.unit.replace('*', '·')} in {log}"
