"""What the page shows of files; the worker reads them and writes nothing."""

from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

from bench.basics.errors import BenchError
from bench.basics.files.toml_input import read_toml
from bench.basics.plain_data import finite
from bench.basics.program import typed
from bench.basics.progress import Progress
from bench.dataset.dataset import Dataset, heavy_payload, load_dataset
from bench.dataset.dataset_toml import DatasetSpec
from bench.dataset.names import DATASET_FILE, RUN_FILE
from bench.dataset.payload import Payload
from bench.dataset.robot import load_robot
from bench.dataset.robot_toml import mjcf_parts
from bench.effects.display_names import begun, spoken
from bench.effects.effect import Seen
from bench.identification.model_file import apply_model, load_model
from bench.identification.model_json import to_json
from bench.identification.problem import places_of, problem_of
from bench.local.checks import Mapped, checked, forget
from bench.local.columns import look_at
from bench.page.folder import read_json
from bench.page.section_errors import currents_section, shown_model
from bench.page.section_run import CommandRun

GROUPS: Mapping[Seen | None, str] = {
    "opposes": "Error jumps at a reversal",
    "load": "Error grows with the load",
    "fades": "Error changes with time",
    "velocity": "Error follows the velocity",
    "repeats": "Error repeats over the position",
    "position": "Error follows the position",
    "current": "Error follows the current",
    "acceleration": "Error follows the acceleration",
    None: "Effects of your own",
}
"""Names for groups of effects, by the first of `Effect.seen`; effects without one are not of the catalogue."""
MAPPED = ("columns", "scale", "rate", "split_gaps", "accept", "topic", "skip_rows")


def columns(arguments: Mapping[str, Any], _progress: Progress) -> dict[str, Any]:
    """The columns of a log, and guesses of their meaning; see `look_at`."""
    robot = load_robot(arguments["robot"])
    return look_at(arguments["log"], robot, arguments["topic"], arguments["skip_rows"])


def checks(arguments: Mapping[str, Any], _progress: Progress) -> dict[str, Any]:
    """The problems that an import would report for each column; see `checked`."""
    given = {key: arguments[key] for key in MAPPED}
    return checked(arguments["log"], load_robot(arguments["robot"]), Mapped(**given))


def payload(arguments: Mapping[str, Any], _progress: Progress) -> dict[str, Any]:
    """A suspiciously heavy payload: its mass, the robot's, and its mass if given in grams; otherwise empty."""
    heavy = heavy_payload(Payload("load", arguments["mass"]), load_robot(arguments["robot"]))
    return {} if heavy is None else {"mass": heavy.mass, "own": heavy.robot_mass, "if_grams": heavy.if_grams}


def parts(arguments: Mapping[str, Any], _progress: Progress) -> dict[str, Any]:
    """The parts of an MJCF file that motors may drive, and its sites."""
    mjcf = mjcf_parts(arguments["model"])
    return {"motors": [asdict(part) for part in mjcf.named.values()], "sites": list(mjcf.sites)}


def dataset(arguments: Mapping[str, Any], _progress: Progress) -> dict[str, Any]:
    """Recordings and payloads of a dataset, and the effects that its robot may have, with their places."""
    forget()  # the checked log is imported by now, or is read again
    data = load_dataset(arguments["dataset"])
    spec = read_toml(data.folder / DATASET_FILE, DatasetSpec)
    accepted = {recording.file: list(recording.accept) for recording in spec.recordings}
    asked = {heavy.name: heavy.words for heavy in data.doubted}
    return {
        "robot": data.robot.name,
        "joints": list(data.robot.joints),
        "payloads": {name: payload.mass for name, payload in data.payloads.items()},
        "recordings": [
            {
                "name": recording.name,
                "use": recording.use,
                "payload": recording.payload,
                "rate": recording.rate,
                "seconds": float(recording.time[-1] - recording.time[0]),
                "accepted": accepted.get(recording.log, []),
                "asked": asked.get(recording.payload or "", ""),
            }
            for recording in data.recordings
        ],
        "effects": _effects(data),
        "groups": list(GROUPS.values()),
    }


def curves(arguments: Mapping[str, Any], _progress: Progress) -> dict[str, Any]:
    """The report's figure of measured and modelled currents, with the errors of the given models."""
    data = load_dataset(arguments["dataset"])
    problem, models = problem_of(data), []
    for path, name, role in arguments["models"]:
        saved = load_model(path)
        result = apply_model(problem, saved)
        models.append(shown_model(name, role, problem, result, saved.settings))
    return dict(finite(asdict(currents_section(models).parts[0])))


def runs(arguments: Mapping[str, Any], _progress: Progress) -> list[dict[str, Any]]:
    """A summary of each result folder or model file; for one that cannot be read, the reason."""
    answers: list[dict[str, Any]] = []
    for path in arguments["paths"]:
        try:
            answers.append({"path": path, **_facts(Path(arguments["root"]), path)})
        except BenchError as error:
            answers.append({"path": path, "fault": str(error)})
    return answers


def machine(arguments: Mapping[str, Any], _progress: Progress) -> dict[str, Any]:
    """The mechanism in a recording, with the error of a model; see `mechanism`."""
    from bench.page.mechanism import mechanism  # noqa: PLC0415 - the viewer's shapes take their time to import

    data = load_dataset(arguments["dataset"])
    saved = load_model(arguments["model"])
    applied = apply_model(problem_of(data), saved)
    name = arguments["recording"]
    series = next((trace for trace in applied.recordings if trace.name == name), None)
    recording = next((logged for logged in data.recordings if logged.name == name), None)
    if recording is None or series is None:
        raise BenchError(f"{name}: no such recording")
    return mechanism(data, recording, series, saved.settings)


def _effects(data: Dataset) -> list[dict[str, Any]]:
    problem = problem_of(data)
    places = places_of(problem)
    return [
        {
            "name": name,
            "words": begun(name),
            "spoken": spoken(name),
            "group": GROUPS[next(iter(effect.seen), None)],
            "places": [name for name in at if name],
        }
        for name, effect in problem.catalogue.items()
        if (at := places.where(effect))
    ]


def _facts(root: Path, place: str) -> dict[str, Any]:
    path, line, applied = root / place, "", False
    model = path
    if path.is_dir():
        content = read_json(path / RUN_FILE)
        line, applied = _line(path, content.get("run")), bool(content.get("model"))
        names = [name for name in ("model.json", "model_after.json") if (path / name).is_file()]
        if not names:
            raise BenchError(f"{place}: holds no model")
        model = path / names[0]
    answer = to_json(load_model(model).model)
    facts = {key: answer[key] for key in ("robot", "effects", "error", "drive_gains", "notes")}
    about = {"model": model.relative_to(root).as_posix(), "line": line, "applied": applied}
    return dict(finite({**about, **facts}))


def _line(path: Path, run: Any) -> str:
    """The command of a result. Raises BenchError if it is not known."""
    try:
        known = {**run, "effects": tuple(run["effects"]), "effect_files": tuple(run["effect_files"])}
        return CommandRun(**known).line(typed())
    except (TypeError, KeyError) as error:
        raise BenchError(f"{path / RUN_FILE}: does not name its command") from error
