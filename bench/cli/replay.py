"""`bench replay`: compare the exported twin with a dataset."""

from pathlib import Path

import click

from bench.cli.last_lines import say, write_answer, wrote
from bench.cli.options import (
    cad_option,
    dataset_argument,
    effect_file_option,
    in_existing_folder,
    json_option,
    nearest_option,
    output_option,
    path_option,
)
from bench.cli.progress import quiet_option


@click.command("replay")
@dataset_argument
@path_option(
    "--model", "model_file", required=True, metavar="MODEL.json", help="A file from `bench identify --json`."
)
@cad_option
@nearest_option("Use")
@effect_file_option
@json_option
@output_option("Folder for a report: currents of machine, model and twin, and the robot in motion.")
@quiet_option
@path_option(
    "--rrd",
    "rrd_file",
    metavar="FILE.rrd",
    callback=in_existing_folder,
    help="Write a recording for the Rerun viewer.",
)
def replay(
    dataset: Path,
    model_file: Path,
    cad: bool,
    nearest: bool,
    effect_files: tuple[Path, ...],
    json_file: Path | None,
    output: Path | None,
    rrd_file: Path | None,
    quiet: bool,
) -> None:
    """Simulate an exported model in MuJoCo along a dataset's motions.

    The twin that `bench export --to mjcf` writes follows every recording under a stiff controller; the
    command compares its currents with the recorded ones and with those of the model. MuJoCo closes the loops and
    integrates independently: if both errors agree, the exported file reproduces the model.
    """
    from dataclasses import replace

    from rich.console import Console

    from bench.basics.errors import BenchError
    from bench.basics.shell_word import each, option_words
    from bench.cli.next_steps import after_replay
    from bench.cli.progress import shown_progress
    from bench.cli.replay_report import replay_report
    from bench.dataset.dataset import load_dataset
    from bench.export.identified import declaring, load_identified
    from bench.export.physical import physical_set
    from bench.export.replay.replay import replay as replayed
    from bench.export.replay.replay import replay_json
    from bench.export.replay.words import replay_sentences
    from bench.identification.model_file import read_identification
    from bench.identification.problem import problem_of

    data = load_dataset(dataset)
    identified = load_identified(model_file, data.robot.folder, (*data.effect_files, *effect_files))
    identified = declaring(identified, data.payloads)
    physical = physical_set(identified, use_cad=cad)
    if physical.contradiction is not None and not nearest:
        raise BenchError(f"{model_file}: {physical.contradiction.words()}; --nearest uses them anyway")
    problem = problem_of(data, effect_files=effect_files)
    with shown_progress(quiet) as progress:
        result = replayed(problem, physical, progress)
    saved = read_identification(model_file, problem)
    written = []
    if json_file is not None:
        write_answer(json_file, replay_json(result))
        written.append(wrote(json_file, "answer"))
    if output is not None:
        from bench.page.pages import replay_page
        from bench.page.section_run import CommandRun, Made
        from bench.page.write import REPORT_FILE, write_page

        given = {"model": str(model_file), "no_cad": not cad, "nearest": nearest}
        run = CommandRun("replay", str(dataset), (), tuple(map(str, effect_files)), given, str(output))
        page = replay_page(result, problem, saved, Made((run.line(),)))
        written.append(wrote(write_page(output / REPORT_FILE, page), "report"))
    if rrd_file is not None:
        from bench.viewer.context import ViewContext
        from bench.viewer.recording import write_rrd

        shown = replace(saved, method="twin", recordings=result.twin.recordings, error=result.twin.error)
        text = "\n\n".join(["In outline: the twin, as MuJoCo simulates it.", *replay_sentences(result)])
        write_rrd(rrd_file, shown, data, context=ViewContext(simulated=result.motions, text=text))
        written.append(wrote(rrd_file, "recording"))
    replay_report(result, Console())
    options = [*option_words({"no_cad": not cad, "nearest": nearest}), *each("--effect-file", effect_files)]
    say([*written, after_replay(dataset, model_file, rrd_file, options)])
