"""A diagnosis as Markdown, for the viewer's text panel: the verdict, the ladder, the ranking."""

from collections.abc import Sequence
from itertools import pairwise

from bench.diagnose.result import Diagnosis, LadderStep
from bench.diagnose.summary import reason, summary_sentences
from bench.effects.names import named_after
from bench.show.numbers import effect_name, percent
from bench.show.summary import markdown_table


def diagnosis_markdown(diagnosis: Diagnosis) -> str:
    """What is missing in sentences, the error after each added effect, and the verdicts with their reasons."""
    told = [one for one in diagnosis.ranking if one.verdict != "not supported"]
    others = [effect_name(one.effect) for one in diagnosis.ranking if one.verdict == "not supported"]
    parts = ["### What is missing", "\n\n".join(map(named_after, summary_sentences(diagnosis)))]
    parts += ["### Error after each added effect", _ladder(diagnosis)]
    if told:
        rows = [
            [
                f"**{effect_name(one.effect)}**"
                if one.effect in diagnosis.missing
                else effect_name(one.effect),
                one.verdict,
                "–" if one.verdict == "absorbed" else f"{one.evidence:.1f}",
                ", ".join(one.actuators) or "–",
                ", ".join(effect_name(name) for name in one.alternatives) or "–",
            ]
            for one in told
        ]
        parts += [
            "### Ranking",
            markdown_table(["effect", "verdict", "evidence", "at", "could as well be"], rows),
        ]
    if others:
        parts.append(f"Not supported: {', '.join(others)}.")
    if told:
        parts.append("\n".join(f"- {named_after(reason(diagnosis, one))}" for one in told))
    return "\n\n".join(parts) + "\n"


def step_labels(steps: Sequence[LadderStep]) -> list[str]:
    """A ladder's steps in words, as in "the model as it is", "+ coulomb friction"."""
    labels = ["the model as it is"]
    for before, after in pairwise(steps):
        labels.append(
            "+ " + ", ".join(effect_name(name) for name in after.effects if name not in before.effects)
        )
    return labels


def _ladder(diagnosis: Diagnosis) -> str:
    rows = [
        [label, percent(step.identify), percent(step.validate)]
        for label, step in zip(step_labels(diagnosis.ladder), diagnosis.ladder, strict=True)
    ]
    rows.append(["*noise of the currents*", "", percent(diagnosis.unexplained.noise_floor)])
    return markdown_table(["", "fitted", "not fitted"], rows)
