"""The pages: of a diagnosis, of an identification, of a saved model applied to recordings, of a replayed twin."""

from collections.abc import Callable, Mapping, Sequence

from bench.basics.errors import BenchError
from bench.basics.plain_data import finite
from bench.basics.plural import plural
from bench.dataset.dataset import Dataset
from bench.diagnosis.reason_words import validated_on
from bench.diagnosis.result import Diagnosis
from bench.diagnosis.split import dataset_of
from bench.diagnosis.unexplained import relative_noise_floor
from bench.document.typeset import typeset
from bench.export.replay.replay import Replay, TwinMotion
from bench.export.replay.words import replay_sentences
from bench.identification.findings import runaway
from bench.identification.model_file import Comparison
from bench.identification.problem import Problem
from bench.identification.result import CurrentSeries, Identification
from bench.page.parts import Mechanism, Page, Text
from bench.page.section_effects import gains_section, laws_section, not_ranked_section, ranking_section
from bench.page.section_errors import (
    currents_section,
    errors_section,
    errors_table,
    ladder_section,
    shown_model,
    where_section,
)
from bench.page.section_parameters import conditioning_section, parameters_section
from bench.page.section_run import Made, limits_section, run_section
from bench.page.verdict import (
    comparison_tiles,
    comparison_verdict,
    diagnosis_tiles,
    diagnosis_verdict,
    identification_tiles,
    identification_verdict,
    replay_tiles,
)
from bench.signals.settings import FilterSettings

FRAMES = 150  # of the moving robot: a smooth motion in a small file
AS_IT_IS, COMPLETED = "of the model as it is", "of the completed model"
OF_MODEL, OF_TWIN = "of the model itself", "of the twin"


def diagnosis_page(diagnosis: Diagnosis, problem: Problem, made: Made) -> Page:
    """The page of a diagnosis: what the model lacks, and the evidence. made: commands and versions behind the page."""
    dataset = problem.dataset
    before, after = diagnosis.before, diagnosis.after
    with_held_out = dataset_of(dataset, after.recordings)
    if diagnosis.added:
        models = [
            shown_model(AS_IT_IS, "before", problem, before, before.settings, label="Model as it is"),
            shown_model(COMPLETED, "after", problem, after, after.settings, label="Completed model"),
        ]
    else:
        models = [shown_model("", "error", problem, after, after.settings)]
    noise = relative_noise_floor(with_held_out.recordings, after.recordings, after.settings)
    ladder = ladder_section(diagnosis, errors_table(models[-1], after.recordings, noise))
    old = before if diagnosis.added else None
    return Page(
        title=f"What the model of {diagnosis.robot} is missing",
        facts=_facts(dataset, f"estimator {after.method}", typeset(f"judged on {validated_on(diagnosis)}")),
        verdict=diagnosis_verdict(diagnosis),
        tiles=diagnosis_tiles(diagnosis),
        sections=(
            ladder,
            *([laws_section(diagnosis)] if diagnosis.discovered else []),
            ranking_section(diagnosis, problem.catalogue),
            currents_section(models, _moving(with_held_out, after.recordings, after.settings)),
            where_section(models),
            gains_section(after, old),
            parameters_section(after, old, diagnosed=True),
            conditioning_section(after),
            limits_section(after, diagnosis, dataset, after.settings),
            run_section(dataset, after.settings, after, made),
        ),
        doubtful=runaway(after) is not None,
    )


def identification_page(result: Identification, problem: Problem, made: Made) -> Page:
    """The page of an identified model: its errors, gains and parameters."""
    dataset = problem.dataset
    model = shown_model("", "error", problem, result, result.settings, result.effects)
    noise = relative_noise_floor(dataset.recordings, result.recordings, result.settings)
    return Page(
        title=f"Drive gains and parameters of {result.robot}",
        facts=_facts(dataset, f"estimator {result.method}", ", ".join(result.effects) or "rigid bodies only"),
        verdict=identification_verdict(result, model.where, noise),
        tiles=identification_tiles(result, noise),
        sections=(
            errors_section(model, result.recordings, noise),
            currents_section([model], _moving(dataset, result.recordings, result.settings)),
            where_section([model]),
            not_ranked_section(),
            gains_section(result, None),
            parameters_section(result, None),
            conditioning_section(result),
            limits_section(result, None, dataset, result.settings),
            run_section(dataset, result.settings, result, made),
        ),
        doubtful=runaway(result) is not None,
    )


def comparison_page(comparison: Comparison, problem: Problem, saved: Identification, made: Made) -> Page:
    """The page of a saved model applied to recordings, fitted or not: its errors, and where they are."""
    dataset, settings = problem.dataset, saved.settings
    model = shown_model("", "error", problem, comparison, settings, saved.effects)
    noise = relative_noise_floor(dataset.recordings, comparison.recordings, settings)
    return Page(
        title=f"Where a model of {comparison.robot} fails",
        facts=_facts(dataset, f"model {comparison.model}", "nothing fitted"),
        verdict=comparison_verdict(comparison.error, comparison.model, model.where, noise),
        tiles=comparison_tiles(comparison.error, model.where, noise),
        sections=(
            errors_section(model, comparison.recordings, noise),
            currents_section([model], _moving(dataset, comparison.recordings, settings)),
            where_section([model]),
            not_ranked_section(),
            gains_section(saved, None),
            parameters_section(saved, None),
            limits_section(None, None, dataset, settings),
            run_section(dataset, settings, None, made),
        ),
    )


def replay_page(result: Replay, problem: Problem, saved: Identification, made: Made) -> Page:
    """The page of a saved model's twin, simulated along the recorded motions, compared with the model itself."""
    dataset, settings = problem.dataset, saved.settings
    model = shown_model(OF_MODEL, "before", problem, result.model, settings, label="Model itself")
    twin = shown_model(OF_TWIN, "after", problem, result.twin, settings, label="Twin")
    noise = relative_noise_floor(dataset.recordings, result.twin.recordings, settings)
    return Page(
        title=f"The twin of {result.twin.robot} along recorded motions",
        facts=_facts(dataset, f"model {result.twin.model}", "simulated by MuJoCo alone"),
        verdict=tuple(map(typeset, replay_sentences(result))),
        tiles=replay_tiles(result, twin.where, noise),
        sections=(
            errors_section(twin, result.twin.recordings, noise),
            currents_section(
                [model, twin], _moving(dataset, result.twin.recordings, settings, result.motions)
            ),
            where_section([model, twin]),
            gains_section(saved, None),
            run_section(dataset, settings, None, made),
        ),
    )


def _moving(
    dataset: Dataset,
    recordings: Sequence[CurrentSeries],
    settings: FilterSettings,
    twins: Mapping[str, TwinMotion] | None = None,
) -> Callable[[str, str], Mechanism | Text]:
    """A function from a recording's name and option to the moving robot, with its twin, or to why it is not drawn."""
    logged = dataset_of(dataset, recordings)

    def moving(name: str, option: str) -> Mechanism | Text:
        from bench.page.mechanism import mechanism  # noqa: PLC0415 - the viewer's shapes take their time to import

        recording = next(log for log in logged.recordings if log.name == name)
        series = next(trace for trace in recordings if trace.name == name)
        try:
            twin = None if twins is None else twins[name]
            data = mechanism(logged, recording, series, settings, FRAMES, twin)
        except BenchError as error:
            return Text("The robot", (f"It is not drawn: {error}.",))
        aid = f"In {name}; it follows the time cursor of the curves above where they are of that recording."
        if twins is not None:
            aid += " Thin lines: the simulated twin."
        return Mechanism("The robot", aid, option, finite(data))

    return moving


def _facts(dataset: Dataset, *more: str) -> tuple[str, ...]:
    loads = sorted({recording.payload for recording in dataset.recordings if recording.payload is not None})
    payload = f"payload {', '.join(loads)}" if loads else "no payload"
    count = plural(len(dataset.recordings), "recording")
    return (f"robot {dataset.robot.name}", f"dataset {dataset.folder.name}", count, payload, *more)
