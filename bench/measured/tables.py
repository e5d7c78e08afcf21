"""Records as rows of cells, the same for the page of text and the page for a browser."""

from collections.abc import Iterator, Sequence

from bench.document.numbers import percent, pretty_unit, value_and_deviation
from bench.effects.display_names import spoken
from bench.measured.known import DRIVE_GAIN, PARAMETER, WITHIN, AgainstKnown, MachineTable
from bench.measured.run import MachineRun, NamedEffects, Record

_WORDS = {DRIVE_GAIN: "drive gain", PARAMETER: "base parameter"}
MOST_OTHERS = 3  # alternatives that are named one by one
YES, NO, NONE = "yes", "NO", "–"
RUN_HEADS = (
    "command",
    "fitted",
    "not fitted",
    "goal",
    "inside",
    "goals reached",
    "processor",
    "missing, as it says",
)
VALUE_HEADS = ("quantity", "at", "value ± std", "unit", "known", "off by", "inside", "goal", "reached")
EXPLANATION = (
    "Each command starts from the robot's geometry and its nominal gains alone; what is known of the machines is "
    f"compared with afterwards. Inside: off by no more than {WITHIN:g} of the stated standard deviations and what the "
    "reference itself may be off by. Goal: how far an estimate, or an error, is to be off at most. Errors are of the "
    "current, the fitted ones and those of recordings that were not fitted; processor: seconds of it, start to end."
)


def run_rows(record: Record, table: MachineTable) -> Iterator[tuple[str, ...]]:
    """A row for every command: its errors, how many values are right, what it costs, what it names."""
    for run in record.runs:
        if run.failed:
            yield (f"bench {run.command}", *[NONE] * 5, f"{run.seconds:.3g} s", f"failed: {run.failed}")
            continue
        yield (
            f"bench {run.command}",
            percent(run.error_identify),
            percent(run.error_validate),
            error_goal(run, table),
            counted([one.inside for one in run.rows]),
            counted([one.reached for one in run.rows]),
            f"{run.seconds:.3g} s",
            said_missing(run),
        )


def error_goal(run: MachineRun, table: MachineTable) -> str:
    """The goal of the fitted error, and whether it is reached."""
    if table.error_goal is None or run.error_identify is None:
        return NONE
    reached = run.error_identify <= table.error_goal
    return f"{percent(table.error_goal)} {YES if reached else NO}"


def counted(answers: Sequence[bool | None]) -> str:
    """How many of those that have an answer are right."""
    known = [one for one in answers if one is not None]
    return f"{sum(known)} of {len(known)}" if known else NONE


def said_missing(run: MachineRun) -> str:
    """The effects that a diagnosis found, strongest first."""
    if not run.diagnosis:
        return NONE
    return "; ".join(map(named, run.found)) if run.found else "nothing"


def named(one: NamedEffects) -> str:
    """An effect with its places, its verdict unless it is plainly missing, and what it could be instead."""
    places = f" at {', '.join(one.places)}" if one.places else ""
    verdict = "" if one.verdict == "missing" else f" ({one.verdict})"
    others = [spoken(name) for name in one.alternatives]
    if len(others) > MOST_OTHERS:
        others = [f"one of {len(others)} others"]
    instead = f", or {', '.join(others)}" if others else ""
    return f"{spoken(one.effect)}{places}{instead}{verdict}"


def value_rows(run: MachineRun) -> Iterator[tuple[str, ...]]:
    """A row for every gain and everything that is known."""
    for one in run.rows:
        known = NONE if one.known is None else f"{one.known:g}"
        if one.known is not None and one.uncertainty:
            known += f" ± {percent(one.uncertainty)}"
        yield (
            quantity_name(one),
            one.place,
            estimate(one),
            pretty_unit(one.unit),
            known,
            percent(one.off, signed=True),
            answer(one.inside),
            NONE if one.goal is None else percent(one.goal),
            answer(one.reached),
        )


def quantity_name(one: AgainstKnown) -> str:
    """What is compared, in words."""
    effect, _, parameter = one.quantity.partition(" ")
    return _WORDS.get(one.quantity, f"{spoken(effect)} {parameter}")


def estimate(one: AgainstKnown) -> str:
    """The value with its deviation, or why there is none."""
    if one.value is None:
        return "not in the model"
    if one.fixed:
        return f"{one.value:g}, kept"
    if one.std is None:
        return f"{one.value:.5g}, not determined"
    return " ± ".join(value_and_deviation(one.value, one.std))


def answer(right: bool | None) -> str:
    """Yes, no, or nothing to say."""
    return NONE if right is None else YES if right else NO


def sources(machine: MachineTable) -> list[str]:
    """Where the known values are from, each with what it is about."""
    said = []
    for known in machine.known:
        about = _WORDS.get(known.of, f"{spoken(known.of)} {known.parameter}")
        said.append(f"{about} of {', '.join(known.values)}: {known.source}.")
    return said
