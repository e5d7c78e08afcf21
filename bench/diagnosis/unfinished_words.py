"""What a diagnosis did not look at before its time was up, in a sentence."""

from collections.abc import Mapping

from bench.diagnosis.result import Diagnosis, Unfinished
from bench.identification.wording import and_list

NOT_LOOKED_AT: Mapping[Unfinished, str] = {
    Unfinished.CAUSES: "columns that are swapped and loads that are others",
    Unfinished.SETS: "effects of the catalogue, and sets of them, beyond those named",
    Unfinished.OWN_VALUES: "values that differ from recording to recording",
    Unfinished.AS_GOOD: "models that explain the data as well, which the gains' standard errors would hold",
    Unfinished.LAWS: "laws that are in no catalogue",
}


def unfinished_sentence(diagnosis: Diagnosis) -> str:
    """What was not looked at, or not to its end; "" where the search came to its end."""
    if diagnosis.finished:
        return ""
    missed = and_list([NOT_LOOKED_AT[code] for code in diagnosis.unfinished])
    return (
        f"The time was up before the search had ended. Not looked at, or not to the end: {missed}. A longer "
        "`--time-limit` looks at them."
    )
