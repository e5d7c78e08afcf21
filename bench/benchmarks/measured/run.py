"""Results of the commands `identify` and `diagnose` on a machine's logs, as records in files."""

import json
import resource
import subprocess
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from pydantic import TypeAdapter, ValidationError

from bench.basics.errors import BenchError
from bench.basics.files.atomic import write_text_atomically
from bench.basics.files.toml_input import first_mistake
from bench.basics.versions import versions
from bench.benchmarks.measured.known import AgainstKnown, MachineTable, compared

SUFFIX = ".json"


@dataclass(frozen=True)
class FoundParameter:
    """A parameter of an effect in the final model of a diagnosis; value, std: None if not finite."""

    place: str
    name: str
    value: float | None
    std: float | None
    unit: str


@dataclass(frozen=True)
class NamedEffects:
    """An effect that a diagnosis identified: its verdict, places, and alternatives.

    size: RMS of its torque or force by motor, N·m or N; parameters: as estimated, SI.
    """

    effect: str
    verdict: str
    places: tuple[str, ...]
    alternatives: tuple[str, ...]
    size: Mapping[str, float] = field(default_factory=dict)
    parameters: tuple[FoundParameter, ...] = ()


@dataclass(frozen=True)
class LogOmitted:
    """A fitted log, and the effects that a diagnosis does not support without it."""

    log: str
    gone: tuple[str, ...]


@dataclass(frozen=True)
class MachineStep:
    """A step of the ladder: the effects of the model, and its errors."""

    effects: tuple[str, ...]
    identify: float | None
    validate: float | None


@dataclass(frozen=True)
class MachineRun:
    """The result of one command. seconds: processor time from start to end; failed: why there is no result, or "".

    judged: on what error_validate was computed; said: sentences of a diagnosis, or notes of an identification; found,
    ladder, noise_floor, omitted: of a diagnosis. The names of the fields are keys of results/measured/*.json.
    """

    command: str
    seconds: float
    effects: tuple[str, ...] = ()
    error_identify: float | None = None
    error_validate: float | None = None
    judged: str = "recordings that were not fitted"
    rows: tuple[AgainstKnown, ...] = ()
    said: tuple[str, ...] = ()
    found: tuple[NamedEffects, ...] = ()
    ladder: tuple[MachineStep, ...] = ()
    noise_floor: float | None = None
    failed: str = ""
    omitted: tuple[LogOmitted, ...] = ()

    @property
    def diagnosis(self) -> bool:
        """Whether the command is a diagnosis."""
        return self.command.startswith("diagnose")


@dataclass(frozen=True)
class Record:
    """All runs on the logs of one machine, and the program's versions."""

    name: str
    runs: tuple[MachineRun, ...]
    program: dict[str, str]


def measured(name: str, dataset: Path, table: MachineTable, report: Callable[[str], None]) -> Record:
    """Identify and diagnose the dataset in a folder. report: called with every command before it runs."""
    runs = []
    commands = [("identify", table.effects), *(("diagnose", start) for start in table.diagnose_with)]
    for command, effects in commands:
        given = [word for effect in effects for word in ("--with", effect)]
        line = " ".join((command, name, *given))
        report(f"bench {line}")
        runs.append(_run(command, dataset, given, line, table))
    return Record(name, tuple(runs), versions().columns())


def _run(command: str, dataset: Path, given: Sequence[str], line: str, table: MachineTable) -> MachineRun:
    with TemporaryDirectory() as folder:
        answer = Path(folder) / "answer.json"
        words = [sys.executable, "-m", "bench", command, str(dataset), *given, "--json", str(answer)]
        before = _processor_seconds()
        done = subprocess.run(words, capture_output=True, text=True, check=False)
        seconds = float(f"{_processor_seconds() - before:.3g}")
        if done.returncode != 0:
            said = [text for text in done.stderr.splitlines() if text.strip()]
            return MachineRun(line, seconds, failed=said[-1] if said else f"exit code {done.returncode}")
        content = json.loads(answer.read_text(encoding="utf-8"))
    if command == "identify":
        return _identified(line, seconds, content, table)
    return _diagnosed(line, seconds, content, table)


def _processor_seconds() -> float:
    """Processor time of all child processes that have ended, s."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def _identified(line: str, seconds: float, model: dict[str, Any], table: MachineTable) -> MachineRun:
    error = model["error"]
    return MachineRun(
        line,
        seconds,
        tuple(model["effects"]),
        error["identify"],
        error["validate"],
        rows=compared(model, table.known),
        said=tuple(model["notes"]),
    )


def _diagnosed(line: str, seconds: float, answer: dict[str, Any], table: MachineTable) -> MachineRun:
    ranking = {entry["effect"]: entry for entry in answer["ranking"]}
    ladder = tuple(
        MachineStep(tuple(entry["effects"]), entry["error"]["identify"], entry["error"]["validate"])
        for entry in answer["ladder"]
    )
    return MachineRun(
        line,
        seconds,
        tuple(answer["after"]["effects"]),
        ladder[-1].identify,
        ladder[-1].validate,
        judged=answer["judged_on"],
        rows=compared(answer["after"], table.known),
        said=tuple(answer["summary"]),
        found=tuple(
            NamedEffects(
                name,
                ranking[name]["verdict"],
                tuple(ranking[name]["actuators"]),
                tuple(ranking[name]["alternatives"]),
                ranking[name]["size"],
                tuple(
                    FoundParameter(place, parameter, quantity["value"], quantity["std"], quantity["unit"])
                    for place, values in answer["after"]["effect_parameters"].get(name, {}).items()
                    for parameter, quantity in values.items()
                ),
            )
            for name in answer["missing"]
        ),
        ladder=ladder,
        noise_floor=answer["unexplained"]["noise_floor"],
        omitted=tuple(LogOmitted(row["log"], tuple(row["gone"])) for row in answer["without_logs"]),
    )


_RECORD = TypeAdapter(Record)


def keep(record: Record, folder: Path) -> Path:
    """Write a record into a folder; return its path."""
    path = folder / f"{record.name}{SUFFIX}"
    write_text_atomically(path, _RECORD.dump_json(record, indent=2).decode() + "\n")
    return path


def kept(folder: Path) -> list[Record]:
    """The records in a folder, in order of their names. Raises BenchError for a damaged one."""
    records = []
    for path in sorted(folder.glob(f"*{SUFFIX}")):
        try:
            records.append(_RECORD.validate_json(path.read_bytes()))
        except ValidationError as error:
            raise BenchError(f"{path}: {first_mistake(error)}") from error
    return records
