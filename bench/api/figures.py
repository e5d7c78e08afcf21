"""Figures for papers, with the numbers behind them."""

from collections.abc import Sequence
from pathlib import Path

from bench.api.compare import ModelErrors
from bench.api.sources import Data, as_dataset, dataset_behind
from bench.basics.errors import BenchError
from bench.dataset.dataset import Dataset
from bench.diagnosis.result import Diagnosis
from bench.document.figures.paper import PaperFigure, error_figures, write_paper_figures
from bench.document.figures.paper_model import diagnosis_figures, gain_figure
from bench.identification.result import Identification
from bench.residuals.motor import Compared, compared


def figures(
    result: Identification | Diagnosis | ModelErrors,
    data: Data,
    folder: str | Path,
    names: Sequence[str] = (),
) -> tuple[Path, ...]:
    """Write figures of a result as PDF and PNG, with their numbers as CSV; return the paths.

    data: the dataset that the result was identified from or compared with, or its folder. names: of the figures to
    draw, or the beginnings of their names; by default all are drawn. Raises BenchError if no figure has such a name, if
    the result is of other data, or if `result` is none of these types.
    """
    if not isinstance(result, Identification | Diagnosis | ModelErrors):
        raise BenchError(
            f"figures: cannot draw a {type(result).__name__}: give a result of identify, compare or diagnose"
        )
    dataset = as_dataset(data)
    if isinstance(result, ModelErrors):
        available = figures_of_errors(result.motors, result.identified)
    elif isinstance(result, Diagnosis):
        available = figures_of(dataset_behind(dataset, result.after), result.after, result)
    else:
        available = figures_of(dataset_behind(dataset, result), result, None)
    return tuple(write_paper_figures(Path(folder), figures_named(available, names)))


def figures_named(available: Sequence[PaperFigure], names: Sequence[str]) -> list[PaperFigure]:
    """The figures whose names begin with one of `names`, all if it is empty. Raises BenchError if one matches none."""
    for name in names:
        if not any(figure.name.startswith(name) for figure in available):
            known = ", ".join(figure.name for figure in available)
            raise BenchError(f"{name}: no such figure; there are {known}")
    return [figure for figure in available if not names or figure.name.startswith(tuple(names))]


def figures_of(dataset: Dataset, result: Identification, diagnosis: Diagnosis | None) -> list[PaperFigure]:
    """Every figure of a result, and of its diagnosis if there is one."""
    what = compared(dataset.robot, dataset.recordings, result.recordings, result.settings)
    available = figures_of_errors(what, result)
    return [*available, *(diagnosis_figures(diagnosis) if diagnosis is not None else [])]


def figures_of_errors(what: Compared, result: Identification | None) -> list[PaperFigure]:
    """Figures of a model's errors, and of its drive gains if these were fitted to the same recordings."""
    gains = [gain_figure(result)] if result is not None and result.gains_fitted else []
    return [*error_figures(what), *gains]
