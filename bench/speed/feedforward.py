"""What one call of a feed-forward costs: `python -m bench.speed.feedforward MODEL.json`."""

import ctypes
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pinocchio as pin

from bench.basics.errors import BenchError
from bench.export.c_code import c_text
from bench.export.feedforward import Feedforward
from bench.export.identified import IdentifiedModel, load_identified
from bench.model.tree import build_tree

LOOP = """
void many(long count, const double *q, const double *v, const double *a, double *current);
void many(long count, const double *q, const double *v, const double *a, double *current)
{
    for (long i = 0; i < count; i++)
        %s_currents(q + i %% 2, v, a, current);
}
"""


def seconds_per_call(model: IdentifiedModel, calls: int = 200_000) -> dict[str, float]:
    """Processor time in s of one call of C, of Pinocchio's rnea on the same tree, from Python, and of Python.

    Raises BenchError for a robot with loops, and without a C compiler.
    """
    n = len(model.robot.joints)
    tree = build_tree(model.model.geometry)
    data = tree.createData()
    state = np.random.default_rng(1).uniform(-0.5, 0.5, (3, n))
    forward = Feedforward(model)
    with tempfile.TemporaryDirectory() as folder:
        many = _compiled(model, Path(folder))
        padded = np.append(state[0], 0.0)
        out = np.empty(n)
        arrays = [np.ascontiguousarray(values) for values in (padded, state[1], state[2], out)]
        pointers = [array.ctypes.data_as(ctypes.POINTER(ctypes.c_double)) for array in arrays]
        in_c = _timed(lambda: many(ctypes.c_long(calls), *pointers)) / calls
    few = max(calls // 10, 1)
    rnea = _timed(lambda: [pin.rnea(tree, data, *state) for _ in range(few)]) / few
    fewer = max(calls // 1000, 1)
    python = _timed(lambda: [forward(*state) for _ in range(fewer)]) / fewer
    return {"C": in_c, "pinocchio.rnea from Python": rnea, "Python": python}


def _timed(work: Callable[[], object]) -> float:
    work()  # once to warm up
    start = time.process_time()
    work()
    return time.process_time() - start


def _compiled(model: IdentifiedModel, folder: Path) -> Callable[..., None]:
    compiler = shutil.which("cc")
    if compiler is None:
        raise BenchError("no C compiler: there is no program cc")
    text, _ = c_text(model)
    name = text[: text.index("_currents(")].rsplit(" ", 1)[-1]
    (folder / "code.c").write_text(text + LOOP % name, encoding="utf-8")
    library = folder / "code.so"
    command = [
        compiler,
        "-std=c99",
        "-O2",
        "-shared",
        "-fPIC",
        "-o",
        str(library),
        str(folder / "code.c"),
        "-lm",
    ]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        raise BenchError(f"cc: {done.stderr.strip().splitlines()[0]}")
    many = ctypes.CDLL(str(library)).many
    many.restype = None
    return many


def main() -> int:
    """Print them in microseconds."""
    if len(sys.argv) != 2:
        sys.stderr.write("python -m bench.speed.feedforward MODEL.json\n")
        return 2
    try:
        found = seconds_per_call(load_identified(sys.argv[1]))
    except BenchError as error:
        sys.stderr.write(f"{error}\n")
        return 2
    for name, seconds in found.items():
        sys.stdout.write(f"{name}: {1e6 * seconds:.2f} µs a call\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
