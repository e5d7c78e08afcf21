"""Logs in mA among logs in A are named, whichever they are; a slow motion or a heavy load is none."""

from dataclasses import replace

import pytest

from bench.api.identify import identify
from bench.cli import main
from bench.dataset.dataset import load_dataset
from bench.identification.finding import Code
from bench.identification.finding_words import sentence
from bench.identification.mistaken import unlike_units
from tests.workbench_kit import RECORDINGS, write_dataset


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return write_dataset(tmp_path_factory.mktemp("units") / "d", hidden=[], duration=3.0)


@pytest.fixture(scope="module")
def plain(folder):
    return identify(folder)


def scaled(result, names, factor):
    """The result with other currents in some recordings."""
    return replace(
        result,
        recordings=tuple(
            replace(series, measured=factor * series.measured) if series.name in names else series
            for series in result.recordings
        ),
    )


@pytest.mark.parametrize("names", [{"free.csv"}, {"held_check.csv"}, {"free.csv", "free_check.csv"}])
@pytest.mark.parametrize("factor", [1e3, 1e-3])
def test_the_logs_in_thousandths_are_named(plain, names, factor):
    (found,) = unlike_units(scaled(plain, names, factor))
    every = {f"{name}.csv" for name, *_ in RECORDINGS}
    assert found.code == Code.UNITS_UNLIKE
    assert set(found.names[1:]) == (names if factor > 1.0 else every - names)
    assert found.names[0] not in found.names[1:]
    assert 300.0 < found.numbers["times"] < 3000.0


@pytest.mark.parametrize("factor", [1.0, 20.0, 100.0, 3e4])
def test_other_sizes_of_currents_are_no_units(plain, factor):
    assert unlike_units(scaled(plain, {"free.csv"}, factor)) == []


def test_a_single_motor_in_milliamperes_is_not_the_log(plain):
    (first, *others) = plain.recordings
    measured = first.measured * [1e3, 1.0]
    assert unlike_units(replace(plain, recordings=(replace(first, measured=measured), *others))) == []


def test_it_is_said_first_with_what_mends_it(folder, capsys):
    data = load_dataset(folder)
    free, *others = data.recordings
    mixed = replace(data, recordings=(replace(free, current=1e3 * free.current), *others))
    first = identify(mixed).findings[0]
    assert first.code == Code.UNITS_UNLIKE
    assert "at every motor: probably it is in mA and" in sentence(first)
    assert "`--scale current=mA`" in sentence(first)
    assert main(["identify", str(folder)]) == 0
    assert "--scale current=mA" not in capsys.readouterr().out
