"""A cheap stand-in for the work of an evaluation: rows from random numbers, and a worker that dies on request."""

import json
import os
import signal
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from bench.benchmarks.trust.cells import TrustCells
from bench.benchmarks.trust.work import place_of
from bench.studies.trial.cases import draw_case

SECONDS = 10.0


@dataclass(frozen=True)
class Shortcut:
    """Stands for a design or a motion."""

    value: object

    def __call__(self, _):
        return self.value


@dataclass(frozen=True)
class RowTask:
    """Gives the row of a case; kills its worker once if a mark is asked for."""

    row: dict
    mark: Path | None
    pause: float

    def __call__(self, _):
        time.sleep(self.pause)
        if self.mark is not None and not self.mark.exists():
            self.mark.touch()
            os.kill(os.getpid(), signal.SIGKILL)
        return [self.row]


@dataclass(frozen=True)
class TrustStandIn:
    """The work of an evaluation, without any work."""

    cells: TrustCells
    killed_once: tuple[int, ...] = ()
    marks: Path | None = None
    pause: float = 0.0

    def design(self, run):
        return Shortcut({})

    def motion(self, run, trajectories):
        return Shortcut(run.motion)

    def runs(self, runs, trajectories):
        (run,) = runs
        mark = self.marks / f"{run.number}" if run.number in self.killed_once else None
        return RowTask(self.row(self.cells.case_of_row(run.number)), mark, self.pause)

    def failed(self, run, reason):
        raise AssertionError(reason)

    def row(self, case):
        """As a diagnosis of the case gives it: nine of ten are right, the others name cogging."""
        drawn = draw_case(self.cells.setups[case.cell.robot], case.cell.question.kind, case.number)
        random = np.random.default_rng([case.row, 7])
        right = bool(random.random() < 0.9)
        catalogued = [] if drawn.kind in ("outside", "unknown") else list(drawn.effects)
        named = catalogued if right else ["cogging_torque"]
        joint = {"joint": "a", "truth": 1.0, "value": 1.0 + 0.01 * random.standard_normal(), "std": 0.01}
        row = {
            "run": case.row,
            "status": "ok",
            "reason": None,
            "kind": drawn.kind,
            "hidden": " + ".join(drawn.effects),
            "joints": " + ".join("a" for _ in drawn.effects),
            "missing": " + ".join(named),
            "verdicts": json.dumps([{"effect": name, "verdict": "missing"} for name in named]),
            "probabilities": json.dumps(dict.fromkeys(named, 0.97)),
            "gains": json.dumps([joint]),
            "gain_error.before": 0.1,
            "gain_error.after": abs(joint["value"] - 1.0),
            "gain_error.told": 0.01,
            "absorbed": False,
            "least_own_error_over_floor": 5.0,
            "error_over_floor.after": 1.0,
            "first": right,
            "exact": right,
            "wrong": "" if right else "cogging_torque",
            "unexplained": drawn.kind == "outside",
            "laws": int(drawn.kind == "unknown"),
            "seconds": SECONDS,
            "seconds.processor": SECONDS,
            "commit": "0123456",
        }
        if case.again:
            row |= {"sure": row["missing"], "sure.noise": row["missing"], "sure.without_log": ""}
        return row | place_of(case)
