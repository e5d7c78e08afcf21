"""Convert a source that a user names (a dataset, a model, a folder of results or of a sweep) for the viewer."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import click

from bench.basics.errors import BenchError
from bench.cli.known_truth import known_next_to, known_to
from bench.cli.next_steps import Source
from bench.dataset.dataset import Dataset, load_dataset, refuse_log
from bench.dataset.names import DATASET_FILE, RUN_FILE
from bench.diagnosis.result import Diagnosis, LadderStep
from bench.document.diagnosis import step_labels
from bench.document.markdown.tables import diagnosis_markdown
from bench.identification.chosen_band import prepare_checked
from bench.identification.effect_torques import effect_torques
from bench.identification.identify import fit, identify
from bench.identification.prepare import prepare
from bench.identification.problem import problem_of
from bench.identification.result import Identification
from bench.page.folder import SavedRun, read_run
from bench.studies.sweep.rerun_runs import is_sweep_folder, plan_of, run_again, telling_runs
from bench.truth.dataset import as_dataset
from bench.viewer.context import LadderModel, ViewContext
from bench.viewer.recording import ViewedRun


def viewed_runs(given: Source, runs: Sequence[int] = (), *, with_truth: bool = True) -> list[ViewedRun]:
    """One identification, or several of a sweep, with all available context.

    runs: numbers of runs of a sweep; with_truth: whether to show a simulation's truth. Raises BenchError naming what is
    missing.
    """
    source = given.path
    if source.is_file():
        refuse_log(source)
        return [_of_model(given, with_truth)]
    if not source.is_dir():
        raise BenchError(f"{source}: no such folder or model file")
    if (source / DATASET_FILE).is_file():
        return [_of_dataset(given, with_truth)]
    if is_sweep_folder(source):
        return _of_sweep(source, runs, with_truth)
    if not (source / RUN_FILE).is_file():
        raise BenchError(
            f"{source}: neither a dataset ({DATASET_FILE}), nor a result ({RUN_FILE}), nor a sweep (sweep.toml)"
        )
    return [_of_result(_read(source), with_truth)]


def answer_of(given: Source) -> tuple[Dataset, Identification, Diagnosis | None]:
    """The dataset, the model and, from a saved diagnosis, the diagnosis; without the truth of a simulation.

    Raises BenchError that names what is missing.
    """
    source = given.path
    if source.is_dir() and (source / RUN_FILE).is_file():
        saved = _read(source)
        return saved.with_held_out, saved.after, saved.diagnosis
    if source.is_dir() and is_sweep_folder(source):
        raise BenchError(f"{source}: a sweep; `bench plot` draws its figures")
    if source.is_file():
        refuse_log(source)
        return (*given.applied(), None)
    if not (source / DATASET_FILE).is_file():
        raise BenchError(f"{source}: neither a dataset ({DATASET_FILE}) nor a result ({RUN_FILE})")
    problem = given.asked.of(load_dataset(source))
    return problem.dataset, identify(prepare_checked(problem)), None


def _read(folder: Path) -> SavedRun:
    """A result folder; prints on standard error what had to be computed again."""
    saved = read_run(folder)
    if saved.said:
        click.echo(saved.said, err=True)
    return saved


def _of_dataset(given: Source, with_truth: bool) -> ViewedRun:
    problem, effects = given.asked.of(load_dataset(given.path)), given.asked.effects
    dataset = problem.dataset
    rungs = [effects[:count] for count in range(len(effects) + 1)]
    prepared = prepare_checked(problem)
    with_same = replace(problem, filters=prepared.settings)
    models = [fit(prepare(replace(with_same, effects=rung))) for rung in rungs[:-1]] + [identify(prepared)]
    *words, last = step_labels(rungs)
    steps = [LadderModel(word, model.recordings) for word, model in zip(words, models[:-1], strict=True)]
    context = _context(dataset, models[-1], tuple(steps), truth=with_truth)
    return ViewedRun(models[-1].robot, models[-1], dataset, replace(context, label=last))


def _of_model(given: Source, with_truth: bool) -> ViewedRun:
    dataset, result = given.applied()
    return ViewedRun(result.robot, result, dataset, _context(dataset, result, truth=with_truth))


def _of_result(saved: SavedRun, with_truth: bool) -> ViewedRun:
    """The identified model, and the errors of the earlier models of the ladder."""
    dataset, after, diagnosis = saved.dataset, saved.after, saved.diagnosis
    if diagnosis is None:
        return ViewedRun(after.robot, after, dataset, _context(dataset, after, truth=with_truth))
    with_held_out = saved.with_held_out
    problem = replace(saved.problem, dataset=with_held_out, filters=after.settings)
    problem = replace(problem, fit_gains=after.gains_fitted)
    rungs = [_requests(diagnosis, rung) for rung in diagnosis.ladder]
    words = step_labels(rungs)
    steps = []
    for word, rung, step in zip(words[:-1], rungs[:-1], diagnosis.ladder[:-1], strict=True):
        recordings = step.recordings or fit(prepare(replace(problem, effects=rung))).recordings
        steps.append(LadderModel(word, recordings))
    text = diagnosis_markdown(diagnosis)
    context = _context(with_held_out, after, tuple(steps), text, truth=with_truth, logged=dataset)
    return ViewedRun(after.robot, after, with_held_out, replace(context, label=words[-1]))


def _requests(diagnosis: Diagnosis, rung: LadderStep) -> tuple[str, ...]:
    """The effects of a rung's model: the initial ones, and those of the rung that the identified model has."""
    initial = diagnosis.before.effects
    added = [effect for effect in diagnosis.after.effects if effect not in initial]
    return (*initial, *(name for name in added if {name, name.partition(":")[0]} & {*rung.effects}))


def _of_sweep(folder: Path, runs: Sequence[int], with_truth: bool) -> list[ViewedRun]:
    """Runs of a sweep, simulated and identified again, since its folder keeps no recordings."""
    plan = plan_of(folder)
    viewed = []
    for number in runs or telling_runs(folder, plan):
        again = run_again(folder, plan, number)
        dataset, run = as_dataset(again.simulation), again.run
        filters = again.simulation.scenario.settings.filter.model_dump(exclude_none=True)
        asked = run.identify
        prepared = prepare(problem_of(dataset, asked["effects"], filters, fit_gains=asked["fit_gains"]))
        options = {key: asked[key] for key in ("deviations", "essential")}
        result = fit(prepared, asked["method"], **options)
        context = _context(dataset, result, text=f"**{again.title}**", truth=False)
        if with_truth:
            known, values = known_to(again.simulation, dataset.robot)
            context = replace(context, known=known, truth=values)
        viewed.append(ViewedRun(again.title, result, dataset, context))
    return viewed


def _context(
    dataset: Dataset,
    result: Identification,
    steps: tuple[LadderModel, ...] = (),
    text: str = "",
    *,
    truth: bool,
    logged: Dataset | None = None,
) -> ViewContext:
    """The context of an answer in the viewer. logged: the dataset before its recordings were split, if they were."""
    by_effect = effect_torques(result.recordings) if result.effects else []
    torques = {torque.name: torque for torque in by_effect}
    known, values = known_next_to(logged or dataset, dataset) if truth else ({}, None)
    return ViewContext(steps, torques, known, values, text)
