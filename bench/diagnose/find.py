"""Diagnosis with the effects of a dataset and of a user's own files."""

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from bench.dataset import Dataset
from bench.diagnose.diagnose import diagnose
from bench.diagnose.result import Diagnosis
from bench.effects import catalogue_for
from bench.progress import SILENT, Progress
from bench.signals.settings import FilterSettings


def find_missing_effects(
    dataset: Dataset,
    effects: Sequence[str] = (),
    *,
    filters: FilterSettings | Mapping[str, Any] | None = None,
    effect_files: Iterable[str | Path] = (),
    progress: Progress = SILENT,
) -> Diagnosis:
    """Which physical effects the model lacks, judged on recordings that were not fitted.

    effects: those that the model has already, each as EFFECT[:PLACE][@recording]. filters: settings by name, the
    others chosen from the data. effect_files: Python files with effects of your own, which compete as well as
    those that the dataset names. progress: told how far the search is. Raises BenchError naming what in
    dataset, robot or files cannot be used.
    """
    catalogue = catalogue_for(dataset.effect_files, [Path(file) for file in effect_files])
    return diagnose(dataset, effects, filters=filters, catalogue=catalogue, progress=progress)
