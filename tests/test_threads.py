"""A fit keeps BLAS to one thread, and leaves the caller's setting as it was."""

import importlib
from unittest.mock import MagicMock

import numpy as np
import pytest
from threadpoolctl import threadpool_info, threadpool_limits

from bench.basics.threads import on_one_thread


def threads():
    return [one["num_threads"] for one in threadpool_info() if one["user_api"] == "blas"]


def test_one_thread_within_and_the_callers_setting_after():
    with threadpool_limits(limits=2, user_api="blas"):
        before = threads()
        assert on_one_thread(threads)() == [1] * len(before)
        assert threads() == before


def test_an_error_gives_the_setting_back():
    @on_one_thread
    def fails():
        raise ValueError("no")

    before = threads()
    with pytest.raises(ValueError, match="no"):
        fails()
    assert threads() == before


@pytest.mark.parametrize(("name", "inside"), [("prepare", "BenchError"), ("identify", "within_bounds")])
def test_the_library_fits_on_one_thread(name, inside, monkeypatch):
    module = importlib.import_module(f"bench.identification.{name}")

    seen = []

    def noted(*_args, **_kwargs):
        seen.append(threads())
        raise KeyboardInterrupt

    monkeypatch.setattr(module, inside, noted)
    with threadpool_limits(limits=2, user_api="blas"), pytest.raises(KeyboardInterrupt):
        getattr(module, name)(MagicMock())
    assert seen
    assert np.all(np.array(seen) == 1)
