"""What a diagnosis did not look at before its time was up, in a sentence."""

from collections.abc import Mapping

from bench.basics.sentence import and_list
from bench.diagnosis.result import Diagnosis, Unfinished

NOT_LOOKED_AT: Mapping[Unfinished, str] = {
    Unfinished.CAUSES: "swapped columns and wrong payloads",
    Unfinished.SETS: "further effects of the catalogue and sets of them",
    Unfinished.OWN_VALUES: "values that differ from recording to recording",
    Unfinished.AS_GOOD: "models that explain the data as well, which would widen the gains' standard errors",
    Unfinished.LAWS: "laws outside the catalogue",
}


def unfinished_sentence(diagnosis: Diagnosis) -> str:
    """What was not looked at, or not to its end; "" where the search came to its end."""
    if diagnosis.finished:
        return ""
    missed = and_list([NOT_LOOKED_AT[code] for code in diagnosis.unfinished])
    return (
        f"The time limit ended the search. Not searched, or not completely: {missed}. A longer "
        "`--time-limit` includes them."
    )
