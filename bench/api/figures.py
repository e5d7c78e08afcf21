"""Figures for papers, with the numbers behind them."""

from pathlib import Path

from bench.api.sources import Data, as_dataset
from bench.diagnosis.result import Diagnosis
from bench.document.figures.paper import write_paper_figures
from bench.document.figures.paper_errors import error_figures
from bench.document.figures.paper_model import diagnosis_figures, gain_figure
from bench.identification.result import Identification
from bench.residuals.motor import compared


def figures(result: Identification | Diagnosis, data: Data, folder: str | Path) -> tuple[Path, ...]:
    """Write every figure of a result as PDF and PNG, with its numbers as CSV: the paths.

    data: what it was identified from, or its folder.
    """
    dataset = as_dataset(data)
    after = result.after if isinstance(result, Diagnosis) else result
    what = compared(dataset.robot, dataset.recordings, after.recordings, after.settings)
    found = [*error_figures(what), *([gain_figure(after)] if after.gains_fitted else [])]
    found += diagnosis_figures(result) if isinstance(result, Diagnosis) else []
    return tuple(write_paper_figures(Path(folder), found))
