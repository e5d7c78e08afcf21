"""A diagnosis as Markdown, for the viewer's text panel: the verdict, the ladder, the ranking."""

from bench.diagnosis.result import Diagnosis
from bench.diagnosis.summary import reason, summary_sentences
from bench.document.diagnosis import ladder_table, ranking_table
from bench.document.markdown.tables import markdown
from bench.document.numbers import effect_name
from bench.effects.display_names import named_after


def diagnosis_markdown(diagnosis: Diagnosis) -> str:
    """What is missing in sentences, the error after each added effect, and the verdicts with their reasons."""
    supported = [verdict for verdict in diagnosis.ranking if verdict.verdict != "not supported"]
    others = [
        effect_name(verdict.effect) for verdict in diagnosis.ranking if verdict.verdict == "not supported"
    ]
    parts = ["### What is missing", "\n\n".join(map(named_after, summary_sentences(diagnosis)))]
    parts += ["### Error after each added effect", markdown(ladder_table(diagnosis))]
    if supported:
        parts += ["### Ranking", markdown(ranking_table(diagnosis, supported))]
    if others:
        parts.append(f"Not supported: {', '.join(others)}.")
    if supported:
        parts.append("\n".join(f"- {named_after(reason(diagnosis, verdict))}" for verdict in supported))
    return "\n\n".join(parts) + "\n"
