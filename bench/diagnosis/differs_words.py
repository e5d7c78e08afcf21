"""What differs from run to run, in a sentence or two."""

from collections.abc import Collection, Sequence

from bench.basics.sentence import and_list, in_percent
from bench.diagnosis.result import Differing
from bench.effects.display_names import spoken
from bench.identification.decision import RULE


def from_run_to_run(
    differs: Sequence[Differing], in_model: Collection[str] = (), *, clear: bool
) -> tuple[str, ...]:
    """The strongest with its values, then the others; in_model: requests of those that the answer holds so; clear:
    whether nothing remains that no effect explains.
    """
    if not differs:
        return ()
    first, *others = differs
    sure = clear or first.error_before > RULE.dominant * first.error_after
    verb = "differs" if sure else "seems to differ"
    low = min(first.values, key=lambda log: first.values[log].value)
    high = max(first.values, key=lambda log: first.values[log].value)
    doubt = "" if sure else ", or an unexplained error looks the same"
    given = f"`--with {first.request}` estimates these values"
    if first.request in in_model:
        given = f"the answer contains them, as {given}"
    opening = (
        f"The {_named(first)} {verb} from run to run: {_value(first, low)} and {_value(first, high)}{doubt}. "
        f"With one value per recording the error of {first.joint} falls from {in_percent(first.error_before)} to "
        f"{in_percent(first.error_after)} on parts that were not fitted; {given}."
    )
    said = [opening]
    if others:
        names = [_named(differing) for differing in others]
        requests = [
            f"--with {differing.request}" for differing in others if differing.request not in in_model
        ]
        proposed = f" (`{' '.join(requests)}`)" if requests else ""
        said.append(f"So {'does' if len(names) == 1 else 'do'} {and_list(names)}{proposed}.")
    return tuple(said)


def _named(differing: Differing) -> str:
    return f"{spoken(differing.effect)} at {differing.joint}"


def _value(differing: Differing, log: str) -> str:
    value = differing.values[log]
    return f"{value.value:.3g} ± {value.std:.1g} {value.unit.replace('*', '·')} in {log}"
