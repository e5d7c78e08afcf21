"""The end of a command: run all output steps, list the written files, and suggest the next command."""

import io
import json
import re
import sys
from collections.abc import Callable, Mapping, Sequence
from contextlib import redirect_stdout
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from bench.basics.errors import BenchError, FaultsError, lines_of

if TYPE_CHECKING:
    from bench.diagnosis.result import Diagnosis

STANDARD_OUTPUT = Path("-")
AGAIN = "again, after correcting what the first note says"
_OUTPUT, _QUIET = "bench.standard output", "bench.quiet"


def wrote(path: str | Path, what: str = "") -> str:
    """The line on a written file or folder. what: its content."""
    return f"wrote {path} ({what})" if what else f"wrote {path}"


def next_line(words: Sequence[str | Path], why: str = "") -> str:
    """The line with the suggested next command, to be copied. why: what it does."""
    from bench.basics.shell_word import quoted

    line = f"next: {' '.join(quoted(word) for word in ('bench', *words))}"
    return f"{line}    {why}" if why else line


def say(lines: Sequence[str]) -> None:
    """Print the last lines, except those about standard output; a next command starts with the word of `typed`."""
    from bench.basics.program import typed

    for line in lines:
        if not line.startswith(f"wrote {STANDARD_OUTPUT} "):
            click.echo(re.sub("^next: bench ", lambda _: f"next: {typed()} ", line))


def set_quiet(context: click.Context, _option: click.Parameter, quiet: bool) -> bool:
    """Callback of --quiet: print only errors."""
    if quiet:
        _standard_output(context)
        context.meta[_QUIET] = True
        context.with_resource(redirect_stdout(io.StringIO()))
    return quiet


def answer_on(context: click.Context, file: Path | None) -> Path | None:
    """The file; if it is standard output, the text for people is redirected to standard error."""
    if file == STANDARD_OUTPUT:
        _standard_output(context)
        if not context.meta.get(_QUIET):
            context.with_resource(redirect_stdout(sys.stderr))
    return file


def _standard_output(context: click.Context) -> Any:
    return context.meta.setdefault(_OUTPUT, sys.stdout)


def write_with_words(
    path: Path | None, made: Callable[..., Mapping[str, Any]], what: str, written: list[str]
) -> None:
    """Write an answer with its sentences, or without them if they fail; the error is raised afterwards. None: no file.

    made: returns the answer, with words=False without sentences. what: the file's content, for the line added to
    `written`.
    """
    if path is None:
        return
    answer = made(words=False)
    try:
        answer = made()
    finally:
        write_answer(path, answer)
        written.append(wrote(path, what))


def write_answer(path: Path, answer: Mapping[str, Any]) -> None:
    """Write an answer as JSON with the versions of the program, to a file (atomically) or to standard output."""
    from bench.basics.files.atomic import write_json_atomically
    from bench.basics.versions import versions

    value = {**answer, "versions": versions().named()}
    if path != STANDARD_OUTPUT:
        write_json_atomically(path, value)
        return
    stream = _standard_output(click.get_current_context())
    stream.write(json.dumps(value, indent=2, ensure_ascii=False, allow_nan=False) + "\n")
    stream.flush()


def after_diagnosis(
    diagnosis: "Diagnosis", dataset: Path, again: str, model: Path | None, effect_files: Sequence[Path] = ()
) -> str:
    """The suggested next command after a diagnosis. again: its command line; model: the file of `--apply`.

    effect_files: files of effects that the model needs in addition to the catalogue.
    """
    from bench.basics.shell_word import each
    from bench.identification.finding import MEND_FIRST

    already = each("--with", diagnosis.before.effects)
    if any(finding.code in MEND_FIRST for finding in diagnosis.after.findings):
        return f"next: {again}    {AGAIN}"
    words: list[str | Path]
    missing = diagnosis.missing or diagnosis.discovered
    if missing and model is not None:
        words = ["compare", dataset, "--model", model, *each("--effect-file", effect_files)]
        return next_line(words, "shows the remaining error")
    if missing:
        return f"next: {again} --apply model.json    writes the model with the missing effects"
    for verdict in diagnosis.ranking:
        if verdict.verdict == "indistinguishable" and verdict.alternatives:
            at = f":{verdict.actuators[0]}" if verdict.actuators else ""
            pair = (f"{verdict.effect}{at}", f"{verdict.alternatives[0]}{at}")
            folder = dataset.with_name(f"{dataset.resolve().name}.motion")
            words = ["discriminate", dataset, *pair, *already, "-o", folder]
            return next_line(words, "designs the motion that distinguishes them")
    return next_line(["identify", dataset, *already, "--json", "model.json"], "saves the present model")


def take_all(*steps: Callable[[], object]) -> None:
    """Take every step in order, and raise the errors of steps after the last one, several errors together."""
    errors: list[Exception] = []
    for step in steps:
        try:
            step()
        except Exception as error:  # noqa: BLE001 - every error is raised below
            errors.append(error)
    users = [error for error in errors if isinstance(error, BenchError)]
    if len(errors) == 1:
        raise errors[0]
    if errors and len(users) == len(errors):
        raise FaultsError(line for error in users for line in lines_of(error))
    if errors:
        raise ExceptionGroup("more than one step failed", errors)


def shown(report: Callable[[], object], verdict: Callable[[], Mapping[str, Any]]) -> None:
    """Print a report. If it fails, print the verdict as JSON, and raise the error."""
    try:
        report()
    except BaseException:
        click.echo(json.dumps(verdict(), indent=2, ensure_ascii=False))
        raise
