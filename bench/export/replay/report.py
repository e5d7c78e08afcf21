"""A replay in words, and as a table in a terminal."""

from rich.console import Console
from rich.text import Text

from bench.document.table import Column, Mark, Table
from bench.document.terminal.tables import printed
from bench.export.replay.replay import Replay
from bench.identification.result import CurrentSeries, relative_error
from bench.identification.wording import in_percent

OPEN = 1e-4  # m or rad: a loop that opens farther moves the motors


def replay_table(result: Replay) -> Table:
    """The errors of the twin by recording and motor, beside those of the model itself; the last row is of all."""
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


def replay_sentences(result: Replay) -> tuple[str, ...]:
    """How near the twin comes to what was measured, beside the model, and what it does not hold."""
    twin, model = relative_error(result.twin.recordings), relative_error(result.model.recordings)
    if twin is None or model is None:
        return shortcomings(result)
    count = len(result.twin.recordings)
    said = (
        f"Simulated by MuJoCo along {count} recorded motion{'s' if count > 1 else ''}, the twin needs the measured "
        f"currents but for {in_percent(twin)}; the model from which it was exported, but for {in_percent(model)}."
    )
    return (said, *shortcomings(result))


def shortcomings(result: Replay) -> tuple[str, ...]:
    """What the twin leaves out, and loops that open."""
    found = [
        f"Not simulated, so that its part of the current is missing: {name}." for name in result.left_out
    ]
    if result.opened > OPEN:
        found.append(
            f"Loops open by up to {1e3 * result.opened:.2g} mm or mrad: solref and solimp of the MJCF's equalities are "
            'soft; solref="0.002 1" solimp="0.9999 0.99999 0.001" holds them.'
        )
    return tuple(found)


def replay_report(result: Replay, console: Console | None = None) -> None:
    """Print them, and what the twin leaves out."""
    console = console or Console()
    console.print()
    console.print(Text.assemble((result.twin.robot, "bold"), "  ", (f"twin of {result.twin.model}", "dim")))
    console.print()
    console.print("Error of the twin's current, RMS(error) / RMS(measured)", style="bold")
    console.print(printed(replay_table(result), console.width))
    for sentence in shortcomings(result):
        console.print(sentence, style="yellow")
    console.print()
