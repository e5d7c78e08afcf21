"""Cost of a command of bench as a user types it, start-up included.

Run as `python -m bench.benchmarks.speed.one_command COMMAND [ARGUMENT ...]`: the command runs in this process, which
then prints its processor time, s, and its peak memory, bytes.
"""

import json
import os
import runpy
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from time import perf_counter, process_time

from bench.basics.errors import BenchError
from bench.benchmarks.speed.memory import peak_bytes

MARK = "cost: "


@dataclass(frozen=True)
class Cost:
    """Wall and processor time of a command, s, and the peak memory of its process, MB."""

    seconds: float
    processor: float
    megabytes: float


def keeping_bytecode() -> dict[str, str]:
    """The environment, in which Python keeps compiled modules as for an installed command."""
    return {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}


def costs_at_once(commands: Sequence[Sequence[str]]) -> list[Cost]:
    """The cost of commands that are started at the same time. Raises BenchError if one of them fails."""
    environment = keeping_bytecode()
    begun = perf_counter()
    running = [
        subprocess.Popen(
            [sys.executable, "-m", "bench.benchmarks.speed.one_command", *command],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            env=environment,
        )
        for command in commands
    ]
    costs = []
    for command, process in zip(commands, running, strict=True):
        printed, said = process.communicate()
        if process.returncode or MARK not in printed:
            raise BenchError(f"bench {' '.join(command)}: exit code {process.returncode}: {said.strip()}")
        processor, peak = json.loads(printed.rpartition(MARK)[2])
        costs.append(Cost(perf_counter() - begun, processor, peak / 1024.0**2))
    return costs


def cost_of(*command: str) -> Cost:
    """The cost of one command."""
    return costs_at_once([command])[0]


if __name__ == "__main__":
    try:
        runpy.run_module("bench", run_name="__main__", alter_sys=True)
    finally:
        sys.stdout.write(f"{MARK}{json.dumps([process_time(), peak_bytes()])}\n")
