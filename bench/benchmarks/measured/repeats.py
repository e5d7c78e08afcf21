"""Whether logs of one machine agree within their standard errors; each log, or half of all, is identified alone."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from itertools import combinations
from math import hypot
from pathlib import Path
from typing import Literal

import numpy as np

from bench.basics.files.atomic import write_json_atomically, write_text_atomically
from bench.dataset.dataset import Dataset, load_dataset
from bench.effects import CATALOGUE
from bench.identification.chosen_band import prepare_checked, usual_friction
from bench.identification.identify import identify
from bench.identification.model_averaged import in_both
from bench.identification.problem import problem_of

FRICTION = tuple(usual_friction(CATALOGUE))
WITHIN = 2.0  # standard errors
GOAL_RMS, GOAL_WITHIN = 1.3, 0.92
Kind = Literal["logs", "halves"]


@dataclass(frozen=True)
class Repeats:
    """Agreement of values of the same unknowns, by z = (a - b) / sqrt(s_a^2 + s_b^2) over all pairs and unknowns.

    answers: number of identifications; values: of z; rms, within, largest: its RMS, the share within 2, its largest
    size.
    """

    machine: str
    kind: Kind
    answers: int
    values: int
    rms: float
    within: float
    largest: float

    @property
    def reached(self) -> bool:
        """Whether both goals are reached."""
        return self.rms <= GOAL_RMS and self.within >= GOAL_WITHIN


def repeats_of(machine: str, folder: Path, kind: Kind, logs: Sequence[str] = ()) -> Repeats:
    """Identify each log of a dataset, or each half of its fitted logs, and compare them. logs: only these, by name."""
    dataset = load_dataset(folder)
    kept = [log for log in dataset.recordings if not logs or log.name in logs]
    dataset = replace(dataset, recordings=tuple(kept))
    parts = _parts(dataset, kind)
    answers = [identify(prepare_checked(problem_of(part, FRICTION))) for part in parts]
    pairs = [pair for both in combinations(answers, 2) for pair in in_both(*both).values()]
    z = np.array([(a.value - b.value) / hypot(a.std, b.std) for a, b in pairs])
    size = np.abs(z)
    return Repeats(
        machine,
        kind,
        len(answers),
        len(z),
        float(np.sqrt(np.mean(z**2))),
        float((size <= WITHIN).mean()),
        float(size.max()),
    )


def _parts(dataset: Dataset, kind: Kind) -> Iterator[Dataset]:
    """Each log, or the first and the second half of all fitted ones, as a dataset that is fitted."""
    if kind == "logs":
        for log in dataset.recordings:
            yield replace(dataset, recordings=(replace(log, use="identify"),))
        return
    fitted = [log for log in dataset.recordings if log.use == "identify"]
    for half in (0, 1):
        ends = ((half * len(log.time) // 2, (half + 1) * len(log.time) // 2) for log in fitted)
        halves = (log.part(slice(*end)) for log, end in zip(fitted, ends, strict=True))
        yield replace(dataset, recordings=tuple(halves))


COMPARED: Sequence[tuple[str, Kind, Sequence[str]]] = (
    ("psm1", "logs", ("t1.csv", "t2.csv", "t3.csv", "t4.csv")),
    ("kuka", "logs", ()),
    ("mtm", "logs", ()),
    ("double_pendulum", "logs", ()),
    ("ur10e", "halves", ()),
    ("emps", "halves", ()),
    ("psm", "halves", ()),
    ("tx40", "halves", ()),
)
"""Machine, what is compared, and which of its logs (all if empty); two more logs of psm1 are of another state of it."""


def repeats_markdown(rows: Sequence[Repeats], program: Mapping[str, str]) -> str:
    """The table in Markdown, with an explanation."""
    friction = " ".join(f"--with {name}" for name in FRICTION)
    explanation = (
        f"Each log of a machine, or each half of all its fitted logs, is identified by itself with `bench identify "
        f"{friction}`. For two values of the same unknown with the stated standard errors, z = (a - b) / sqrt(s_a^2 + "
        f"s_b^2). Goals: RMS z of at most {GOAL_RMS:g}, and at least {100 * GOAL_WITHIN:g} % within 2."
    )
    lines = [
        "| machine | compared | values | RMS z | within 2 | largest | goals |",
        "| --- | --- | ---: | ---: | ---: | ---: | --- |",
    ]
    lines += [
        f"| {row.machine} | {row.answers} {row.kind} | {row.values} | {row.rms:.2f} | {100 * row.within:.0f} % | "
        f"{row.largest:.1f} | {'yes' if row.reached else 'no'} |"
        for row in rows
    ]
    commit = f"Program: commit {program.get('commit', 'unknown')}."
    return "\n\n".join(["# Repeats", explanation, commit, "\n".join(lines)]) + "\n"


def keep_repeats(rows: Sequence[Repeats], program: Mapping[str, str], folder: Path) -> Path:
    """Write the table and its values into the subfolder repeats; return the path of the table."""
    content = {"program": dict(program), "rows": [asdict(row) for row in rows]}
    write_json_atomically(folder / "repeats" / "repeats.json", content)
    page = folder / "repeats" / "repeats.md"
    write_text_atomically(page, repeats_markdown(rows, program))
    return page
