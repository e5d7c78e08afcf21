"""A case in words: what is hidden, and what the diagnosis names."""

from __future__ import annotations

from bench.benchmarks.trust.stability import CERTAIN, verdicts_of
from bench.effects.display_names import spoken
from bench.studies.sweep.journal import OK, Row
from bench.studies.trial.name_list import names_in
from bench.studies.trial.unknown import LAW

NOTHING = "nothing"


def hidden_text(row: Row) -> str:
    """Effects with their joints."""
    pairs = zip(names_in(row["hidden"]), names_in(row["joints"]), strict=True)
    said = [f"{'a law' if effect == LAW else spoken(effect)} ({joints})" for effect, joints in pairs]
    return ", ".join(said) or NOTHING


def answer_text(row: Row) -> str:
    """Effects with their verdicts where these are not certain, laws, and whether something is unexplained."""
    if row["status"] != OK:
        return f"failed: {row['reason']}"
    said = [
        spoken(name) + ("" if verdict == CERTAIN else f" ({verdict})")
        for name, verdict in verdicts_of(row).items()
    ]
    if row["laws"]:
        said.append(f"{row['laws']} law" + "s" * (row["laws"] > 1))
    if row["unexplained"]:
        said.append("something unexplained")
    return ", ".join(said) or NOTHING
