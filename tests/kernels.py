"""The numeric tests under each of the kernels among which OpenBLAS picks by processor: `make test-kernels`."""

import os
import re
import subprocess
import sys

import click

KERNELS = ("Haswell", "Zen", "SkylakeX", "Sandybridge", "Prescott")
CHOICE = "OPENBLAS_CORETYPE"
# Tests of words, files, commands, pictures, of what MuJoCo alone computes, and of what runs the same arithmetic once
# more from outside: the whole trial, notebooks, measured machines. A new file counts as numeric.
OTHERS = (
    *("api", "bad_input", "cli*", "compare_show", "dataset", "docs*", "document", "effects_user_file"),
    *(
        "estimators_study",
        "export_f*",
        "files",
        "import*",
        "kernels",
        "logs_*",
        "measured*",
        "names",
        "next_step",
    ),
    *("notebooks", "open_*", "project", "public", "readme", "recording_*", "replay", "report*", "robot_mjcf"),
    *("robot_toml", "scenario*", "show_*", "side_by_side", "speed*", "sweep_*", "trajectory", "trial_*"),
    *("truth_hidden_*", "truth_machine", "truth_sensors", "truth_simulation", "tutorial", "wheel"),
    "workbench_browser",
)
PROBE = "import numpy, scipy.linalg; numpy.linalg.qr(numpy.eye(64)); scipy.linalg.qr(numpy.eye(64))"


def running(kernel: str) -> str | None:
    """What OpenBLAS runs where this kernel is asked for: its name, or None where the processor cannot."""
    asked = os.environ | {CHOICE: kernel, "OPENBLAS_VERBOSE": "2"}
    answer = subprocess.run(
        [sys.executable, "-c", PROBE], env=asked, capture_output=True, text=True, check=False
    )
    names = set(re.findall(r"^Core: (\w+)$", answer.stderr + answer.stdout, flags=re.MULTILINE))
    return " and ".join(sorted(names)) if answer.returncode == 0 and names else None


def plan(found: dict[str, str | None]) -> tuple[dict[str, str], list[str]]:
    """For each kernel to run, what it runs as; and a sentence for each that is left out."""
    chosen: dict[str, str] = {}
    said = []
    for kernel, name in found.items():
        same = next((one for one, other in chosen.items() if other == name), None)
        if name is None:
            said.append(f"{kernel}: this processor cannot run it, or numpy has no OpenBLAS")
        elif same:
            said.append(f"{kernel}: runs as {name} here, as {same} does")
        else:
            chosen[kernel] = name
    return chosen, said


def main() -> int:
    """Run them; the exit code is 1 where a test fails under some kernel."""
    if CHOICE in os.environ:
        click.echo(f"{CHOICE} is {os.environ[CHOICE]!r} already: no other kernel is tried")
        return 0
    chosen, said = plan({kernel: running(kernel) for kernel in KERNELS})
    for one in said:
        click.echo(one)
    failed = []
    for kernel, name in chosen.items():
        click.echo(f"{kernel} (runs as {name}):")
        ignored = [f"--ignore-glob=*/test_{one}.py" for one in OTHERS]
        workers = ["--numprocesses", "2", "--dist", "worksteal"]
        command = [sys.executable, "-m", "pytest", "--quiet", *workers, *ignored]
        if subprocess.run(command, env=os.environ | {CHOICE: kernel}, check=False).returncode:
            failed.append(kernel)
    click.echo(f"failed under: {', '.join(failed)}" if failed else f"passed under: {', '.join(chosen)}")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
