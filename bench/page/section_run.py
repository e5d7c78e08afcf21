"""Sections on the run: its limits, its settings, and how to repeat it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from bench.basics.shell_word import each, option_words, quoted
from bench.basics.versions import Versions, versions
from bench.dataset.dataset import Dataset
from bench.diagnosis.dependence_words import unfinished_sentence
from bench.diagnosis.reason_words import unexplained_words, validated_on
from bench.diagnosis.result import Diagnosis, Unfinished
from bench.document.numbers import STD_FROM, USES, fit_rate
from bench.document.typeset import effect_name, short, typeset
from bench.identification.result import Identification
from bench.page.parts import Commands, Kind, PageTable, Part, Section, page_table, sentences_section
from bench.signals.settings import FilterSettings


@dataclass(frozen=True)
class CommandRun:
    """A command, so that it can be repeated. options: by name, with underscores for hyphens."""

    command: str
    dataset: str
    effects: tuple[str, ...] = ()
    effect_files: tuple[str, ...] = ()
    options: dict[str, Any] = field(default_factory=dict)
    output: str = ""

    def line(self, program: str = "bench") -> str:
        """The command line. program: its first word, quoted for a shell if necessary."""
        words = [self.command, self.dataset, *self.option_words()]
        return " ".join([program, *(quoted(word) for word in words)])

    def option_words(self) -> list[str]:
        """The words after the dataset."""
        words = [*each("--with", self.effects), *each("--effect-file", self.effect_files)]
        words += option_words(self.options)
        return [*words, "-o", self.output] if self.output else words


@dataclass(frozen=True)
class Made:
    """The origin of a page. again: the commands that reproduce it; by: the versions that computed its results."""

    again: tuple[str, ...]
    by: Versions = field(default_factory=versions)


def limits_section(
    result: Identification | None, diagnosis: Diagnosis | None, dataset: Dataset, settings: FilterSettings
) -> Section:
    """The limits of this run."""
    limits: list[str] = list(dict.fromkeys(result.notes)) if result is not None else []
    validated = any(recording.use == "validate" for recording in dataset.recordings)
    if not validated and diagnosis is not None:
        limits.append(
            typeset(f"No recording is kept for validation: judged on {validated_on(diagnosis)}.")
            + " Another movement is a harder judge."
        )
    elif not validated:
        limits.append(
            "No recording is kept for validation: every error here is of recordings that were fitted. Give one "
            'use = "validate" in dataset.toml.'
        )
    band = settings.band(dataset.recordings[0].rate)
    limits.append(
        f"The fit sees nothing above {band:.3g} Hz. What lies there, such as vibrations or the corners of friction, "
        "is filtered out of both sides and shows in no error."
    )
    if not settings.keep_standstill:
        limits.append("Rows of a joint that stands still are not judged: friction may take any value there.")
    limits.append(
        "The noise of the currents is read off their spectra above the band of the motion and taken as white. Noise "
        "that a controller passes on from the encoders below it counts as error."
    )
    if diagnosis is not None:
        if not diagnosis.finished:
            limits.append(typeset(unfinished_sentence(diagnosis)))
        for verdict, said in (
            ("absorbed", "No data of this robot with these payloads could show"),
            ("indistinguishable", "These recordings cannot decide on"),
        ):
            names = [effect_name(ranked.effect) for ranked in diagnosis.ranking if ranked.verdict == verdict]
            limits += [f"{said}: {', '.join(names)}."] if names else []
        if diagnosis.unexplained.significant:
            searched = Unfinished.SETS not in diagnosis.unfinished
            words = unexplained_words(diagnosis.unexplained, searched=searched)
            limits.append(typeset(f"{words[:1].upper()}{words[1:]}."))
    else:
        limits.append("Which physical effects the model lacks was not looked for: bench diagnose does.")
    lead = "What these recordings and this model cannot say."
    return sentences_section("limits", "Known limits of this run", limits, lead, "Known limits")


def run_section(
    dataset: Dataset, settings: FilterSettings, result: Identification | None, made: Made
) -> Section:
    """Recordings, settings, versions, and the commands that reproduce this page."""
    parts: list[Part] = [_recordings_table(dataset)]
    if dataset.payloads:
        parts.append(_payloads_table(dataset))
    parts += [
        _settings_table(settings, result, dataset),
        _versions([("Python", made.by.python), *made.by.packages, ("commit", made.by.commit)]),
        Commands("Run it again", "In the folder from which it was run, with the same version.", made.again),
    ]
    lead = "All that is needed to get the same page from the same recordings."
    return Section(
        "run", "Settings, versions, and how to run it again", lead, tuple(parts), "Settings, versions"
    )


def _recordings_table(dataset: Dataset) -> PageTable:
    rows = [
        (
            recording.name,
            USES[recording.use],
            recording.payload or "none",
            str(len(recording.time)),
            short(float(recording.time[-1] - recording.time[0]), 5),
            short(recording.rate, 6),
        )
        for recording in dataset.recordings
    ]
    heads: Mapping[str, Kind] = {"file": "", "use": "keep", "payload": "", "samples": "right"}
    heads = {**heads, "duration [s]": "right", "rate [Hz]": "right"}
    return page_table("Recordings", "As dataset.toml lists them.", heads, rows)


def _payloads_table(dataset: Dataset) -> PageTable:
    rows = []
    for name, payload in dataset.payloads.items():
        mass = "estimated" if payload.mass is None else short(payload.mass, 6)
        center, inertia = (
            "estimated" if values is None else ", ".join(short(float(v), 5) for v in values)
            for values in (payload.center_of_mass, payload.inertia)
        )
        rows.append((name, mass, center, inertia))
    heads: Mapping[str, Kind] = {"payload": "", "mass [kg]": "right", "centre of mass, tool frame [m]": ""}
    aid = "What dataset.toml declares; what it does not is estimated."
    return page_table("Payloads", aid, {**heads, "inertia Ixx Iyy Izz Ixy Ixz Iyz [kg·m²]": ""}, rows)


def _settings_table(settings: FilterSettings, result: Identification | None, dataset: Dataset) -> PageTable:
    rows = []
    if result is not None:
        rows += [
            ("estimator", result.method),
            ("effects in the model", ", ".join(result.effects) or "none: rigid bodies only"),
            ("drive gains", "fitted" if result.gains_fitted else "nominal"),
            ("standard errors", f"for {result.deviations} errors; from {STD_FROM[result.std_from]}"),
        ]
        rows.append(("rate of the fit", "–" if (rate := fit_rate(result)) is None else f"{rate:.4g} Hz"))
    rows += [
        ("position low-pass", f"{settings.position_cutoff:.4g} Hz, order {settings.filter_order}, both ways"),
        ("differences", f"central, order {settings.difference_order}"),
        ("decimation", f"one sample in {settings.decimation}"),
        ("dropped at the ends", f"{settings.border[0]} and {settings.border[1]} samples"),
        ("rows at standstill", "kept" if settings.keep_standstill else "left out"),
        ("random numbers", "none in the fit; tests against chance use a fixed seed"),
    ]
    if dataset.effect_files:
        rows.append(("own effects", ", ".join(path.name for path in dataset.effect_files)))
    aid = "Chosen from the spectra of the data unless they were given."
    return page_table("Settings", aid, {"setting": "keep", "value": ""}, rows)


def versions_of(columns: Mapping[str, Sequence[Any]]) -> PageTable:
    """The versions that computed the rows of a table, from its columns commit and version.PACKAGE."""
    different = {name: sorted({str(value) for value in columns[name] if value}) for name in columns}
    return _versions(
        [(name.removeprefix("version."), ", ".join(values)) for name, values in different.items()]
    )


def _versions(rows: Sequence[tuple[str, str]]) -> PageTable:
    """Versions by package; unknown ones are empty and omitted."""
    aid = "What computed this page. A commit with + had files that differ from it."
    known = [package for package in rows if package[1]]
    return page_table("Versions", aid, {"package": "keep", "version": ""}, known, folded=True)
