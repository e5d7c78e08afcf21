"""Generated C, compiled strictly, as Python functions."""

import ctypes
import shutil
import subprocess

import numpy as np
import pytest

DOUBLES = ctypes.POINTER(ctypes.c_double)


def library(text, folder, flags=("-O2",)):
    """The compiled source; skips without a compiler."""
    compiler = shutil.which("cc")
    if compiler is None:
        pytest.skip("no C compiler on this machine")
    (folder / "code.c").write_text(text)
    strict = ["-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Werror", *flags]
    command = [
        compiler,
        *strict,
        "-shared",
        "-fPIC",
        "-o",
        str(folder / "code.so"),
        str(folder / "code.c"),
        "-lm",
    ]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return ctypes.CDLL(str(folder / "code.so"))


def pointers(*arrays):
    return [array.ctypes.data_as(DOUBLES) for array in arrays]


def compiled(text, name, folder):
    """The function of a robot without loops."""
    function = getattr(library(text, folder), f"{name}_currents")
    function.restype = None

    def currents(q, v, a):
        out = np.empty(len(q))
        states = [np.ascontiguousarray(state) for state in (q, v, a)]
        function(*pointers(*states, out))
        return out

    return currents


class Closed:
    """The functions of a robot with loops, with a state of its own: as many numbers as `sizes` gives."""

    def __init__(self, library, name, sizes):
        self._start, self._currents = getattr(library, f"{name}_start"), getattr(library, f"{name}_currents")
        self.state = np.full(sizes + 1, 7.25)  # the last one is nobody's
        self.started = self._start(*pointers(self.state))

    def __call__(self, q, v, a):
        """What is returned, and the currents: NaN where they were left alone."""
        out = np.full(len(q), np.nan)
        states = [np.ascontiguousarray(state) for state in (q, v, a)]
        code = self._currents(*pointers(self.state, *states, out))
        assert self.state[-1] == 7.25
        return code, out
