"""The measured TX40, motor side: six motors behind gears, the sixth turning with joint 5 as well."""

from pathlib import Path

import pytest

from bench.benchmarks.measured.machines import GEARS, dataset_of
from bench.dataset.dataset import load_dataset
from bench.diagnosis.split import with_held_out_parts
from bench.identification.identify import identify
from bench.identification.prepare import prepare
from bench.identification.problem import problem_of

FRICTION = {1: 8.05, 2: 5.53, 3: 1.97, 4: 1.11, 5: 1.86, 6: 0.65}  # N m s/rad at the joints, published


@pytest.fixture
def tx40(measured_data: Path, tmp_path: Path) -> Path:
    """A dataset of the log as it is: positions and torques of the motors, with the robot beside it."""
    if not (measured_data / "tx40" / "run.parquet").is_file():
        pytest.skip("the measured TX40 data are not here (set PARABENCH_DATA)")
    return dataset_of("tx40", measured_data, tmp_path)


@pytest.mark.parametrize("settings", [{"position_cutoff": 20.0, "decimation": 60}, None])
def test_the_coupling_is_understood(tx40: Path, settings: dict[str, float] | None) -> None:
    dataset = load_dataset(tx40)
    assert [actuator.gain_unit for actuator in dataset.robot.actuators] == ["N*m/(N*m)"] * 6
    effects = ["viscous_friction", "coulomb_friction", "constant_offset"]
    found = identify(prepare(problem_of(dataset, effects, filters=settings)))
    assert found.error.identify < 0.10
    by_motor = {
        motor: found.effect_parameters["viscous_friction"][f"motor_{motor}"]["Fv"].value for motor in GEARS
    }
    for joint, published in FRICTION.items():
        # a torque of a motor is felt at every joint that turns with it, times the gear; so is its speed
        felt = sum(by_motor[motor] * turns.get(joint, 0.0) ** 2 for motor, turns in GEARS.items())
        assert felt == pytest.approx(published, rel=0.15), f"joint_{joint}"


def test_a_part_of_the_log_is_filtered_as_the_whole_is(tx40: Path) -> None:
    """A diagnosis fits the first 70 % and judges on the rest; jitter at one motor was taken for motion there."""
    parts, _ = with_held_out_parts(load_dataset(tx40))
    found = identify(prepare(problem_of(parts, ["viscous_friction", "coulomb_friction", "constant_offset"])))
    assert found.settings.position_cutoff < 150.0  # Hz; motion ends at 12 Hz
    assert found.error.identify < 0.10
    assert found.error.validate < 0.10
