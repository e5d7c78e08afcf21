"""What a diagnosis depends on, in sentences: its time limit, single logs, the usual friction, values of each run."""

from collections.abc import Collection, Mapping, Sequence

from bench.basics.sentence import and_list, capital, in_percent
from bench.diagnosis.result import Diagnosis, Differing, Unfinished
from bench.effects.display_names import spoken
from bench.identification.decision import RULE

NOT_LOOKED_AT: Mapping[Unfinished, str] = {
    Unfinished.CAUSES: "swapped columns and wrong payloads",
    Unfinished.SETS: "further effects of the catalogue and sets of them",
    Unfinished.OWN_VALUES: "values that differ from recording to recording",
    Unfinished.AS_GOOD: "models that explain the data as well, which would widen the gains' standard errors",
    Unfinished.LAWS: "laws outside the catalogue",
}


def unfinished_sentence(diagnosis: Diagnosis) -> str:
    """What was not searched, or not completely; "" for a complete search."""
    if diagnosis.finished:
        return ""
    missed = and_list([NOT_LOOKED_AT[code] for code in diagnosis.unfinished])
    return (
        f"The time limit ended the search. Not searched, or not completely: {missed}. A longer "
        "`--time-limit` includes them."
    )


def by_log_sentence(diagnosis: Diagnosis) -> str:
    """Names that stay whichever log is omitted, and logs on which the others depend; "" without names."""
    rows = diagnosis.without_logs
    if not rows or not diagnosis.missing:
        return ""
    needed = {name: [row.log for row in rows if name in row.gone] for name in diagnosis.missing}
    stay = [spoken(name) for name, logs in needed.items() if not logs]
    depend = [f"{spoken(name)} on {and_list(logs)}" for name, logs in needed.items() if logs]
    parts = []
    if stay:
        parts.append(f"whichever log is omitted, {and_list(stay)} {'stays' if len(stay) == 1 else 'stay'}")
    if depend:
        first, _, on = depend[0].partition(" on ")
        parts.append(", ".join([f"{first} depends on {on}", *depend[1:]]))
    without = ": without such a log, the others do not show it" if depend else ""
    return f"{capital('; '.join(parts))}{without}."


def usual_sentence(names: Sequence[str]) -> str:
    """Friction in the model that is not missing; "" if there is none."""
    if not names:
        return ""
    are, them = ("is", "it") if len(names) == 1 else ("are", "them")
    friction = capital(and_list([spoken(name) for name in names]))
    return (
        f"{friction} {are} in the model, too, though these recordings do not prove {them}: without {them}, those that "
        "were not fitted are explained worse than with viscous and Coulomb friction and an offset alone."
    )


def from_run_to_run(
    differs: Sequence[Differing], in_model: Collection[str] = (), *, clear: bool
) -> tuple[str, ...]:
    """The strongest with its values, then the others; in_model: requests of those with such values in the answer;
    clear: whether effects explain the whole error.
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
