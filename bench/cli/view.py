"""`bench view`: a dataset, a model or results in the Rerun viewer, or as a file for Foxglove and PlotJuggler."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import click

from bench.cli.last_lines import say, wrote
from bench.cli.options import Asked, data_option, effect_file_option, filter_options, path_option, with_option


@click.command("view")
@click.argument("source", type=click.Path(path_type=Path))
@with_option
@effect_file_option
@data_option
@click.option("--run", "runs", type=int, multiple=True, metavar="N", help="Run of a sweep. Repeat for each.")
@click.option("--no-truth", is_flag=True, help="Omit the true hidden effects of a simulation.")
@filter_options
@path_option(
    "--save", metavar="FILE", help="Only write: FILE.rrd for Rerun, FILE.mcap for Foxglove and PlotJuggler."
)
def view(
    source: Path,
    data: Path | None,
    runs: tuple[int, ...],
    no_truth: bool,
    save: Path | None,
    asked: Asked,
) -> None:
    """Show the moving robot, currents and errors in the Rerun viewer.

    SOURCE is a dataset, which is identified (with the effects named, one after the other); a model file of
    `bench identify --json`; a folder that `bench identify`, `compare` or `diagnose` wrote with -o; or the folder of
    a sweep, of which a good, a median and a bad run are simulated again and shown side by side.

    The recording is written to SOURCE.rrd, next to SOURCE, and opened; with --save it is only written. An .mcap file
    has positions and currents as logged, measured and modelled currents, errors, joint states and the torque of each
    effect, for every recording.
    """
    from bench.cli.named_sources import viewed_runs
    from bench.cli.next_steps import Source, after_looking
    from bench.viewer.mcap_file import SUFFIX, need_mcap, write_mcap
    from bench.viewer.recording import write_rrd, write_side_by_side

    there = Source(source, asked, data)
    resolved = source.resolve()
    path = resolved.with_name(f"{resolved.name.removesuffix('.json')}.rrd") if save is None else save
    is_mcap = path.suffix.lower() == SUFFIX
    if is_mcap:
        need_mcap(path)
    viewed = viewed_runs(there, runs, with_truth=not no_truth)
    if is_mcap:
        write_mcap(path, viewed)
    elif len(viewed) == 1:
        write_rrd(path, viewed[0].result, viewed[0].dataset, context=viewed[0].context)
    else:
        write_side_by_side(path, viewed)
    how = "open it in Foxglove or PlotJuggler" if is_mcap else f"open it with rerun {path}"
    written = [wrote(path, "recording" if save is None else f"recording: {how}")]
    if save is None:
        written.append(open_viewer(path))
    say([*written, after_looking(there)])


def open_viewer(path: Path) -> str:
    """Open a recording in a window that stays after the command; returns what was done, or what the user can do."""
    installed = Path(sys.executable).with_name("rerun")
    program = str(installed) if installed.is_file() else shutil.which("rerun")
    if program is None:
        return f"The program rerun is not on the path; open it with: rerun {path}"
    if sys.platform.startswith("linux") and not (
        os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")
    ):
        return f"No screen; open it on another machine, or in a browser with: rerun --web-viewer {path}"
    subprocess.Popen(
        [program, str(path)],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
    )
    return "Opened in the Rerun viewer."
