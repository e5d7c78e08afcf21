"""A diagnosis in a terminal: the verdict in a few sentences, then the evidence for it."""

from collections.abc import Iterator, Sequence

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

EVIDENCE = (
    "evidence: log-likelihood ratio on recordings that were not fitted, in nats (one is odds of e, 2.7, to 1); 10, "
    "odds of 20,000 to 1, are strong"
)


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
    for key in _keys(diagnosis, left_out):
        console.print(Text(key, "dim"))
    if diagnosis.without_logs and diagnosis.missing:
        section(console, "With each log omitted", printed(without_logs_table(diagnosis), width))
    if len(diagnosis.sets) > 1:
        section(console, "Sets of effects, by probability", printed(sets_table(diagnosis), width))
    every = verbose or not diagnosis.missing
    explained = [verdict for verdict in ranked if every or verdict.verdict != "not supported"]
    reasons = [named_after(reason(diagnosis, verdict)) for verdict in explained]
    section(console, "Why", sentences_list(reasons))
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
    if notes := list(dict.fromkeys(diagnosis.after.notes)):
        section(console, "Notes", sentences_list(notes))
    console.print()


def _keys(diagnosis: Diagnosis, left_out: Sequence[EffectVerdict]) -> Iterator[str]:
    """What the columns of the ranking mean, and its omitted effects."""
    yield EVIDENCE
    yield "probability: that the effect is there, given that the catalogue holds what is there"
    yield something_else_words(diagnosis)
    if any(verdict.alternatives for verdict in diagnosis.ranking):
        yield INDISTINGUISHABLE
    if diagnosis.missing:
        yield "size: RMS torque of the effect, in brackets as a share of the motor's"
    if left_out:
        yield f"not supported, too: {', '.join(spoken(verdict.effect) for verdict in left_out)}"


def _shown(
    ranking: Sequence[EffectVerdict], verbose: bool
) -> tuple[list[EffectVerdict], list[EffectVerdict]]:
    """The verdicts that are shown, and those only listed: the unsupported ones except the first few."""
    unsupported = [verdict for verdict in ranking if verdict.verdict == "not supported"]
    left_out = [] if verbose else unsupported[TEXT.unsupported :]
    return [verdict for verdict in ranking if verdict not in left_out], left_out
