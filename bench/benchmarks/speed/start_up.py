"""Time from the start of a command until it has imported what it needs and reports a missing dataset, and until the
first words of its progress on a terminal.

The first start compiles the modules, as for an installed command, regardless of bytecode settings in the environment.
"""

import os
import pty
import select
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path
from time import perf_counter

from bench.basics.errors import BenchError
from bench.benchmarks.speed.figures import SpeedFigure
from bench.benchmarks.speed.long_log import write_long_dataset
from bench.benchmarks.speed.one_command import keeping_bytecode

COMMANDS = ("identify", "diagnose")
LIMIT = 0.7  # s
REPEATS = 5
REFUSED = 2  # exit code of a user's mistake
SILENT = 1.0  # s, limit of the time until the first words
RUNS = 3
PATIENCE = 60.0  # s
WORDS = "starting"
SECONDS = 10.0  # of the recordings that the commands read
EFFECTS = ("coulomb_friction", "viscous_friction")


def start_up_figures() -> list[SpeedFigure]:
    """Time until a command reads its dataset, and until the first words of each long-running command."""
    starts = [SpeedFigure(f"start of bench {command}", measure(command), "s", LIMIT) for command in COMMANDS]
    return [*starts, *first_words_figures()]


def measure(command: str) -> float:
    """Seconds until a missing dataset is reported; the shortest of several, as other processes only slow it down."""
    with tempfile.TemporaryDirectory(prefix="bench-speed-") as folder:
        arguments = [sys.executable, "-m", "bench", command, str(Path(folder) / "nothing")]
        environment = keeping_bytecode()
        environment["PYTHONPYCACHEPREFIX"] = str(Path(folder) / "bytecode")
        return min(_once(arguments, environment) for _ in range(REPEATS))


def _once(arguments: list[str], environment: dict[str, str]) -> float:
    start = perf_counter()
    done = subprocess.run(arguments, capture_output=True, text=True, check=False, env=environment)
    seconds = perf_counter() - start
    if done.returncode != REFUSED:
        raise BenchError(f"{' '.join(arguments)}: not refused: {done.stderr.strip()}")
    return seconds


def first_words_figures() -> list[SpeedFigure]:
    """The time of each long-running command until its first words on a terminal; the shortest of several."""
    figures = []
    with tempfile.TemporaryDirectory(prefix="bench-speed-") as name:
        folder = Path(name)
        data = str(write_long_dataset(folder / "data", SECONDS))
        out = str(folder / "out")
        for words in (
            ("simulate", "five_bar", "-o", out),
            ("diagnose", data),
            ("report", data, "-o", f"{out}.html"),
            ("trial", "five_bar", "--kinds", "nothing", "--seeds", "1", "-o", out),
            ("discriminate", data, *EFFECTS, "-o", out),
        ):
            seconds = min(until_words(words) for _ in range(RUNS))
            figures.append(SpeedFigure(f"bench {words[0]} until its first words", seconds, "s", SILENT))
    return figures


def until_words(arguments: Sequence[str]) -> float:
    """Seconds from the start of a command to its first words on a terminal, after which it is ended.

    Raises BenchError if it reports no progress.
    """
    ours, theirs = pty.openpty()
    start, text = perf_counter(), ""
    command = [sys.executable, "-m", "bench", *arguments]
    with subprocess.Popen(
        command, stderr=theirs, stdout=subprocess.DEVNULL, env={**os.environ, "TERM": "xterm"}
    ) as process:
        os.close(theirs)
        while WORDS not in text:
            heard = _read(ours) if select.select([ours], [], [], PATIENCE)[0] else ""
            if not heard:
                break
            text += heard
        seconds = perf_counter() - start
        process.terminate()
    os.close(ours)
    if WORDS not in text:
        raise BenchError(f"bench {' '.join(arguments)}: says nothing of its progress: {text.strip()}")
    return seconds


def _read(terminal: int) -> str:
    """The text written to a terminal; "" if the command has ended."""
    try:
        return os.read(terminal, 65536).decode(errors="replace")
    except OSError:
        return ""
