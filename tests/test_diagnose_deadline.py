"""A diagnosis ends at its deadline with the best answer so far, and says what was not looked at."""

import io
import json
from dataclasses import dataclass
from functools import cache
from itertools import count, pairwise

import pytest
from rich.console import Console

from bench.api.diagnose import diagnose
from bench.basics.deadline import NEVER, Deadline, TimeUpError, deadline_in
from bench.basics.errors import BenchError
from bench.cli import main
from bench.diagnosis.as_json import diagnosis_json
from bench.diagnosis.dependence_words import NOT_LOOKED_AT, unfinished_sentence
from bench.diagnosis.discovery.find import find_missing_effects
from bench.diagnosis.result import Unfinished
from bench.document.markdown.tables import diagnosis_markdown
from bench.document.terminal.diagnosis import diagnosis_report
from bench.page.folder import read_run
from tests.discover_kit import FRICTIONS, among, measured

HIDDEN = (
    {"effect": "viscous_friction", "Fv": 0.15},
    {"effect": "cogging_torque", "joint": "left", "a": 0.12, "b": 0.05, "period": 0.35},
)
PARTS = (0.0, 0.05, 0.2, 0.4, 0.6, 0.8, 0.95)
ROUNDING = 1e-9  # relative, of an error that is worked out in another order


@dataclass
class Counting:
    """A clock that goes on by one each time that it is looked at."""

    looked_at: int = 0

    def __call__(self) -> float:
        self.looked_at += 1
        return float(self.looked_at)


@pytest.fixture(scope="module")
def problem():
    return among((*FRICTIONS, "cogging_torque", "torque_ripple"), measured(*HIDDEN))


@pytest.fixture(scope="module")
def whole(problem):
    return find_missing_effects(problem)


@pytest.fixture(scope="module")
def looks(problem, whole):
    """How often a diagnosis that comes to its end looks at the clock; its answer is the same as without one."""
    clock = Counting()
    found = find_missing_effects(problem, deadline=Deadline(1e9, clock))
    assert diagnosis_json(found) == diagnosis_json(whole)
    return clock.looked_at


@pytest.fixture(scope="module")
def after(problem, looks):
    """The answer after a part of all looks at the clock, and how often it was looked at; each part once."""

    @cache
    def answer(part):
        clock = Counting()
        return find_missing_effects(problem, deadline=Deadline(1.0 + part * looks, clock)), clock.looked_at

    return answer


def test_without_a_limit_all_is_looked_at(whole):
    assert set(whole.missing) == {"viscous_friction", "cogging_torque"}
    assert whole.finished
    assert diagnosis_json(whole)["finished"] is True
    assert unfinished_sentence(whole) == ""


@pytest.mark.parametrize("part", PARTS)
def test_at_a_deadline_the_best_answer_so_far_is_given(part, whole, looks, after):
    found, looked_at = after(part)
    assert looked_at < 1.0 + part * looks + 40  # hardly looked at once it has passed
    assert not found.finished
    answer = json.loads(json.dumps(diagnosis_json(found), allow_nan=False))
    assert answer["finished"] is False
    assert answer["not_looked_at"] == list(found.unfinished)
    assert set(found.missing) <= set(whole.missing)
    first, last = found.ladder[0], found.ladder[-1]
    assert last.validate == pytest.approx(found.after.error.validate)
    assert last.validate <= first.validate
    assert whole.ladder[-1].validate <= last.validate * 1.01
    assert all(gain.determined for gain in found.after.drive_gains.values())
    assert {verdict.effect for verdict in found.ranking} >= set(found.missing)
    said = unfinished_sentence(found)
    assert said in diagnosis_markdown(found)
    console = Console(file=io.StringIO(), width=2000)
    diagnosis_report(found, console)
    assert said in console.file.getvalue()


def test_effects_without_a_shape_are_there_soon(after):
    found, _ = after(0.0)
    assert found.missing[0] == "viscous_friction"
    assert {Unfinished.SETS, Unfinished.OWN_VALUES, Unfinished.LAWS} <= set(found.unfinished)
    assert found.ladder[-1].validate < 0.5 * found.ladder[0].validate


def test_later_is_no_worse(after):
    errors = [after(part)[0].ladder[-1].validate for part in PARTS]
    assert all(later <= earlier * (1.0 + ROUNDING) for earlier, later in pairwise(errors))


def test_a_deadline_passes_with_its_clock():
    clock = count(10.0)
    deadline = deadline_in(2.0, lambda: next(clock))
    deadline.check()
    with pytest.raises(TimeUpError):
        deadline.check()
    assert deadline_in(None) is NEVER
    assert not NEVER.passed


def test_every_code_has_its_words():
    assert set(NOT_LOOKED_AT) == set(Unfinished)


def test_the_command_says_so_everywhere(arm, tmp_path, capsys):
    answer, folder = tmp_path / "answer.json", tmp_path / "found"
    limit = ["--time-limit", "1e-9", "--json", str(answer), "-o", str(folder)]
    assert main(["diagnose", str(arm / "data"), *limit]) == 0
    content = json.loads(answer.read_text())
    assert content["finished"] is False
    assert "laws" in content["not_looked_at"]
    assert content["missing"] == ["viscous_friction"]
    said = "The time limit ended the search."
    assert said in " ".join(capsys.readouterr().out.split())
    assert said in (folder / "report.html").read_text()
    kept = read_run(folder)
    assert [*kept.diagnosis.unfinished] == content["not_looked_at"]
    assert kept.run.line().endswith(f"--time-limit 1e-09 -o {folder}")


@pytest.mark.parametrize("seconds", [0.0, -1.0, float("nan")])
def test_a_limit_is_more_than_nothing(seconds):
    with pytest.raises(BenchError, match="time limit"):
        diagnose("no data", time_limit=seconds)
