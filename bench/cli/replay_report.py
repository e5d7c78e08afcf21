"""A replay as a table in the terminal."""

from rich.console import Console

from bench.document.table import Column, Mark, Table
from bench.document.terminal.identification import heading, section
from bench.document.terminal.tables import printed
from bench.export.replay.replay import Replay
from bench.export.replay.words import shortcomings
from bench.identification.result import CurrentSeries, relative_error


def replay_table(result: Replay) -> Table:
    """The errors of the twin by recording and motor, and those of the model; the last row is the total."""
    twins, models = result.twin.recordings, result.model.recordings
    joints = tuple(result.twin.error.by_actuator or result.twin.error.by_actuator_validate)

    def errors(recordings: tuple[CurrentSeries, ...], motor: int | None = None) -> list[float | None]:
        return [*(relative_error([trace], motor) for trace in recordings), relative_error(recordings, motor)]

    columns = (
        Column("recording", [*(trace.name for trace in twins), "all"]),
        Column("payload", [*(trace.payload for trace in twins), ""]),
        *(Column(joint, errors(twins, motor), "share", rank=1) for motor, joint in enumerate(joints)),
        Column("all", errors(twins), "share"),
        Column("the model itself", errors(models), "share"),
    )
    marks: list[Mark] = [""] * len(twins)
    return Table(columns, (*marks, "strong"), (len(twins) - 1,))


def replay_report(result: Replay, console: Console) -> None:
    """Print the table, and what the twin omits."""
    heading(console, result.twin.robot, f"twin of {result.twin.model}")
    title = "Error of the twin's current, RMS(error) / RMS(measured)"
    section(console, title, printed(replay_table(result), console.width))
    for sentence in shortcomings(result):
        console.print(sentence, style="yellow")
    console.print()
