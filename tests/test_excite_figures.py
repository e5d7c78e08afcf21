"""The kept figures of `bench excite`: its page is made of them, and the handbook quotes what they say."""

import json
from pathlib import Path

import pytest

from bench.studies.excite_figures import PAGE, ROBOTS, kept_figures, page

ROOT = Path(__file__).resolve().parents[1]
KEPT = ROOT / "results" / "excite"
NAMES = {"five_bar": "the five-bar", "two_link": "the arm", "delta": "the Delta", "stewart": "the hexapod"}


def figures(robot):
    return json.loads((KEPT / f"{robot}.json").read_text(encoding="utf-8"))


def test_the_page_is_made_of_the_kept_figures():
    assert (KEPT / PAGE).read_text(encoding="utf-8") == page(kept_figures(KEPT, ROBOTS))


@pytest.mark.parametrize("robot", ROBOTS)
def test_forecasts_come_true_within_a_fifth_as_far_as_so_many_repetitions_can_say(robot):
    kept = figures(robot)
    assert kept["smallest_interval"][0] > 0.8
    assert kept["largest_interval"][1] < 1.2
    assert kept["better"] > 3.0


def test_the_handbook_quotes_them():
    text = (ROOT / "docs" / "pages" / "howto" / "experiment.md").read_text(encoding="utf-8")
    for robot, name in NAMES.items():
        kept = figures(robot)
        reach = f"{kept['smallest']:.2f} to {kept['largest']:.2f}"
        assert reach in text, name
        assert f"{kept['better']:.2g}" in text, name
        assert str(kept["repetitions"]) in text, name
