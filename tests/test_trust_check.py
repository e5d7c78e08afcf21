"""`bench check`: cases of the frozen set that were right are run again."""

from functools import partial
from itertools import count
from pathlib import Path

import pytest

from bench.benchmarks.trust.cells import TrustCells
from bench.benchmarks.trust.evaluation import Evaluation, read_evaluation
from bench.benchmarks.trust.kept_cases import cheapest_right, is_right, run_again
from bench.benchmarks.trust.overview import cost_of
from bench.benchmarks.trust.questions import QUESTIONS
from bench.benchmarks.trust.run import TrustRequest, run_trust, setups_of
from bench.benchmarks.trust.words import answer_text
from bench.benchmarks.trust.work import FROZEN
from tests.sweep_stand_in import Inline
from tests.trust_stand_in import SECONDS, TrustStandIn

FIRST = 5000


class AlwaysWrong(TrustStandIn):
    """Names cogging whatever is hidden."""

    def row(self, case):
        named = {"missing": "cogging_torque", "wrong": "cogging_torque", "first": False, "exact": False}
        return (
            super().row(case) | named | {"verdicts": '[{"effect": "cogging_torque", "verdict": "missing"}]'}
        )


@pytest.fixture(scope="module")
def evaluation(tmp_path_factory: pytest.TempPathFactory) -> Evaluation:
    cells = TrustCells(setups_of(["two_link", "five_bar"]), FIRST)
    request = TrustRequest(cells.setups, "0.0, entry 5", FIRST, 1e6)
    folder: Path = tmp_path_factory.mktemp("whole")
    silent = lambda _tally, _budget: lambda _journal: None  # noqa: E731
    return read_evaluation(
        run_trust(request, folder, Inline, silent, work=TrustStandIn(cells), now=partial(next, count()))
    )


def test_right_cases_of_the_frozen_set_are_chosen_for_the_time_that_there_is(evaluation: Evaluation) -> None:
    chosen = cheapest_right(evaluation, 1e6)
    assert {row["robot"] for row in chosen} == {"two_link", "five_bar"}
    assert all(row["set"] == FROZEN and not QUESTIONS[row["question"]].wrong(row) for row in chosen)
    names = [(row["robot"], row["question"]) for row in chosen]
    assert len(set(names)) == len(names) >= len(QUESTIONS)
    few = cheapest_right(evaluation, 3.5 * SECONDS)
    assert few == chosen[:3]
    assert sum(map(cost_of, few)) <= 3.5 * SECONDS


def test_a_case_that_was_right_and_is_wrong_now_is_noticed(evaluation: Evaluation) -> None:
    chosen = cheapest_right(evaluation, 1e6)
    as_before = run_again(chosen, FIRST, Inline(), TrustStandIn)
    assert list(as_before) == [
        "/".join((row["robot"], row["question"], str(row["number"]))) for row in chosen
    ]
    assert all(map(is_right, as_before.values()))
    now = run_again(chosen, FIRST, Inline(), AlwaysWrong)
    assert not any(map(is_right, now.values()))
    assert all(answer_text(row).startswith("cogging torque") for row in now.values())
