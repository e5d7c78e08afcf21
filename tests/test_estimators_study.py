"""The table of estimators: what it counts, and that the same seeds give the same rows."""

import json
from dataclasses import asdict, replace
from pathlib import Path

import numpy as np

from bench.basics.plain_data import finite
from bench.benchmarks.peers.problems import make_problem
from bench.dataset.dataset import Dataset
from bench.studies.estimators import (
    CASES,
    Condition,
    kept_rows,
    markdown,
    rows_of,
    steps_at,
    with_bad_seconds,
)
from bench.truth.dataset import as_dataset
from bench.truth.resense import sense_again


def test_the_same_seeds_give_the_same_rows_and_more_noise_a_larger_spread() -> None:
    noisy = next(case for case in CASES if case.sensors == {"current_noise_ratio": 0.1})
    (one,), (again,), (more,) = (
        rows_of("two_link", case, ["current"], 3) for case in (CASES[0], CASES[0], noisy)
    )
    assert replace(one, seconds=0.0) == replace(again, seconds=0.0)
    assert one.seeds == 3
    assert 0.0 < one.spread < one.spread * 5 < more.spread
    text = markdown([one, more])
    assert f"| {noisy.name} | current |" in text


def test_every_seed_has_encoders_whose_steps_lie_elsewhere() -> None:
    simulation = make_problem("five_bar", 1, friction=False).simulation
    true = simulation.recordings[0].position
    step = 2.0 * np.pi / 2**20
    errors = []
    for seed in (1, 2):
        zero = steps_at("five_bar", seed)
        logged = sense_again(simulation, simulation.scenario, zero).recordings[0].log.position
        counts = (logged - zero) / step
        assert np.abs(counts - np.round(counts)).max() < 1e-6
        assert np.abs(logged - true).max() < 0.501 * step
        errors.append(logged - true)
    assert np.all(np.sqrt(np.mean((errors[0] - errors[1]) ** 2, axis=0)) > 0.2 * step)


def test_what_refuses_the_data_is_counted_and_kept(tmp_path: Path) -> None:
    (row,) = rows_of("two_link", Condition("no law", controller={"declared": False}), ["oe"], 1)
    assert (row.seeds, row.failed) == (0, 1)
    assert "controller" in row.reason
    for robot in ("five_bar", "own_robot", "two_link"):
        content = finite({"rows": [asdict(replace(row, robot=robot))]})
        (tmp_path / f"{robot}.json").write_text(json.dumps(content))
    kept = kept_rows(tmp_path)
    assert [one.robot for one in kept] == ["two_link", "five_bar", "own_robot"]
    assert np.isnan(kept[0].bias)
    assert "1 refused" in markdown(kept)


def test_bad_seconds_are_whole_seconds_of_one_motor_each() -> None:
    dataset: Dataset = as_dataset(make_problem("five_bar", 1, friction=False).simulation)
    spoilt = with_bad_seconds(dataset, 2, 1)
    for one, other in zip(dataset.recordings, spoilt.recordings, strict=True):
        changed = np.abs(other.current - one.current) > 0.0
        assert 1800 < changed.sum() <= 2000
        assert np.array_equal(other.position, one.position)
