"""Sweeps with the real work: simulate, identify, measure."""

from dataclasses import replace

import pyarrow.parquet as pq
import pytest

from bench.basics.errors import BenchError
from bench.cli import main
from bench.scenario.scenario import scenario_from_dict
from bench.studies.sweep.hidden_share import with_sized_effect, without_share
from bench.studies.sweep.plan import make_plan
from bench.studies.sweep.sweep_file import load_sweep
from bench.studies.sweep.work import designed, identification_work, rows_of, shared_motion
from bench.truth.hidden.reference import Reference
from bench.truth.simulate import simulate
from tests import sweep_stand_in
from tests.hidden_kit import measured_share

SWEEP = """
base = "five_bar"
seeds = 2
record = ["accuracy", "gains", "parameters", "effects"]
[scenario]
description = "small"
step = 0.0005
recordings = [
    { name = "unloaded", use = "identify", design = { seed = 1, optimise = false, duration = 5.0 } },
    { name = "loaded", use = "identify", payload = "disc", design = { seed = 2, optimise = false, duration = 5.0 } },
    { name = "check", use = "validate", payload = "disc", design = { seed = 3, optimise = false, duration = 5.0 } },
]
"""


def plan_of(tmp_path, more):
    path = tmp_path / "small.toml"
    path.write_text(SWEEP + more)
    return make_plan(load_sweep(path))


@pytest.fixture(scope="module")
def plan(tmp_path_factory):
    axes = '[axes]\nmethod = ["current", "ls"]\neffects = [[], ["viscous_friction"]]\n'
    return plan_of(tmp_path_factory.mktemp("sweep"), axes)


@pytest.fixture(scope="module")
def trajectories(plan):
    return designed(plan.run(0))


def test_shared_work_gives_the_same_rows_to_the_last_bit(plan, trajectories):
    motion = shared_motion(plan.run(0), trajectories)
    for runs in plan.tasks():
        shared = rows_of(runs, trajectories, plan.sweep.table.record, motion)
        alone = [rows_of((run,), trajectories, plan.sweep.table.record)[0] for run in runs]
        assert shared == alone
        assert [row["status"] for row in shared] == ["ok"] * len(runs)


def test_a_row_says_what_was_set_and_what_came_out(plan, trajectories):
    run = next(run for run in map(plan.run, range(plan.size)) if run.identify["effects"])
    (row,) = rows_of((run,), trajectories, plan.sweep.table.record)
    assert row["effects"] == "viscous_friction"
    assert row["payloads.disc.mass"] == 0.5
    assert row["recordings.loaded.design.duration"] == 5.0
    assert row["gain_error"] < 0.05
    assert row["drive_gain.left"] == pytest.approx(3.3, rel=0.05)
    assert row["gain_within"] in (0.0, 0.5, 1.0)
    assert "effect.viscous_friction.left.Fv" in row
    assert row["version.mujoco"]
    assert row["seed"] == run.seed


def test_a_reason_that_can_be_named_is_in_the_row(plan, trajectories):
    run = replace(plan.run(0), content={**plan.run(0).content, "step": 0.01, "log_rate": 100.0})
    (row,) = rows_of((run,), trajectories, ())
    assert row["status"] == "failed"
    assert row["reason"]
    assert "gain_error" not in row


def test_a_hidden_effect_takes_the_share_of_the_torque_that_was_asked_for(tmp_path, trajectories):
    axes = '[axes]\nhidden_effect = ["viscous_friction"]\nhidden_share = [0.0, 0.1]\n'
    without, with_effect = (run.content for run in map(plan_of(tmp_path, axes).run, (0, 2)))
    assert with_sized_effect(without, "small", trajectories) == without_share(without)
    content = with_sized_effect(with_effect, "small", trajectories)
    assert [one["joint"] for one in content["hidden"]] == ["left", "right"]
    plain, changed = (
        simulate(scenario_from_dict(one, "small"), trajectories) for one in (without_share(without), content)
    )
    assert measured_share(changed, Reference(plain)) == pytest.approx([0.1, 0.1], rel=0.2)


@pytest.mark.parametrize(
    ("content", "told"),
    [
        ({"hidden_effect": "viscous_friction"}, "go together"),
        ({"hidden_effect": "gremlins", "hidden_share": 0.1}, "gremlins"),
        ({"hidden_effect": "viscous_friction", "hidden_share": 1.5}, "from 0 to 1"),
    ],
)
def test_a_share_that_makes_no_sense_is_refused(content, told):
    with pytest.raises(BenchError, match=told):
        without_share(content)


def test_the_command_from_file_to_figure(plan, tmp_path, capsys):
    folder = tmp_path / "out"
    arguments = ["sweep", str(plan.sweep.path), "-o", str(folder), "--workers", "2"]
    assert main(arguments) == 0
    out = capsys.readouterr().out
    assert "8 runs (2 × method, 2 × effects, 2 seeds), 1 simulation" in " ".join(out.split())
    assert "0 failed" in out
    table = pq.read_table(folder / "runs.parquet")
    assert table.num_rows == 8
    assert {path.suffix for path in folder.iterdir()} >= {".parquet", ".md", ".svg", ".toml"}
    before = (folder / "runs.parquet").read_bytes()
    assert main(arguments) == 0
    assert (folder / "runs.parquet").read_bytes() == before


def test_a_simulation_that_diverges_is_a_reason_and_nothing_else(tmp_path, monkeypatch, capfd):
    monkeypatch.chdir(tmp_path)
    text = """
    base = "five_bar"
    [scenario]
    design = { duration = 2.0, ramp = 0.25, optimise = false }
    controller = { natural_frequency = 900.0 }
    """
    plan = sweep_stand_in.plan_of(tmp_path / "sweep", text)
    work, run = identification_work(plan.sweep), plan.run(0)
    (row,) = work.runs((run,), work.design(run)(None))(None)
    assert row["status"] == "failed"
    assert "the simulation diverged" in row["reason"]
    assert capfd.readouterr() == ("", "")
    assert [path.name for path in tmp_path.iterdir()] == ["sweep"]
