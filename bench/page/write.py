"""Write the page of a run, and the files needed to write it again."""

from dataclasses import replace
from pathlib import Path

from bench.basics.files.atomic import write_text_atomically
from bench.basics.progress import SILENT, Progress
from bench.basics.shell_word import quoted
from bench.dataset.dataset import Dataset
from bench.diagnosis.result import Diagnosis
from bench.effects.select import TAG
from bench.identification.model_file import Comparison, model_json
from bench.identification.result import Identification
from bench.page.folder import SavedRun, save_run, save_workbench
from bench.page.pages import comparison_page, diagnosis_page, identification_page
from bench.page.parts import Page
from bench.page.render import Workbench, render_page
from bench.page.section_run import CommandRun, Made
from bench.page.workbench.page_data import page_data, with_command
from bench.page.workbench.page_files import script, style

REPORT_FILE = "report.html"


def write_page(path: Path, page: Page, workbench: Workbench | None = None) -> Path:
    """Write a page, whole or not at all."""
    write_text_atomically(path, render_page(page, workbench))
    return path


def write_diagnosis_report(
    folder: Path, diagnosis: Diagnosis, dataset: Dataset, run: CommandRun, progress: Progress = SILENT
) -> Path:
    """Write report.html of a diagnosis into its folder, and the files needed to write it again."""
    kept = SavedRun(run, dataset, diagnosis.after, diagnosis, "")
    save_run(folder, kept)  # before the page is drawn
    progress.phase("preparing the workbench of the page")
    kept = replace(kept, workbench=page_data(kept.problem, diagnosis))
    save_workbench(folder, kept)
    return write_saved_run(folder / REPORT_FILE, kept, folder, progress)


def write_identification_report(
    folder: Path, result: Identification, dataset: Dataset, run: CommandRun, model: str = ""
) -> Path:
    """Write report.html of an identification, or of the application of a saved model, named `model`."""
    kept = SavedRun(run, dataset, result, None, model)
    save_run(folder, kept)
    return write_saved_run(folder / REPORT_FILE, kept, folder)


def write_saved_run(
    path: Path, kept: SavedRun, folder: Path | None = None, progress: Progress = SILENT
) -> Path:
    """Write the page of a run, new or read from its folder, which `folder` names."""
    again = [kept.run.line()]
    if folder is not None:
        again.append(f"bench report {quoted(folder)} -o {quoted(path)}")
    made = Made(tuple(again), kept.by)
    after, workbench = kept.after, None
    progress.phase("drawing the page")
    if kept.diagnosis is not None:
        page = diagnosis_page(kept.diagnosis, kept.problem, made)
        data = kept.workbench
        if data is None:
            progress.phase("preparing the workbench of the page")
            data = page_data(kept.problem, kept.diagnosis)
        model = model_json(kept.diagnosis.after, kept.dataset.folder)
        workbench = Workbench(with_command(data, _identify_line(kept), model), script(), style())
    elif kept.model:
        comparison = Comparison(after.robot, kept.model, after.recordings, after.error)
        page = comparison_page(comparison, kept.problem, after, made)
    else:
        page = identification_page(after, kept.problem, made)
    return write_page(path, page, workbench)


def _identify_line(kept: SavedRun) -> str:
    """The command that identifies the dataset with the same options, without the page's effects."""
    each = tuple(effect for effect in kept.after.effects if effect.endswith(TAG))
    options = {name: value for name, value in kept.run.options.items() if name not in ("time_limit", "rule")}
    return CommandRun("identify", kept.run.dataset, each, kept.run.effect_files, options).line()
