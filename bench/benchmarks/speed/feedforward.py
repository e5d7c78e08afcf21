"""Cost of one call of a feed-forward: `python -m bench.benchmarks.speed.feedforward MODEL.json`."""

import ctypes
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import click
import numpy as np
import pinocchio as pin

from bench.basics.errors import BenchError
from bench.export.c_code import c_name, c_text
from bench.export.feedforward import Feedforward
from bench.export.identified import IdentifiedModel, load_identified
from bench.model.follow import build_tree
from bench.model.geometry import Geometry
from bench.model.motion import motion_of

SAMPLES, PERIOD, SWING = 1000, 1.0, 0.1  # of a motion at 1 kHz about home: s, and rad, or 0.3 of it in m
OPEN_LOOP = """
void many(long count, const double *x, double *current);
void many(long count, const double *x, double *current)
{
    for (long i = 0; i < count; i++)
        NAME_currents(x + i % SAMPLES * 3 * M, x + i % SAMPLES * 3 * M + M, x + i % SAMPLES * 3 * M + 2 * M, current);
}
"""
CLOSED_LOOP = """
int many(long count, const double *x, double *current);
int many(long count, const double *x, double *current)
{
    NAME_state state;
    int failed = NAME_start(&state);
    for (long i = 0; i < count; i++) {
        const double *now = x + i % SAMPLES * 3 * M;
        failed |= NAME_currents(&state, now, now + M, now + 2 * M, current);
    }
    return failed;
}
"""


def seconds_per_call(model: IdentifiedModel, calls: int = 200_000) -> dict[str, float]:
    """Processor time, s, of one call of the C code, of Pinocchio's rnea on the same tree from Python, and of the Python
    code, by name.

    Along a motion at 1 kHz about home. With closed loops, rnea receives the motion of all joints, as it does not close
    the loops. Raises BenchError without a C compiler, and if the motion leaves the robot's reach.
    """
    geometry = model.model.geometry
    states = _motion(geometry)
    whole = motion_of(geometry, PERIOD * np.arange(SAMPLES) / SAMPLES, *states.transpose(1, 0, 2))
    tree = build_tree(geometry)
    data = tree.createData()
    forward = Feedforward(model)
    with tempfile.TemporaryDirectory() as folder:
        many = _compiled(model, Path(folder))
        out = np.empty(len(geometry.active))
        pointers = [values.ctypes.data_as(ctypes.POINTER(ctypes.c_double)) for values in (states, out)]
        in_c = _timed(lambda: many(ctypes.c_long(calls), *pointers)) / calls
        if geometry.closed and many(ctypes.c_long(SAMPLES), *pointers):
            raise BenchError(f"robot {geometry.robot.name}: the motion about home cannot be followed")
    few = max(calls // 10, 1)
    every = [(whole.q[k], whole.v[k], whole.a[k]) for k in range(SAMPLES)]
    rnea = _timed(lambda: [pin.rnea(tree, data, *every[k % SAMPLES]) for k in range(few)]) / few
    fewer = max(calls // 1000, 1)
    python = _timed(lambda: [forward(*states[k % SAMPLES]) for k in range(fewer)]) / fewer
    return {"C": in_c, "pinocchio.rnea from Python": rnea, "Python": python}


def _motion(geometry: Geometry) -> np.ndarray:
    """Positions as logged, velocities and accelerations (SAMPLES, 3, n) of a periodic motion about home."""
    slides = np.array([joint.v.start for joint in geometry.joints if joint.kind == "slide"])
    home = geometry.home[geometry.active_configuration] + geometry.active_offset
    size = SWING * np.where(np.isin(geometry.active, slides), 0.3, 1.0)
    rate = 2.0 * np.pi / PERIOD
    angle = rate * PERIOD * np.arange(SAMPLES)[:, None] / SAMPLES + np.arange(len(home))
    rates = [size * rate * np.cos(angle), -size * rate**2 * np.sin(angle)]
    return np.ascontiguousarray(np.stack([home + size * np.sin(angle), *rates], axis=1))


def _timed(work: Callable[[], object]) -> float:
    work()  # once to warm up
    start = time.process_time()
    work()
    return time.process_time() - start


def _compiled(model: IdentifiedModel, folder: Path) -> Callable[..., int]:
    compiler = shutil.which("cc")
    if compiler is None:
        raise BenchError("no C compiler: there is no program cc")
    loop = CLOSED_LOOP if model.model.geometry.closed else OPEN_LOOP
    loop = loop.replace("NAME", c_name(model.robot.name)).replace("SAMPLES", str(SAMPLES))
    (folder / "code.c").write_text(c_text(model)[0] + loop, encoding="utf-8")
    library = str(folder / "code.so")
    options = ["-std=c99", "-O2", "-shared", "-fPIC", "-o", library, str(folder / "code.c"), "-lm"]
    done = subprocess.run([compiler, *options], capture_output=True, text=True, check=False)
    if done.returncode:
        raise BenchError(f"cc: {done.stderr.strip().splitlines()[0]}")
    many: Callable[..., int] = ctypes.CDLL(library).many
    return many


@click.command()
@click.argument("model", metavar="MODEL.json")
def main(model: str) -> None:
    """Print the times in microseconds; exit code 2 after an error."""
    try:
        timings = seconds_per_call(load_identified(model))
    except BenchError as error:
        click.echo(error, err=True)
        sys.exit(2)
    for name, seconds in timings.items():
        click.echo(f"{name}: {1e6 * seconds:.2f} µs a call")


if __name__ == "__main__":
    main()
