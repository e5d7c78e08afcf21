"""Where a model fails on recordings."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from bench.api.sources import Data, Model, as_dataset, dataset_behind
from bench.dataset.dataset import Dataset
from bench.identification.chosen_band import prepare_checked
from bench.identification.frame import data_frame, html_table
from bench.identification.identify import identify
from bench.identification.mistaken import heavy_payloads
from bench.identification.model_file import Comparison, SavedModel, apply_model, load_model
from bench.identification.problem import Filters, problem_of
from bench.identification.result import CurrentSeries, ErrorSummary, Identification
from bench.residuals.look_alikes import possible_effects
from bench.residuals.motor import Compared, compared
from bench.residuals.residuals import WhereItFails, errors_by_motor

if TYPE_CHECKING:
    import pandas as pd

COLUMNS = ("motor", "recording", "use", "error", "noise")


@dataclass(frozen=True, repr=False)
class ModelErrors:
    """A model compared with recordings: how large its errors are, and where.

    effects: those of the model. identified: the identification, fitted now or given; None if a saved model was applied.
    """

    dataset: Dataset
    effects: tuple[str, ...]
    comparison: Comparison
    motors: Compared
    where: WhereItFails
    identified: Identification | None

    @property
    def error(self) -> ErrorSummary:
        """Relative errors by use, motor and recording."""
        return self.comparison.error

    @property
    def recordings(self) -> tuple[CurrentSeries, ...]:
        """Measured and modelled currents of every recording."""
        return self.comparison.recordings

    def rows(self) -> list[dict[str, str | float]]:
        """One row per motor and recording: motor, recording, use, and error and noise relative to the current."""
        uses = {trace.name: trace.use for trace in self.recordings}
        return [
            {"motor": motor.joint, "recording": name, "use": uses[name], "error": error, "noise": noise}
            for motor in self.where.motors
            for name, (error, noise) in motor.by_recording.items()
        ]

    def to_dataframe(self) -> pd.DataFrame:
        """The rows as a data frame. Needs pandas."""
        rows = self.rows()
        return data_frame({name: [row[name] for row in rows] for name in COLUMNS})

    def _repr_html_(self) -> str:
        return html_table(repr(self)[1:-1], self.rows())

    def __repr__(self) -> str:
        errors = ", ".join(
            f"{joint} {100.0 * error:.3g} %" for joint, error in self.error.by_actuator.items()
        )
        return f"<errors of {self.comparison.model} on {self.dataset.folder.name}: {errors}>"


def compare(
    data: Data,
    model: Model | None = None,
    effects: Sequence[str] = (),
    *,
    filters: Filters = None,
    effect_files: Iterable[str | Path] = (),
) -> ModelErrors:
    """Where a model fails on a dataset's recordings, motor by motor.

    data: a dataset or its folder. model: a result of `identify` for this dataset, or a saved model or its file, applied
    unchanged; if omitted, a model with these effects and filters is identified from the dataset. Raises BenchError
    naming what cannot be used.
    """
    dataset = as_dataset(data)
    problem = problem_of(dataset, effects, filters, effect_files=effect_files)
    result: Identification | None = None
    if model is None:
        result = identify(prepare_checked(problem))
        name = f"identified now, {', '.join(effects) or 'rigid bodies only'}"
        findings = (*heavy_payloads(dataset), *result.findings)
        comparison = Comparison(result.robot, name, result.recordings, result.error, findings)
        has, settings = result.effects, result.settings
    elif isinstance(model, Identification):
        dataset = dataset_behind(dataset, model)
        result, has, settings = model, model.effects, model.settings
        name = f"as given, {', '.join(model.effects) or 'rigid bodies only'}"
        comparison = Comparison(model.robot, name, model.recordings, model.error, model.findings)
    else:
        saved = model if isinstance(model, SavedModel) else load_model(Path(model))
        applied, settings = apply_model(problem, saved), saved.settings
        comparison = replace(applied, findings=(*heavy_payloads(dataset), *applied.findings))
        has = saved.model.effects
    motors = compared(dataset.robot, dataset.recordings, comparison.recordings, settings)
    where = errors_by_motor(motors, possible_effects(problem), has)
    return ModelErrors(dataset, has, comparison, motors, where, result)
