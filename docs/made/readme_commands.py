"""The README's five commands in an empty folder: `python docs/made/readme_commands.py -o results/excite`.

A motion is planned for a Delta, a simulated machine makes it, its model is identified, exported, and simulated along
what was recorded. What the README quotes of that is held to what they gave.
"""

import json
import os
import re
import shlex
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import click

from bench.basics.errors import BenchError
from bench.basics.files.atomic import write_json_atomically
from bench.basics.versions import versions

README = Path(__file__).resolve().parents[2] / "README.md"
FIRST = "bench excite delta "
FILE = "readme_commands.json"
REPLAY = "replay.json"


def commands_of(text: str) -> tuple[str, ...]:
    """The commands of the fenced block of a page that starts with FIRST, as they stand there."""
    for block in re.findall(r"```sh\n(.*?)```", text, flags=re.DOTALL):
        if block.startswith(FIRST):
            return tuple(block.replace("\\\n", " ").splitlines())
    raise BenchError(f"no block of commands starts with {FIRST!r}")


def run(commands: Sequence[str], folder: Path) -> dict[str, Any]:
    """Run the commands in a folder, each as a separate process, and return their results.

    Relative errors: of the gains, expected and found; of the currents, of twin and model. Raises BenchError for one
    that fails.
    """
    environment = {**os.environ, "PYTHONPATH": str(README.parent)}
    for command in commands:
        words = shlex.split(command)[1:]
        if words[0] == "replay":
            words += ["--json", REPLAY]
        done = subprocess.run(
            [sys.executable, "-m", "bench", *words],
            cwd=folder,
            env=environment,
            capture_output=True,
            text=True,
            check=False,
        )
        if done.returncode:
            raise BenchError(f"{command}: {done.stderr.strip()}")
        click.echo(f"$ {command}\n{done.stdout}")
    (plan,), (model,) = folder.glob("results/*/plan/answer.json"), folder.glob("results/*/model.json")
    answer, identified = (json.loads(path.read_text(encoding="utf-8")) for path in (plan, model))
    replayed = json.loads((folder / REPLAY).read_text(encoding="utf-8"))
    expected = {entry["name"]: entry["std"] / entry["relative_to"] for entry in answer["unknowns"]}
    return {
        "commands": list(commands),
        "gains": {
            joint: {"expected": expected[joint], "found": gain["std"] / gain["value"]}
            for joint, gain in identified["drive_gains"].items()
        },
        "better": answer["random"]["median"] / answer["value"],
        "off": replayed["of_all_recordings"],
    }


@click.command()
@click.option("-o", "--output", type=click.Path(path_type=Path), required=True, help="Folder of the figures.")
def main(output: Path) -> None:
    """Write the figures as JSON."""
    with TemporaryDirectory() as folder:
        figures = run(commands_of(README.read_text(encoding="utf-8")), Path(folder))
    write_json_atomically(output / FILE, figures | versions().columns())


if __name__ == "__main__":
    main()
