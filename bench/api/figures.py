"""Figures for papers, with the numbers behind them."""

from collections.abc import Sequence
from pathlib import Path

from bench.api.sources import Data, as_dataset
from bench.basics.errors import BenchError
from bench.dataset.dataset import Dataset
from bench.diagnosis.result import Diagnosis
from bench.document.figures.paper import PaperFigure, write_paper_figures
from bench.document.figures.paper_errors import error_figures
from bench.document.figures.paper_model import diagnosis_figures, gain_figure
from bench.identification.result import Identification
from bench.residuals.motor import compared


def figures(
    result: Identification | Diagnosis, data: Data, folder: str | Path, names: Sequence[str] = ()
) -> tuple[Path, ...]:
    """Write figures of a result as PDF and PNG, with their numbers as CSV: the paths.

    data: what it was identified from, or its folder. names: those to draw, or how their names begin; none: every one.
    Raises BenchError for a name that no figure has.
    """
    diagnosis = result if isinstance(result, Diagnosis) else None
    after = result.after if isinstance(result, Diagnosis) else result
    chosen = figures_named(figures_of(as_dataset(data), after, diagnosis), names)
    return tuple(write_paper_figures(Path(folder), chosen))


def figures_named(found: Sequence[PaperFigure], names: Sequence[str]) -> list[PaperFigure]:
    """The figures whose names begin so, all without any. Raises BenchError for a name that no figure has."""
    for name in names:
        if not any(figure.name.startswith(name) for figure in found):
            raise BenchError(
                f"{name}: no such figure; there are {', '.join(figure.name for figure in found)}"
            )
    return [figure for figure in found if not names or figure.name.startswith(tuple(names))]


def figures_of(dataset: Dataset, result: Identification, diagnosis: Diagnosis | None) -> list[PaperFigure]:
    """Every figure of a result, and of the diagnosis that it comes from, if any."""
    what = compared(dataset.robot, dataset.recordings, result.recordings, result.settings)
    found = [*error_figures(what), *([gain_figure(result)] if result.gains_fitted else [])]
    return [*found, *(diagnosis_figures(diagnosis) if diagnosis is not None else [])]
