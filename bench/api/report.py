"""Reports of a result: as text, in a notebook, or as a page."""

import io
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rich.console import Console

from bench.api.compare import ModelErrors
from bench.api.sources import Data, as_dataset
from bench.basics.errors import BenchError
from bench.diagnosis.result import Diagnosis
from bench.document.terminal.diagnosis import diagnosis_report
from bench.document.terminal.identification import comparison_report, identification_report, where_report
from bench.identification.model_file import SavedModel
from bench.identification.result import Identification
from bench.page.folder import SavedRun
from bench.page.section_run import CommandRun
from bench.page.write import write_saved_run

WIDTH = 110  # characters
Result = Identification | Diagnosis | ModelErrors | SavedModel


@dataclass(frozen=True, repr=False)
class Report:
    """A result as text: `print(report)`, or the last line of a notebook cell. verbose: the complete report."""

    result: Result
    verbose: bool = False

    def _printed(self) -> Console:
        console = Console(file=io.StringIO(), width=WIDTH, record=True)
        print_result(self.result, console, self.verbose)
        return console

    def __str__(self) -> str:
        return self._printed().export_text()

    __repr__ = __str__

    def _repr_html_(self) -> str:
        form = "<pre style='line-height:1.2'>{code}</pre>"
        return self._printed().export_html(inline_styles=True, code_format=form)

    def save(self, path: str | Path, data: Data) -> Path:
        """Write the page of the result as one file; return its path.

        data: the dataset that the result was identified from, or its folder. Raises BenchError for a saved model or its
        errors.
        """
        dataset, page = as_dataset(data), Path(path)
        diagnosis = self.result if isinstance(self.result, Diagnosis) else None
        after = diagnosis.after if diagnosis is not None else self.result
        if isinstance(after, ModelErrors) and after.identified is not None:
            after = after.identified
        if isinstance(after, SavedModel | ModelErrors):
            raise BenchError(
                "the page of a saved model is written by `bench report MODEL.json --data DATASET`"
            )
        if not isinstance(after, Identification):
            raise BenchError(f"cannot write a page of a {type(after).__name__}")
        verb = "diagnose" if diagnosis is not None else "identify"
        run = CommandRun(verb, str(dataset.folder), tuple(after.effects), (), {}, str(page.parent))
        return write_saved_run(page, SavedRun(run, dataset, after, diagnosis, ""))


def report(result: Result, *, verbose: bool = False) -> Report:
    """A result of `identify`, `compare` or `diagnose`, or a saved model, to be printed or shown in a notebook.

    `Report.save` writes the page of a result. verbose: the complete report.
    """
    return Report(result, verbose)


def print_result(result: Any, console: Console, verbose: bool) -> None:
    """Print a result to a console. Raises BenchError if it is none."""
    match result:
        case Identification():
            identification_report(result, console, verbose=verbose)
        case SavedModel():
            identification_report(result.model, console, verbose=verbose, without_currents=result.recordings)
        case Diagnosis():
            diagnosis_report(result, console, verbose=verbose)
        case ModelErrors():
            comparison_report(result.comparison, console)
            where_report(result.where, console)
        case _:
            kind = type(result).__name__
            raise BenchError(f"cannot report a {kind}: give a result of identify, compare or diagnose")
