"""Start-up time of a command: until it has imported what it needs and reports a missing dataset.

The first start compiles the modules, as for an installed command, regardless of bytecode settings in the environment.
"""

import os
import subprocess
import sys
import tempfile
from pathlib import Path
from time import perf_counter

from bench.basics.errors import BenchError
from bench.benchmarks.speed.figures import SpeedFigure

COMMANDS = ("identify", "diagnose")
LIMIT = 0.7  # s
REPEATS = 5
REFUSED = 2  # exit code of a user's mistake


def start_up_figures() -> list[SpeedFigure]:
    """Time from the start of a command until it reads its dataset."""
    return [SpeedFigure(f"start of bench {command}", measure(command), "s", LIMIT) for command in COMMANDS]


def measure(command: str) -> float:
    """Seconds; the shortest of several, since other processes only slow it down."""
    with tempfile.TemporaryDirectory(prefix="bench-speed-") as folder:
        arguments = [sys.executable, "-m", "bench", command, str(Path(folder) / "nothing")]
        environment = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
        environment["PYTHONPYCACHEPREFIX"] = str(Path(folder) / "bytecode")
        return min(_once(arguments, environment) for _ in range(REPEATS))


def _once(arguments: list[str], environment: dict[str, str]) -> float:
    start = perf_counter()
    done = subprocess.run(arguments, capture_output=True, text=True, check=False, env=environment)
    seconds = perf_counter() - start
    if done.returncode != REFUSED:
        raise BenchError(f"{' '.join(arguments)}: not refused: {done.stderr.strip()}")
    return seconds
