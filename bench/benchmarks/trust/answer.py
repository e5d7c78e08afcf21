"""A case in words: what is hidden, and what the diagnosis names."""

from __future__ import annotations

import json

from bench.effects.display_names import spoken
from bench.studies.sweep.journal import Row
from bench.studies.sweep.work import OK
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
    verdicts = {verdict["effect"]: verdict["verdict"] for verdict in json.loads(row["verdicts"])}
    said = [
        spoken(name) + ("" if verdicts.get(name) == "missing" else f" ({verdicts.get(name)})")
        for name in names_in(row["missing"])
    ]
    if row["laws"]:
        said.append(f"{row['laws']} law" + "s" * (row["laws"] > 1))
    if row["unexplained"]:
        said.append("something unexplained")
    return ", ".join(said) or NOTHING
