"""`make peers`: time and error of each solver on the same problems, side by side."""

import json
import os
import sys
import warnings
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import partial
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np
from rich import box
from rich.table import Table

from bench.basics.chi_squared import WITHIN_95
from bench.basics.files.atomic import write_json_atomically, write_text_atomically
from bench.basics.versions import versions
from bench.benchmarks.peers.parabench import (
    Answer,
    solve_all_unknown,
    solve_mass_known,
    solve_output_error,
    solve_two_masses,
)
from bench.benchmarks.peers.problems import COULOMB_SHARE, DURATION, PeerProblem, make_problem
from bench.studies.sweep.summary import table_console

warnings.filterwarnings("ignore", category=RuntimeWarning, message=".*already registered.*")
RESULT = Path("results/peers")
MANY, FEW, ONE = 40, 3, 1  # seeds of fast solvers, of slow ones, and of the slowest
EXPLANATION = (
    "Medians over seeds of sensor noise: 20-bit encoders and 1 % noise of the currents. `parabench` knows"
    " the geometry and the payload; `rest from CAD` takes all masses except two as known, as does"
    " `mujoco.sysid`, which also receives the initial state and the controller. mujoco.sysid does not use"
    " the currents: it predicts the positions by simulating the controlled machine. `output error` also knows the"
    " control law and references, but no mass except the payload's. At the time step of the truth its model is"
    " the simulator that generated the data; 1 ms is the step of the log. FIGAROH has no closed loops."
    " Seconds are processor time of all threads, from recordings to estimates: building the robot's"
    " model once beforehand"
    " is not timed, and neither is the set-up of the others (MuJoCo specs, sequences and residual function of"
    " mujoco.sysid, URDF of FIGAROH)."
)
HEADERS = ("solver", "seeds", "seconds", "gain error", "gains within", "mass error", "masses within")


@dataclass(frozen=True)
class Score:
    """One solver on one problem: medians over the seeds of time and largest relative errors, and coverage of 95 %
    intervals.
    """

    robot: str
    friction: bool
    solver: str
    seeds: int
    seconds: float
    gain_error: float
    gain_within: float | None
    mass_error: float | None
    mass_within: float | None


Solver = Callable[[PeerProblem], Answer]


def score(robot: str, *, friction: bool, solve: Solver, seeds: int) -> Score:
    """Solve a problem for several seeds of the noise. With `MANY`, the first is solved once before, to warm up."""
    problems = [make_problem(robot, seed, friction=friction) for seed in range(1, seeds + 1)]
    if seeds >= MANY:
        solve(problems[0])
    pairs = [(problem, solve(problem)) for problem in problems]
    gain_errors = [np.abs(answer.gains / problem.gains - 1.0).max() for problem, answer in pairs]
    mass_errors = [np.abs(a.masses / p.masses - 1.0).max() for p, a in pairs if a.masses is not None]
    return Score(
        robot,
        friction,
        pairs[0][1].solver,
        seeds,
        float(np.median([answer.seconds for _, answer in pairs])),
        float(np.median(gain_errors)),
        _within([(p.gains, a.gains, a.gain_stds) for p, a in pairs]),
        float(np.median(mass_errors)) if mass_errors else None,
        _within([(p.masses, a.masses, a.mass_stds) for p, a in pairs]),
    )


def _within(triples: Iterable[tuple[np.ndarray, np.ndarray | None, np.ndarray | None]]) -> float | None:
    held = [
        np.abs(value - truth) <= WITHIN_95 * std
        for truth, value, std in triples
        if value is not None and std is not None
    ]
    return float(np.mean(held)) if held else None


def five_bar_scores(*, friction: bool) -> list[Score]:
    """Scores of mujoco.sysid and this program; FIGAROH has no closed loops."""
    from bench.benchmarks.peers import mujoco_sysid  # noqa: PLC0415 - slow to import

    def others(step: float) -> Solver:
        return lambda problem: mujoco_sysid.solve(problem, step)

    known = ((), ("coulomb_friction",)) if friction else ((),)
    ours: list[Solver] = [lambda problem: solve_all_unknown(problem)[0]]
    ours += [
        partial(solve, effects=names) for names in known for solve in (solve_two_masses, solve_output_error)
    ]
    slow = [(others(1e-3), FEW), (others(2.5e-4), ONE if friction else FEW)]
    solvers = [*((solve, MANY) for solve in ours), *slow]
    return [score("five_bar", friction=friction, solve=solve, seeds=seeds) for solve, seeds in solvers]


def arm_scores(*, friction: bool) -> list[Score]:
    """Scores of FIGAROH and this program, both with only the payload's mass known, and of this program with the whole
    payload known.
    """
    from bench.benchmarks.peers import figaroh_arm  # noqa: PLC0415 - slow to import

    settings = solve_all_unknown(make_problem("two_link", 1, friction=friction))[1].settings

    def others(problem: PeerProblem) -> Answer:
        return figaroh_arm.solve(problem, settings.position_cutoff, settings.decimation)

    ours: list[Solver] = [solve_mass_known, lambda problem: solve_all_unknown(problem)[0]]
    if friction:
        ours.append(lambda problem: solve_all_unknown(problem, ("coulomb_friction",))[0])
    return [score("two_link", friction=friction, solve=solve, seeds=MANY) for solve in (*ours, others)]


def title(scored: Score) -> str:
    """The problem as a title."""
    robot = {"five_bar": "Five-bar", "two_link": "Serial arm of two links"}[scored.robot]
    friction = (
        f"Coulomb friction of {100.0 * COULOMB_SHARE:.0f} % of the torque"
        if scored.friction
        else "no friction"
    )
    return f"{robot}, two recordings of {DURATION:g} s at 1 kHz, {friction}"


def cells(scored: Score) -> list[str]:
    """One row of the table."""
    shares = (scored.gain_error, scored.gain_within, scored.mass_error, scored.mass_within)
    return [
        scored.solver,
        str(scored.seeds),
        f"{scored.seconds:.3g}",
        *("–" if x is None else f"{100 * x:.3g} %" for x in shares),
    ]


def scores_table(scores: Sequence[Score]) -> Table:
    """A row for each solver of one problem; in a narrow terminal names wrap, numbers do not."""
    table = Table(box=box.SIMPLE_HEAD, title=title(scores[0]), title_justify="left", pad_edge=False)
    table.add_column(HEADERS[0], overflow="fold")
    for header in HEADERS[1:]:
        table.add_column(header.replace(" ", "\n"), justify="right", vertical="bottom", no_wrap=True)
    for scored in scores:
        table.add_row(*cells(scored))
    return table


def main() -> int:
    """Run all solvers, print the tables, and write them."""
    os.environ.setdefault("MUJOCO_GL", "disable")
    console = table_console()
    scores: list[Score] = []
    text = ["# Beside others", "", EXPLANATION, ""]
    for solve in (five_bar_scores, arm_scores):
        for friction in (False, True):
            new_scores = solve(friction=friction)
            scores += new_scores
            console.print(scores_table(new_scores))
            text += [f"## {title(new_scores[0])}", "", "| " + " | ".join(HEADERS) + " |"]
            text += ["|---" + "|---:" * (len(HEADERS) - 1) + "|"]
            text += ["| " + " | ".join(cells(scored)) + " |" for scored in new_scores] + [""]
    content: dict[str, Any] = {
        "scores": [vars(scored) for scored in scores],
        "figaroh": version("figaroh"),
        **versions().columns(),
    }
    write_json_atomically(RESULT / "peers.json", json.loads(json.dumps(content)))
    write_text_atomically(RESULT / "peers.md", "\n".join(text))
    return 0


if __name__ == "__main__":
    sys.exit(main())
