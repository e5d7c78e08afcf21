"""What depends on a log, and what is in the model though no data prove it, in words."""

from collections.abc import Sequence

from bench.basics.sentence import and_list, capital
from bench.diagnosis.result import Diagnosis
from bench.effects.display_names import spoken


def by_log_sentence(diagnosis: Diagnosis) -> str:
    """Which names stay whichever log is omitted, and on which logs the others depend; "" where nothing is named."""
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
    """Friction that is in the model without being missing; "" where none is."""
    if not names:
        return ""
    are, them = ("is", "it") if len(names) == 1 else ("are", "them")
    friction = capital(and_list([spoken(name) for name in names]))
    return (
        f"{friction} {are} in the model, too, though these recordings do not prove {them}: without {them}, those that "
        "were not fitted are explained worse than with viscous and Coulomb friction and an offset alone."
    )
