"""The process that works for `bench open`: it answers, is cancelled, ends and says why."""

import sys
from pathlib import Path

import pytest

from bench.basics.errors import BenchError
from bench.basics.progress import SILENT
from bench.local.worker import CancelledError, DiedError, Worker


class Heard:
    """Progress that calls somebody."""

    def __init__(self, called):
        self.called = called
        self.said = []

    def phase(self, name, total=None):
        self.said.append((name, total))
        self.called()

    def advance(self, steps=1):
        self.said.append(steps)


def test_a_worker_answers_refuses_dies_and_is_cancelled():
    worker = Worker(
        {name: f"tests.worker_kit:{name}" for name in ("double", "refuse", "die", "kill", "wait")}
    )
    heard = Heard(lambda: None)
    assert worker.call("double", {"number": 21}, heard) == 42
    assert heard.said == [("doubling", 2), 1]
    with pytest.raises(BenchError, match="3: is odd"):
        worker.call("refuse", {"number": 3}, SILENT)
    with pytest.raises(DiedError, match="its process ended with exit code 3"):
        worker.call("die", {}, SILENT)
    with pytest.raises(DiedError, match="was ended by SIGKILL, as when memory runs out"):
        worker.call("kill", {}, SILENT)
    with pytest.raises(DiedError, match="a fault of the program, KeyError: 'number'"):
        worker.call("double", {}, SILENT)
    with pytest.raises(CancelledError):
        worker.call("wait", {}, Heard(worker.cancel))
    assert worker.call("double", {"number": 1}, SILENT) == 2
    worker.close()
    with pytest.raises(CancelledError):
        worker.call("double", {"number": 1}, SILENT)


def test_a_worker_that_cannot_start_says_why(monkeypatch):
    worker = Worker({"double": "tests.worker_kit:double"})
    elsewhere = [path for path in sys.path if not (Path(path) / "bench").is_dir()]
    monkeypatch.setattr(sys, "path", elsewhere)  # the program is not where it was
    with pytest.raises(
        DiedError, match="its process cannot start: ModuleNotFoundError: No module named 'bench'"
    ):
        worker.call("double", {"number": 1}, SILENT)
    worker.close()
