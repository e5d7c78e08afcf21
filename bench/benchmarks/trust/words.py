"""Cases as text: the hidden effects, the effects that the diagnosis names, and the most frequent mistakes."""

from collections import Counter
from collections.abc import Sequence

from bench.benchmarks.trust.questions import QUESTIONS
from bench.benchmarks.trust.stability import CERTAIN, verdicts_of
from bench.effects.display_names import begun, spoken
from bench.studies.sweep.journal import OK, Row, names_in
from bench.studies.trial.compatible import expected, optional
from bench.studies.trial.unknown import LAW

NOTHING = "nothing"


def hidden_text(row: Row) -> str:
    """The hidden effects with their joints."""
    pairs = zip(names_in(row["hidden"]), names_in(row["joints"]), strict=True)
    said = [f"{'a law' if effect == LAW else spoken(effect)} ({joints})" for effect, joints in pairs]
    return ", ".join(said) or NOTHING


def answer_text(row: Row) -> str:
    """The named effects, with the verdict unless certain, the number of laws, and whether an error is unexplained."""
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


SENTENCES = 3
Mistake = tuple[str, str]
"""The kind of mistake, and the effect, "" for none."""

MISSED, ADDED, SILENT, NOT_MODELLED = "missed", "added", "silent", "not modelled"


def mistakes_of(row: Row) -> list[Mistake]:
    """The mistakes in a case with a wrong answer: hidden effects not named, named effects not hidden, unknown effects
    on which nothing is said, and laws not modelled.
    """
    hidden, named = names_in(row["hidden"]), names_in(row["missing"])
    uncatalogued = (
        {LAW} if row["question"] == "unknown" else set(hidden) if row["question"] == "outside" else set()
    )
    there = set(expected(hidden)) - uncatalogued
    mistakes = [(MISSED, name) for name in sorted(there - set(named))]
    mistakes += [(ADDED, name) for name in named if name not in there | optional(hidden)]
    if row["question"] == "outside" and not (row["laws"] or row["unexplained"]):
        mistakes.append((SILENT, hidden[0]))
    if row["question"] == "unknown" and not mistakes:
        mistakes.append((NOT_MODELLED, ""))
    return mistakes


def is_wrong(row: Row) -> bool:
    """Whether a case counts and its answer is wrong."""
    question = QUESTIONS[row["question"]]
    return question.counts(row) and question.wrong(row)


def sentences(rows: Sequence[Row]) -> list[str]:
    """Sentences on the most frequent mistakes, with the number of cases that could have them, and the robots."""
    judged = [row for row in rows if QUESTIONS[row["question"]].counts(row)]
    counts: Counter[Mistake] = Counter()
    robots: dict[Mistake, Counter[str]] = {}
    for row in judged:
        for mistake in mistakes_of(row) if is_wrong(row) else ():
            counts[mistake] += 1
            robots.setdefault(mistake, Counter())[row["robot"]] += 1
    return [
        _sentence(mistake, count, robots[mistake], judged) for mistake, count in counts.most_common(SENTENCES)
    ]


def _sentence(mistake: Mistake, count: int, robots: Counter[str], judged: Sequence[Row]) -> str:
    what, effect = mistake
    where = ", ".join(f"{robot} {n}" for robot, n in robots.most_common())
    hiding = sum(effect in expected(names_in(row["hidden"])) for row in judged)
    if what == MISSED:
        return f"{begun(effect)} is not named in {count} of {hiding} cases with it ({where})."
    if what == ADDED:
        without = [row for row in judged if effect not in expected(names_in(row["hidden"]))]
        sure = sum(verdicts_of(row).get(effect) == CERTAIN for row in without)
        return (
            f"{begun(effect)} is named in {count} of {len(without)} cases without it, in {sure} of them with certainty "
            f"({where})."
        )
    if what == SILENT:
        return f"Nothing is said of {spoken(effect)} in {count} of {hiding} cases with it ({where})."
    laws = sum(LAW in names_in(row["hidden"]) for row in judged)
    return f"A law in no catalogue leaves more than the noise in {count} of {laws} cases with one ({where})."
