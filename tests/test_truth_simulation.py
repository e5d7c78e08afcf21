"""Simulations end to end: reproducible, independent of threads, refused where they fail."""

import json

import mujoco
import numpy as np
import pytest

from bench.basics.errors import BenchError
from bench.basics.quiet import stop_step_timers
from bench.dataset.dataset import load_dataset
from bench.scenario.scenario import load_scenario
from bench.truth.dataset import as_dataset, truth_path, write_simulation
from bench.truth.loops import loop_gaps
from bench.truth.simulate import simulate

RECORDINGS = [
    {"name": "free", "use": "identify", "design": {"seed": 1}},
    {"name": "held", "use": "identify", "payload": "disc", "design": {"seed": 2}},
    {"name": "check", "use": "validate", "design": {"seed": 3}},
]
SHORT = {"design": {"optimise": False, "duration": 3.0, "ramp": 0.5}, "recordings": RECORDINGS}


def short(**overrides):
    return load_scenario("five_bar", SHORT | overrides)


@pytest.fixture(scope="module")
def simulation():
    return simulate(short())


def contents(folder):
    files = {path.name: path.read_bytes() for path in sorted(folder.iterdir())}
    return files | {"truth": truth_path(folder).read_bytes()}


def test_same_scenario_same_bytes_whatever_the_number_of_threads(simulation, tmp_path):
    write_simulation(simulation, tmp_path / "one")
    write_simulation(simulate(short(), threads=1), tmp_path / "two")
    assert contents(tmp_path / "one") == contents(tmp_path / "two")


def test_another_seed_changes_the_noise_and_not_the_motion(simulation):
    other = simulate(short(seed=2))
    for one, two in zip(simulation.recordings, other.recordings, strict=True):
        np.testing.assert_array_equal(one.motion.qpos, two.motion.qpos)
        assert not np.array_equal(one.log.current, two.log.current)


def test_no_recording_depends_on_another(simulation):
    alone = simulate(short(recordings=RECORDINGS[1:2])).recordings[0]
    np.testing.assert_array_equal(alone.log.position, simulation.recordings[1].log.position)
    np.testing.assert_array_equal(alone.log.current, simulation.recordings[1].log.current)


def test_the_folder_reads_back_as_what_was_logged(simulation, tmp_path):
    write_simulation(simulation, tmp_path / "set")
    read, given = load_dataset(tmp_path / "set"), as_dataset(simulation)
    assert read.robot == given.robot
    assert read.payloads.keys() == given.payloads.keys()
    assert read.payloads["disc"].mass == 0.5
    for one, two in zip(read.recordings, given.recordings, strict=True):
        assert (one.name, one.use, one.payload) == (two.name, two.use, two.payload)
        np.testing.assert_array_equal(one.current, two.current)
        np.testing.assert_array_equal(one.position, two.position)


def test_parquet_holds_the_same_numbers(simulation, tmp_path):
    write_simulation(simulate(short(file_format="parquet")), tmp_path / "set")
    read = load_dataset(tmp_path / "set").recordings[0]
    assert read.name == "free.parquet"
    np.testing.assert_array_equal(read.current, simulation.recordings[0].log.current)


def test_nothing_in_the_dataset_folder_tells_the_truth(simulation, tmp_path):
    truth = write_simulation(simulation, tmp_path / "set")
    assert truth == tmp_path / "set.truth.json"
    files = sorted(path.name for path in (tmp_path / "set").iterdir())
    assert files == ["check.csv", "dataset.toml", "free.csv", "held.csv"]
    told = json.loads(truth.read_text())
    assert told["drive_gains"]["left"]["true"] == pytest.approx(3.3)
    assert "3.3" not in (tmp_path / "set" / "dataset.toml").read_text()
    header = (tmp_path / "set" / "free.csv").read_text().split("\n")[0]
    assert header == "time,position.left,position.right,current.left,current.right"


def test_truth_names_the_machine_as_its_mjcf_describes_it(simulation):
    from bench.truth.report import truth

    told = truth(simulation)
    model = simulation.robot.mjcf_model()
    assert list(told["bodies"]) == [model.body(i).name for i in range(1, model.nbody)]
    crank = told["bodies"]["left_crank"]
    assert crank["mass"] == 1.216
    np.testing.assert_allclose(
        crank["inertia"], [1.05e-3, 6.42e-3, 6.71e-3, 2.1e-5, -1.34e-4, 8e-6], atol=1e-15
    )
    assert told["recordings"]["free.csv"]["current_noise"]["left"] == pytest.approx(
        0.01 * told["recordings"]["free.csv"]["current_rms"]["left"]
    )
    assert told["loop_gap"] == max(r["loop_gap"] for r in told["recordings"].values())


def test_an_older_dataset_is_replaced_and_anything_else_is_left_alone(simulation, tmp_path):
    write_simulation(simulation, tmp_path / "set")
    (tmp_path / "set" / "notes.txt").write_text("old")
    write_simulation(simulation, tmp_path / "set")
    assert not (tmp_path / "set" / "notes.txt").exists()
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "thesis.tex").write_text("precious")
    with pytest.raises(BenchError, match="holds no dataset"):
        write_simulation(simulation, tmp_path / "mine")
    assert (tmp_path / "mine" / "thesis.tex").exists()
    assert sorted(p.name for p in tmp_path.iterdir()) == ["mine", "set", "set.truth.json"]


def test_gains_are_given_offset_or_drawn():
    given = simulate(short(gains={"error": 0.0, "true": {"left": 3.1, "right": 2.9}}))
    np.testing.assert_array_equal(given.machine.drive.true_gains, [3.1, 2.9])
    drawn = {"error": 0.0, "error_within": 0.1}
    gains = [simulate(short(gains=drawn, seed=s)).machine.drive.true_gains for s in (1, 1, 2)]
    assert (np.abs(gains[0] / 3.0 - 1) < 0.1).all()
    assert gains[0][0] != gains[0][1]
    np.testing.assert_array_equal(gains[0], gains[1])
    assert not np.array_equal(gains[0], gains[2])


def test_controller_uses_the_nominal_gains(simulation):
    """A gain that is 10 % higher than told gives 10 % more torque for the same reference."""
    for recording in simulation.recordings:
        ratio = recording.motion.torque / (recording.current * simulation.robot.nominal_gains)
        np.testing.assert_allclose(ratio, [[1.1, 0.92]] * len(ratio), rtol=1e-12)


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ({"controller": {"natural_frequency": 1000.0}}, "'free': the simulation diverged"),
        ({"controller": {"natural_frequency": 0.5}}, "the controller lost joint"),
        ({"controller": {"tracking_limit": 1e-4}}, "the controller lost joint"),
        ({"design": {"span": 0.9, "velocity_limit": 20, "acceleration_limit": 500}}, "reaches its end stop"),
        ({"tolerances": {"loop_gap": 1e-9}}, "a loop opens by"),
        ({"hidden": [{"effect": "magic", "a": 1}]}, "hidden\\[0\\].effect: no effect 'magic'"),
        ({"hidden": [{"effect": "viscous_friction", "Fc": 1}]}, "hidden\\[0\\].Fc: unknown key"),
        ({"hidden": [{"effect": "viscous_friction"}]}, "hidden\\[0\\].Fv: missing"),
        ({"hidden": [{"effect": "viscous_friction", "Fv": -1}]}, "hidden\\[0\\].Fv: should be"),
        ({"hidden": [{"effect": "viscous_friction", "Fv": 1, "joint": "x"}]}, "no hinge or slide joint 'x'"),
    ],
)
def test_what_fails_is_named_in_one_line(change, told):
    merged = dict(SHORT)
    merged.update(
        {key: {**merged.get(key, {}), **v} if isinstance(v, dict) else v for key, v in change.items()}
    )
    with pytest.raises(BenchError, match=told) as raised:
        simulate(load_scenario("five_bar", merged))
    assert "\n" not in str(raised.value)


def test_the_steps_of_all_recordings_are_counted(simulation):
    assert simulation.steps == len(RECORDINGS) * (3000 + 500) * 4


@pytest.mark.parametrize("hidden", [[], [{"effect": "current_delay", "T": 0.001}]], ids=["none", "laws"])
def test_gaps_on_the_way_are_those_of_the_poses(hidden):
    simulation = simulate(short(hidden=hidden))
    assert simulation.machine.laws == bool(hidden)
    for one in simulation.recordings:
        model = simulation.machine.models[one.table.payload]
        np.testing.assert_array_equal(one.motion.gaps, loop_gaps(model, one.motion.qpos))
        assert one.loop_gap == one.motion.gaps.max() > 0


def test_timers_stop_only_where_a_process_asks_for_it_and_a_clock_of_the_caller_stays():
    ticks = []
    mujoco.set_mjcb_time(lambda: ticks.append(0) or 0.0)
    try:
        stop_step_timers()
        model = mujoco.MjModel.from_xml_string("<mujoco/>")
        mujoco.mj_step(model, mujoco.MjData(model))
    finally:
        mujoco.set_mjcb_time(None)
    assert ticks
