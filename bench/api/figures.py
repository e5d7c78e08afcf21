"""Figures for papers, with the numbers behind them."""

from pathlib import Path

from bench.api.sources import Data, as_dataset
from bench.dataset.dataset import Dataset
from bench.diagnosis.result import Diagnosis
from bench.document.figures.paper import PaperFigure, write_paper_figures
from bench.document.figures.paper_errors import error_figures
from bench.document.figures.paper_model import diagnosis_figures, gain_figure
from bench.identification.result import Identification
from bench.residuals.motor import compared


def figures(result: Identification | Diagnosis, data: Data, folder: str | Path) -> tuple[Path, ...]:
    """Write every figure of a result as PDF and PNG, with its numbers as CSV: the paths.

    data: what it was identified from, or its folder.
    """
    diagnosis = result if isinstance(result, Diagnosis) else None
    after = result.after if isinstance(result, Diagnosis) else result
    return tuple(write_paper_figures(Path(folder), figures_of(as_dataset(data), after, diagnosis)))


def figures_of(dataset: Dataset, result: Identification, diagnosis: Diagnosis | None) -> list[PaperFigure]:
    """Every figure of a result, and of the diagnosis that it comes from, if any."""
    what = compared(dataset.robot, dataset.recordings, result.recordings, result.settings)
    found = [*error_figures(what), *([gain_figure(result)] if result.gains_fitted else [])]
    return [*found, *(diagnosis_figures(diagnosis) if diagnosis is not None else [])]
