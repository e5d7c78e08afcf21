"""The suggested next command after one on a source: a dataset, a model, a result, a sweep or a trial."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from bench.basics.errors import BenchError
from bench.basics.shell_word import each, quoted
from bench.cli.last_lines import after_diagnosis, next_line
from bench.cli.options import Asked

if TYPE_CHECKING:
    from bench.dataset.dataset import Dataset
    from bench.diagnosis.result import Diagnosis
    from bench.identification.result import Identification
    from bench.residuals.motor import Compared


@dataclass(frozen=True)
class Source:
    """The arguments of a command: a path and its options."""

    path: Path
    asked: Asked
    data: Path | None = None
    """The recordings that are shown with a model file."""

    def command(self, name: str, data: Path) -> str:
        """A command line on a dataset with all effects, files and filters."""
        return self.asked.run(name, data).line()

    @property
    def dataset(self) -> Path | None:
        """The dataset of the source: itself if it is a dataset, the recordings of a model file, else None."""
        from bench.dataset.names import DATASET_FILE

        if self.path.name == DATASET_FILE or (self.path / DATASET_FILE).is_file():
            return self.path
        return (self.data or dataset_behind(self.path)) if self.path.is_file() else None

    def applied(self) -> tuple[Dataset, Identification]:
        """A model file applied to its dataset, or to the one given. Raises BenchError if there is none."""
        from bench.dataset.dataset import load_dataset
        from bench.identification.model_file import read_identification

        if (folder := self.dataset) is None:
            raise BenchError(
                f"{self.path}: a model file without the path of its recordings: name them with --data"
            )
        dataset = load_dataset(folder)
        return dataset, read_identification(self.path, self.asked.of(dataset))


def dataset_behind(model: Path) -> Path | None:
    """The recordings from which a model file was identified; None if it does not name them."""
    from bench.identification.model_file import load_model

    return load_model(model).dataset


def after_errors(source: Source, what: Compared, *, kept: bool) -> str | None:
    """After a model's errors: a diagnosis if more than noise remains, else saving the model; None if it is saved."""
    from bench.residuals.words import DIAGNOSE, KEEP, beyond_noise

    if beyond_noise(what):
        return f"next: {source.command('diagnose', source.path)}    {DIAGNOSE}"
    return None if kept else f"next: {source.command('identify', source.path)} --json model.json    {KEEP}"


def after_looking(source: Source) -> str:
    """After the viewer: a comparison for recordings or a model, the table of a sweep, the figures of a result."""
    from bench.studies.sweep.rerun_runs import is_sweep_folder

    data = source.dataset
    if data == source.path:
        return f"next: {source.command('compare', data)}    shows where the model fails"
    if data is not None:
        return _compared(source, data)
    if is_sweep_folder(source.path):
        return next_line(["table", source.path], "summarises all runs by axis")
    return next_line(["figures", source.path], "lists figures for papers")


def before_figures(source: Source, name: str) -> str:
    """After the list of figures: the command that draws one of them."""
    words = source.command("figures", source.path)
    if source.data is not None:
        words += f" --data {quoted(source.data)}"
    folder = quoted(source.path.with_name(f"{source.path.resolve().with_suffix('').name}.figures"))
    return f"next: {words} {name} -o {folder}    draws it; --all draws every one"


def after_figures(source: Source) -> str:
    """After figures: a diagnosis for recordings, the errors of a model, the robot in motion for a result."""
    data = source.dataset
    if data == source.path:
        return f"next: {source.command('diagnose', data)}    names the physical effect that the model lacks"
    if data is not None:
        return _compared(source, data)
    return next_line(["view", source.path], "shows the robot in motion")


def after_page(source: Source, diagnosis: Diagnosis | None) -> str:
    """After a page: the step after a diagnosis, the table of a sweep, the export of a model, a result's figures."""
    from bench.studies.sweep.rerun_runs import is_sweep_folder

    data = source.dataset
    if diagnosis is not None and data == source.path:
        again = source.command("diagnose", data)
        return after_diagnosis(diagnosis, data, again, None, source.asked.files)
    if is_sweep_folder(source.path):
        return next_line(["table", source.path], "summarises it by axis")
    if data is not None:
        target = source.path.with_suffix(".xml")
        files = each("--effect-file", source.asked.files)
        words = ["export", source.path, "--to", "mjcf", "-o", target, *files]
        return next_line(words, "exports the model to a simulator")
    return next_line(["figures", source.path], "lists figures for papers")


def after_table(folder: Path, axes: Sequence[str], metrics: Sequence[str], pooled: Sequence[str]) -> str:
    """After a summary: the same by its pooled axes, the viewer if it has no axes, or a plot of its first metric."""
    if not axes and pooled:
        by = [*each("--by", pooled), *each("--show", metrics)]
        return next_line(["table", folder, *by], "separates their values")
    if not axes:
        return next_line(["view", folder], "shows a good, a median and a bad run in motion")
    lines = ["--lines", axes[1]] if len(axes) > 1 else []
    return next_line(["plot", folder, "--x", axes[0], "--y", metrics[0], *lines], "draws it")


def after_trial(table: Path) -> str:
    """After a trial or its page: the same trial with twice the seeds, which adds datasets."""
    from bench.page.trial_page import again_line, read_trial

    return f"next: {again_line(read_trial(table), 2)}    adds as many datasets again"


def after_export(model: Path, form: str, output: Path, effect_files: Sequence[Path]) -> list[str]:
    """After an export: a replay of the bodies along the recordings, or the compilation of a feed-forward.

    Empty for a model whose recordings are unknown or no longer exist.
    """
    if form == "c":
        return [f"next: cc -O2 -c {quoted(output)}    compiles it for linking with a controller"]
    data = dataset_behind(model)
    if data is None or not data.is_dir():
        return []
    words = ["replay", data, "--model", model, *each("--effect-file", effect_files)]
    return [next_line(words, "simulates these bodies along the recorded motions")]


def after_replay(dataset: Path, model: Path, film: Path | None, options: Sequence[str | Path]) -> str:
    """After a replay: the same with a recording for the viewer, or that recording. options: of the call."""
    if film is not None:
        return f"next: rerun {quoted(film)}    shows the twin in motion with the measured robot"
    target = model.with_suffix(".rrd")
    words = ["replay", dataset, "--model", model, *options, "--rrd", target]
    return next_line(words, "writes a recording for the viewer")


def _compared(source: Source, data: Path) -> str:
    words = ["compare", data, "--model", source.path, *each("--effect-file", source.asked.files)]
    return next_line(words, "shows where the model fails")
