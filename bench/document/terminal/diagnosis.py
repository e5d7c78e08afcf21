"""A diagnosis in a terminal: the verdict in a few sentences, then the evidence for it."""

from collections.abc import Sequence

from rich.console import Console
from rich.text import Text

from bench.diagnosis.reason_words import validated_on
from bench.diagnosis.result import Diagnosis, EffectVerdict
from bench.diagnosis.summary import reason, summary_sentences
from bench.document.diagnosis import (
    INDISTINGUISHABLE,
    gains_before_after,
    ladder_table,
    parameters_before_after,
    ranking_table,
    sets_table,
    something_else_words,
    without_logs_table,
)
from bench.document.identification import effects_table
from bench.document.layout import TEXT
from bench.document.numbers import STD_FROM
from bench.document.terminal.identification import heading, section, sentences_list
from bench.document.terminal.tables import printed
from bench.effects.display_names import named_after, spoken


def diagnosis_report(diagnosis: Diagnosis, console: Console, *, verbose: bool = False) -> None:
    """Print verdict, ladder, ranking, reasons, and the changes of gains and parameters, to fit the console's width.

    verbose: show every effect of the catalogue and every parameter.
    """
    width = console.width
    have = ", ".join(diagnosis.before.effects) or "rigid bodies only"
    facts = f"model with {have} · judged on {validated_on(diagnosis)}"
    heading(console, diagnosis.robot, facts)
    console.print()
    for sentence in map(named_after, summary_sentences(diagnosis)):
        console.print(Text(sentence))
    section(console, "Ladder: error after each added effect", printed(ladder_table(diagnosis), width))
    ranked, left_out = _shown(diagnosis.ranking, verbose)
    section(console, "Ranking", printed(ranking_table(diagnosis, ranked), width))
    console.print(
        Text(
            "evidence: log-likelihood ratio on recordings that were not fitted, in nats (one is odds of e, 2.7, to 1); "
            "10, odds of 20,000 to 1, are strong",
            "dim",
        )
    )
    console.print(
        Text("probability: that the effect is there, given that the catalogue holds what is there", "dim")
    )
    console.print(Text(something_else_words(diagnosis), "dim"))
    if any(verdict.alternatives for verdict in diagnosis.ranking):
        console.print(Text(INDISTINGUISHABLE, "dim"))
    if diagnosis.missing:
        console.print(Text("size: RMS torque of the effect, in brackets as a share of the motor's", "dim"))
    if left_out:
        names = ", ".join(spoken(verdict.effect) for verdict in left_out)
        console.print(Text(f"not supported, too: {names}", "dim"))
    if diagnosis.without_logs and diagnosis.missing:
        section(console, "With each log omitted", printed(without_logs_table(diagnosis), width))
    if len(diagnosis.sets) > 1:
        section(console, "Sets of effects, by probability", printed(sets_table(diagnosis), width))
    explained = [
        verdict
        for verdict in ranked
        if verbose or not diagnosis.missing or verdict.verdict != "not supported"
    ]
    section(
        console, "Why", sentences_list([named_after(reason(diagnosis, verdict)) for verdict in explained])
    )
    if diagnosis.added:
        if diagnosis.after.gains_fitted:
            gains = gains_before_after(diagnosis.before, diagnosis.after)
            section(console, "Drive gains, before and after", printed(gains, width))
            if diagnosis.after.std_from != "noise":
                console.print(Text(f"± after from {STD_FROM[diagnosis.after.std_from]}", "dim"))
        moved, still = parameters_before_after(diagnosis, None if verbose else TEXT.parameters)
        section(console, "Dynamic parameters, before and after", printed(moved, width))
        if still:
            console.print(Text(f"{still} more move less", "dim"))
        section(console, "Effects of the model", printed(effects_table(diagnosis.after), width))
    notes = list(dict.fromkeys(diagnosis.after.notes))
    if notes:
        section(console, "Notes", sentences_list(notes))
    console.print()


def _shown(
    ranking: Sequence[EffectVerdict], verbose: bool
) -> tuple[list[EffectVerdict], list[EffectVerdict]]:
    """The verdicts that are shown, and those only listed: the unsupported ones except the first few."""
    unsupported = [verdict for verdict in ranking if verdict.verdict == "not supported"]
    left_out = [] if verbose else unsupported[TEXT.unsupported :]
    return [verdict for verdict in ranking if verdict not in left_out], left_out
