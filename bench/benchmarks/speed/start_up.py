"""How long a command takes to start: to import what it needs and to find that there is no dataset.

Its modules are compiled by the first start, as an installed command's are, whatever the environment says of bytecode.
"""

import os
import subprocess
import sys
import tempfile
from pathlib import Path
from time import perf_counter

from bench.basics.errors import BenchError

COMMANDS = ("identify", "diagnose")
LIMIT = 0.7  # s
REPEATS = 5
REFUSED = 2  # the exit code of a mistake in what the user gave


def measure(command: str, repeats: int = REPEATS) -> float:
    """Seconds, the shortest of some: what else the machine does only makes it longer."""
    with tempfile.TemporaryDirectory(prefix="bench-speed-") as folder:
        arguments = [sys.executable, "-m", "bench", command, str(Path(folder) / "nothing")]
        environment = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
        environment["PYTHONPYCACHEPREFIX"] = str(Path(folder) / "bytecode")
        return min(_once(arguments, environment) for _ in range(repeats))


def _once(arguments: list[str], environment: dict[str, str]) -> float:
    start = perf_counter()
    done = subprocess.run(arguments, capture_output=True, text=True, check=False, env=environment)
    seconds = perf_counter() - start
    if done.returncode != REFUSED:
        raise BenchError(f"{' '.join(arguments)}: not refused: {done.stderr.strip()}")
    return seconds
