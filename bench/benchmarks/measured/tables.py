"""Records as rows of cells, for the Markdown and the HTML page."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from bench.benchmarks.measured.known import DRIVE_GAIN, PARAMETER, WITHIN, AgainstKnown, MachineTable
from bench.benchmarks.measured.run import MachineRun, NamedEffects, Record
from bench.benchmarks.measured.sentences import absent_values, machine_sentence, short_name
from bench.document.markdown.tables import rows_in_markdown
from bench.document.numbers import percent, pretty_unit, value_and_std
from bench.effects.display_names import spoken

_WORDS = {DRIVE_GAIN: "drive gain", PARAMETER: "base parameter"}
MOST_OTHERS = 3  # alternatives that are listed one by one
YES, NO, NONE = "yes", "NO", "–"
KNOWN_HEADS = ("quantity", "at", "known", "identify", "off by", "diagnose", "off by", "inside", "goal")
OMITTED_HEADS = ("without log", "effects not supported")
RUN_HEADS = (
    "command",
    "fitted",
    "not fitted",
    "goal",
    "inside",
    "goals reached",
    "processor",
    "verdict: missing",
)
VALUE_HEADS = ("quantity", "at", "value ± std", "unit", "known", "off by", "inside", "goal", "reached")
KNOWN_TITLE, RUNS_TITLE = "Known and estimated values", "Errors, and what is missing"
EXPLANATION = (
    "Each command uses only the robot's geometry and its nominal gains; known values serve for comparison. Inside: the "
    f"difference is within {WITHIN:g} standard errors plus the reference's own uncertainty. Goal: the largest "
    "acceptable difference. The model of bench identify has viscous and Coulomb friction and an offset; bench diagnose "
    "begins with rigid bodies."
)
ERRORS = (
    "Errors are those of the current, of fitted recordings and of recordings that were not fitted; goal: the largest "
    "acceptable error; processor: CPU seconds from start to end."
)


@dataclass(frozen=True)
class MeasuredCell:
    """A text in a table of records. right: whether the value is as it should be; None if that is not judged."""

    text: str
    right: bool | None = None

    @property
    def wrong(self) -> bool:
        """Whether the value is not as it should be."""
        return self.right is False


Cells = tuple[MeasuredCell, ...]


def known_rows(record: Record) -> Iterator[Cells]:
    """A row for every known value, with the estimates of the first identification and the first diagnosis."""
    runs = [run for run in record.runs if not run.failed]
    pair = [next((run for run in runs if run.diagnosis == diagnosis), None) for diagnosis in (False, True)]
    by_name = [{(row.quantity, row.place): row for row in run.rows} if run else {} for run in pair]
    for name in dict.fromkeys(name for rows in by_name for name in rows):
        both = [rows.get(name) for rows in by_name]
        first = next(row for row in both if row is not None)
        if first.known is None:
            continue
        unit = next((row.unit for row in both if row is not None and row.unit), "")
        quantity = f"{quantity_name(first)} [{pretty_unit(unit)}]"
        cells: list[str | MeasuredCell] = [quantity, first.place, _known(first)]
        for row in both:
            cells += [NONE, NONE] if row is None else [estimate(row), _off(row)]
        answers = [row for row in both if row is not None]
        yield _cells(
            *cells,
            _of_both([row.inside for row in answers]),
            _of_both([row.reached for row in answers]),
        )


def _off(against: AgainstKnown) -> str:
    return NONE if against.off is None else f"{100.0 * against.off:+.1f} %"


def _of_both(answers: Sequence[bool | None]) -> MeasuredCell:
    """YES if all commands with an answer are right, NO if none is, otherwise how many are."""
    known = [entry for entry in answers if entry is not None]
    if len(set(known)) < 2:
        return answer(known[0] if known else None)
    return MeasuredCell(plural(known), False)


def omitted_rows(run: MachineRun) -> Iterator[Cells]:
    """A row for each omitted log, with the effects that are not supported without it."""
    for row in run.omitted:
        yield _cells(row.log, ", ".join(spoken(name) for name in row.gone) or "none")


def run_rows(record: Record, table: MachineTable) -> Iterator[Cells]:
    """A row for every command: its errors, how many values are right, its processor time, and the effects it names."""
    for run in record.runs:
        if run.failed:
            none = [NONE] * 5
            yield _cells(f"bench {run.command}", *none, f"{run.seconds:.3g} s", f"failed: {run.failed}")
            continue
        yield _cells(
            f"bench {run.command}",
            percent(run.error_identify),
            percent(run.error_validate),
            error_goal(run, table),
            plural([known.inside for known in run.rows]),
            plural([known.reached for known in run.rows]),
            f"{run.seconds:.3g} s",
            said_missing(run),
        )


def _cells(*entries: str | MeasuredCell) -> Cells:
    return tuple(MeasuredCell(entry) if isinstance(entry, str) else entry for entry in entries)


def error_goal(run: MachineRun, table: MachineTable) -> MeasuredCell:
    """The goal for the fitted error, and whether it is reached."""
    if table.error_goal is None or run.error_identify is None:
        return MeasuredCell(NONE)
    reached = run.error_identify <= table.error_goal
    return MeasuredCell(f"{percent(table.error_goal)} {YES if reached else NO}", reached)


def plural(answers: Sequence[bool | None]) -> str:
    """How many of the known answers are right, as in "3 of 4"."""
    known = [entry for entry in answers if entry is not None]
    return f"{sum(known)} of {len(known)}" if known else NONE


def said_missing(run: MachineRun) -> str:
    """The effects that a diagnosis identified, in its order."""
    if not run.diagnosis:
        return NONE
    motors = [row.place for row in run.rows if row.quantity == DRIVE_GAIN]
    return "; ".join(named(effects, motors) for effects in run.found) if run.found else "nothing"


def named(effects: NamedEffects, motors: Sequence[str]) -> str:
    """An effect with its places, its alternatives, and its verdict unless that is "missing"."""
    places = f" at {', '.join(effects.places)}" if effects.places else ""
    if len(motors) > 1 and set(effects.places) == set(motors):
        places = " at all motors"
    verdict = "" if effects.verdict == "missing" else f" ({effects.verdict})"
    others = [spoken(name) for name in effects.alternatives]
    if len(others) > MOST_OTHERS:
        others = [f"one of {len(others)} others"]
    instead = f", or {', '.join(others)}" if others else ""
    return f"{spoken(effects.effect)}{places}{instead}{verdict}"


def value_rows(run: MachineRun) -> Iterator[Cells]:
    """A row for every gain and every other known value."""
    for against in run.rows:
        yield _cells(
            quantity_name(against),
            against.place,
            estimate(against),
            pretty_unit(against.unit),
            _known(against),
            percent(against.off, signed=True),
            answer(against.inside),
            NONE if against.goal is None else percent(against.goal),
            answer(against.reached),
        )


def _known(against: AgainstKnown) -> str:
    if against.known is None:
        return NONE
    return f"{against.known:g}" + (f" ± {percent(against.uncertainty)}" if against.uncertainty else "")


def quantity_name(known: AgainstKnown) -> str:
    """The display name of a compared quantity."""
    effect, _, parameter = known.quantity.partition(" ")
    return _called(effect, parameter)


def _called(quantity: str, parameter: str) -> str:
    return _WORDS.get(quantity, f"{spoken(quantity)} {parameter}")


def estimate(known: AgainstKnown) -> str:
    """The value with its standard error, or why there is none."""
    if known.value is None:
        return "not in the model"
    if known.fixed:
        return f"{known.value:g}, kept"
    if known.std is None:
        return f"{known.value:.5g}, not determined"
    return " ± ".join(value_and_std(known.value, known.std))


def answer(right: bool | None) -> MeasuredCell:
    """Yes, no, or a dash if that is not judged."""
    return MeasuredCell(NONE if right is None else YES if right else NO, right)


def sources(machine: MachineTable) -> list[str]:
    """The sources of the known values, each with its quantity and places."""
    return [
        f"{_called(known.of, known.parameter)} of {', '.join(known.values)}: {known.source}."
        for known in machine.known
    ]


def measured_markdown(records: Sequence[Record], machines: Mapping[str, MachineTable]) -> str:
    """The page of all machines in Markdown: a sentence each, known and estimated values, errors, then details."""
    known = [(record.name, *_weighted(cells)) for record in records for cells in known_rows(record)]
    runs = [
        (record.name, _unbroken(command.text), *_weighted(cells))
        for record in records
        for command, *cells in run_rows(record, machines[record.name])
    ]
    sentences = (
        f"- **{short_name(machines[record.name])}**: {machine_sentence(record, machines[record.name])}"
        for record in records
    )
    blocks = [
        "# On measured logs",
        "\n".join(sentences),
        f"## {KNOWN_TITLE}",
        EXPLANATION,
        rows_in_markdown(("machine", *KNOWN_HEADS), known),
        f"## {RUNS_TITLE}",
        ERRORS,
        rows_in_markdown(("machine", *RUN_HEADS), runs),
    ]
    for record in records:
        blocks += _machine_blocks(record, machines[record.name])
    return "\n\n".join(block for block in blocks if block) + "\n"


def _machine_blocks(record: Record, machine: MachineTable) -> Iterator[str]:
    yield f"## {machine.machine}"
    yield f"{machine.log}. Program: commit {record.program.get('commit', '')}."
    yield "\n".join(f"- {source}" for source in sources(machine))
    yield " ".join((machine.note, *absent_values(record))).strip()
    for run in record.runs:
        yield f"### bench {run.command}"
        if run.failed:
            yield f"Failed: {run.failed}"
            continue
        yield rows_in_markdown(VALUE_HEADS, map(_weighted, value_rows(run)))
        yield "\n".join(f"- {sentence}" for sentence in run.said)
        if run.omitted:
            yield rows_in_markdown(OMITTED_HEADS, map(_weighted, omitted_rows(run)))


def _unbroken(command: str) -> str:
    """A command as pieces of code, so that no line breaks between an option and its value."""
    first, *options = command.split(" --")
    return " ".join(f"`{part}`" for part in (first, *(f"--{option}" for option in options)))


def _weighted(row: Sequence[MeasuredCell]) -> list[str]:
    return [f"**{cell.text}**" if cell.wrong else cell.text for cell in row]
