"""What changes with the time alone is asked of long logs only."""

from dataclasses import replace

import pytest

from bench.dataset.dataset import Dataset
from bench.dataset.robot import load_robot
from bench.diagnosis.discovery.grammar import Scope, T, grammar
from bench.diagnosis.fading import not_asked, too_short
from bench.diagnosis.reason import Because, Reason
from bench.diagnosis.reason_words import reason_sentence
from bench.diagnosis.result import EffectVerdict
from bench.diagnosis.split import with_held_out_parts
from bench.effects import CATALOGUE
from tests.shown import dataset_of

DRIFT = "thermal_friction_drift"


def logs(*seconds: float) -> Dataset:
    """Fitted logs that last so long."""
    robot = load_robot("two_link")
    made = [dataset_of(robot, duration=length, start=5.0).recordings[0] for length in seconds]
    named = [replace(log, name=f"{k}.csv") for k, log in enumerate(made)]
    return replace(dataset_of(robot), recordings=tuple(named))


@pytest.mark.parametrize(("seconds", "short"), [((10.0, 6.0), True), ((6.0, 12.0), False)])
def test_a_drift_is_not_asked_of_logs_of_ten_seconds(seconds: tuple[float, ...], short: bool) -> None:
    dataset = logs(*seconds)
    split, _ = with_held_out_parts(dataset)  # the end of a log counts, though it is not fitted
    for recordings in (dataset.recordings, split.recordings):
        assert (too_short(recordings) is not None) == short
        reasons = not_asked(recordings, CATALOGUE, ())
        assert set(reasons) == ({DRIFT} if short else set())
        assert not_asked(recordings, CATALOGUE, (DRIFT,)) == {}


def test_a_part_of_a_long_log_is_as_good_as_the_log() -> None:
    log = logs(12.0).recordings[0]
    part = replace(log.part(slice(9_000, None)), part_of=log.name, started=log.began)
    assert too_short([part]) is None


def test_it_says_why() -> None:
    why = Reason(Because.TOO_SHORT, ("10 s",))
    said = reason_sentence(EffectVerdict(DRIFT, "not supported", 0.5, 0.5, 0.0, (), (), {}, why))
    assert said.startswith("Thermal friction drift is not asked of logs of up to 10 s")


def test_laws_of_such_logs_have_no_time() -> None:
    def with_time(of_time: bool) -> bool:
        scope = Scope(1, False, False, 10.0, -1.0, 2.0, ((1.0, 0.5),), (7.0,), 0.01, of_time)
        return any(T in factor.variables for term in grammar(scope) for factor in term.factors)

    assert with_time(True)
    assert not with_time(False)
