"""From a step of the page to its command, in the words of a shell."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field, TypeAdapter, ValidationError

from bench.basics.errors import BenchError
from bench.basics.files.sidecar_path import sidecar_path
from bench.basics.files.toml_input import UserTable, first_mistake
from bench.basics.program import typed
from bench.basics.shell_word import each, option_words, quoted
from bench.dataset.names import DATASET_FILE, Check, Unit, Use
from bench.local.folder import RESULTS, Folder

Name = Annotated[str, Field(min_length=1, max_length=400)]
Positive = Annotated[float, Field(gt=0.0, allow_inf_nan=False)]
Finite = Annotated[float, Field(allow_inf_nan=False)]
Form = Literal["mjcf", "urdf", "csv", "yaml", "c"]
SUFFIXES: Mapping[Form, str] = {"mjcf": ".xml", "urdf": ".urdf", "csv": ".csv", "yaml": ".yaml", "c": ".c"}
"""Suffix of an exported model's file."""
_EFFECT = re.compile(r"[a-z][a-z0-9_]*(:[\w .-]+)?(@[\w .-]+)?")


class ImportLog(UserTable):
    """Import a log as a recording. scale: unit or factor by column; rate: Hz, of a log without time.

    fresh: whether the dataset is new. replace: whether to replace the recording with the log's name.
    """

    step: Literal["import"]
    log: Name
    robot: Name
    dataset: Name
    fresh: bool = False
    columns: dict[str, str]
    scale: dict[str, str | Positive] = Field(default_factory=dict)
    rate: Positive | None = None
    use: Use = "identify"
    payload: str = ""
    payload_mass: Positive | None = None
    payload_center: tuple[Finite, Finite, Finite] | None = None
    payload_inertia: tuple[Finite, Finite, Finite, Finite, Finite, Finite] | None = None
    topic: str | None = None
    split_gaps: bool = False
    accept: tuple[Check, ...] = ()
    skip_rows: Annotated[int, Field(ge=0)] = 0
    replace: bool = False


class NewRobot(UserTable):
    """Write a robot.toml for an MJCF file. motors: names and nominal gains; name: of the robot."""

    step: Literal["new robot"]
    model: Name
    name: Name
    motors: tuple[tuple[Name, Positive], ...] = Field(min_length=1)
    unit: Unit = "A"
    tool: str = ""


class CheckRobot(UserTable):
    """Check a robot folder."""

    step: Literal["robot"]
    robot: Name


class Compare(UserTable):
    """Where models fail: one fitted now, or one or more saved models."""

    step: Literal["compare"]
    dataset: Name
    models: tuple[Name, ...] = ()


class Diagnose(UserTable):
    """Find what the model lacks. effects: those already in it."""

    step: Literal["diagnose"]
    dataset: Name
    effects: tuple[Name, ...] = ()


class Export(UserTable):
    """Export a model for other programs. form: as in `bench export --to`."""

    step: Literal["export"]
    dataset: Name
    model: Name
    form: Form


class Identify(UserTable):
    """Identify the model with these effects."""

    step: Literal["identify"]
    dataset: Name
    effects: tuple[Name, ...] = ()


Asked = Annotated[
    ImportLog | NewRobot | CheckRobot | Compare | Diagnose | Identify | Export, Field(discriminator="step")
]
_ASKED: TypeAdapter[Any] = TypeAdapter(Asked)


@dataclass(frozen=True)
class Command:
    """words: after `bench`; files: name -> path relative to the folder, of files that it writes and the page reads.

    there: the existing recording with the name of the import, "" if there is none.
    """

    step: str
    subject: str
    words: list[str]
    files: Mapping[str, str] = field(default_factory=dict)
    there: str = ""

    @property
    def line(self) -> str:
        """The command as typed."""
        return " ".join([typed(), *(quoted(word) for word in self.words)])


def command_of(folder: Folder, asked: Mapping[str, Any]) -> Command:
    """The command of a step. Raises BenchError naming what makes it impossible.

    Creates the folder of the dataset's results, so that the command also works in a shell.
    """
    try:
        step = _ASKED.validate_python(asked)
    except ValidationError as error:
        raise BenchError(first_mistake(error)) from error
    if isinstance(step, ImportLog):
        return _import(folder, step)
    if isinstance(step, NewRobot | CheckRobot):
        return _robot(folder, step)
    path = folder.root if step.dataset == "." else folder.inside(step.dataset)
    if not (path / DATASET_FILE).is_file():
        raise BenchError(f"{step.dataset}: no dataset: it holds no {DATASET_FILE}")
    results = _results(folder, path)
    if isinstance(step, Compare):
        return _compare(folder, path, results, step)
    if isinstance(step, Export):
        return _export(folder, results, step)
    effects = each("--with", map(_effect, step.effects))
    if isinstance(step, Identify):
        number = _next(results, "model")
        model = results / f"model-{number}.json"
        words = ["identify", folder.word(path), *effects, "--json", folder.word(model)]
        return Command(step.step, step.dataset, words, _files(folder, model=model))
    run = results / f"{_next(results, '')}-diagnosis"
    answer, model = run.with_name(f"{run.name}.json"), run.with_name(f"{run.name}-model.json")
    words = ["diagnose", folder.word(path), *effects, "--json", folder.word(answer)]
    words += ["--apply", folder.word(model), "-o", folder.word(run)]
    files = _files(folder, answer=answer, model=model, run=run, report=run / "report.html")
    return Command(step.step, step.dataset, words, files)


def _compare(folder: Folder, path: Path, results: Path, step: Compare) -> Command:
    models = _models(folder, step.models)
    words = ["compare", folder.word(path)]
    words += each("--model", map(folder.word, models))
    if len(models) > 1:
        answer = results / f"{_next(results, '')}-side-by-side.json"
        words += ["--json", folder.word(answer)]
        return Command(step.step, step.dataset, words, _files(folder, answer=answer))
    run = results / f"{_next(results, '')}-compare"
    answer = run.with_name(f"{run.name}.json")
    words += ["--json", folder.word(answer), "-o", folder.word(run)]
    model = models[0] if models else run / "model.json"
    files = _files(folder, answer=answer, model=model, run=run, report=run / "report.html")
    return Command(step.step, step.dataset, words, files)


def _export(folder: Folder, results: Path, step: Export) -> Command:
    (model,) = _models(folder, [step.model])
    named = model if model.parent == results else model.parent  # inside a result folder: under its name
    target = results / f"{named.name.removesuffix('.json')}{SUFFIXES[step.form]}"
    words = ["export", folder.word(model), "--to", step.form, "-o", folder.word(target)]
    sidecar = {"twin": sidecar_path(target)} if step.form == "mjcf" else {}
    return Command(step.step, step.dataset, words, _files(folder, exported=target, **sidecar))


def _models(folder: Folder, names: Sequence[str]) -> list[Path]:
    models = [folder.inside(name) for name in names]
    for model in models:
        if not model.is_file():
            raise BenchError(f"{model.name}: no such model file")
    return models


def _import(folder: Folder, step: ImportLog) -> Command:
    log, robot = folder.inside(step.log), folder.robot(step.robot)
    target = folder.root if step.dataset == "." else folder.inside(step.dataset)
    for part in step.dataset.split("/"):
        if part != ".":
            folder.name(part)
    if step.fresh and target.exists():
        raise BenchError(f"{step.dataset}: is there already: give the new dataset a name that is free")
    words = ["import", folder.word(log), "--robot", robot]
    for column, source in step.columns.items():
        words += ["--map", f"{_plain(column)}={_plain(source)}"]
    for column, unit in step.scale.items():
        words += ["--scale", f"{_plain(column)}={unit if isinstance(unit, str) else repr(unit)}"]
    words += option_words({"rate": step.rate, "use": None if step.use == "identify" else step.use})
    words += _payload(folder, step)
    if step.topic:
        words.append(f"--topic={_plain(step.topic)}")
    words += option_words({"skip_rows": step.skip_rows or None, "split_gaps": step.split_gaps})
    words += each("--accept", step.accept)
    name = f"{folder.cleaned(log.stem)}.csv"
    words += [*option_words({"replace": step.replace, "name": name}), "-o", folder.word(target)]
    there = name if (target / name).is_file() else ""
    return Command("import", step.log, words, {"dataset": step.dataset}, there)


def _robot(folder: Folder, step: NewRobot | CheckRobot) -> Command:
    """A robot is written next to its MJCF; or, if that is in the opened folder itself, to a folder of its name."""
    if isinstance(step, CheckRobot):
        return Command(step.step, step.robot, ["robot", "check", folder.robot(step.robot)])
    model, name = folder.inside(step.model), folder.name(step.name)
    target = model.parent if model.parent != folder.root else folder.inside(name)
    words = ["robot", "new", folder.word(model)]
    words += [f"--motor={_plain(motor)}={gain!r}" for motor, gain in step.motors]
    words += option_words({"unit": None if step.unit == "A" else step.unit})
    if step.tool:
        words.append(f"--tool={_plain(step.tool)}")
    words += [f"--name={name}", "-o", folder.word(target)]
    return Command(step.step, step.model, words, _files(folder, robot=target))


def _payload(folder: Folder, step: ImportLog) -> list[str]:
    """Options that describe the payload."""
    if not step.payload:
        return []
    words = option_words({"payload": folder.name(step.payload), "payload_mass": step.payload_mass})
    for name, numbers in (("center", step.payload_center), ("inertia", step.payload_inertia)):
        if numbers is not None:
            words.append(f"--payload-{name}={','.join(map(repr, numbers))}")
    return words


def _results(folder: Folder, dataset: Path) -> Path:
    """The folder of a dataset's results: next to the dataset, or inside it if the dataset was opened."""
    inner = dataset == folder.root
    results = dataset / RESULTS[1:] if inner else dataset.with_name(f"{dataset.name}{RESULTS}")
    if results.is_symlink():
        raise BenchError(f"{results.name}: is a symbolic link: nothing is written through it")
    try:
        results.mkdir(exist_ok=True)
    except OSError as error:
        raise BenchError(f"{results.name}: cannot be made: {error.strerror}") from error
    return results


def _next(results: Path, kind: str) -> int:
    """The next free number for a result of this kind."""
    pattern = re.compile(rf"{kind}-(\d+)\b.*" if kind else r"(\d+)-.*")
    taken = [int(match.group(1)) for path in results.iterdir() if (match := pattern.fullmatch(path.name))]
    return max(taken, default=0) + 1


def _files(folder: Folder, **paths: Path) -> dict[str, str]:
    return {name: path.relative_to(folder.root).as_posix() for name, path in paths.items()}


def _effect(name: str) -> str:
    if not _EFFECT.fullmatch(name):
        raise BenchError(f"{name!r}: not an effect")
    return name


def _plain(text: str) -> str:
    """A text that may be the value of an option. Raises BenchError if it is empty, or has a NUL or a newline."""
    if not text or "\0" in text or "\n" in text:
        raise BenchError(f"{text!r}: not a column")
    return text
