"""The measured TX40, motor side: six motors behind gears, the sixth turning with joint 5 as well."""

from pathlib import Path

import pytest
from pyarrow import parquet

from bench.dataset import load_dataset
from bench.estimate.identify import identify
from bench.robot import load_robot

# motor: (joint, turns of the motor for one of the joint), as published
GEARS = {
    1: {1: 32.0},
    2: {2: 32.0},
    3: {3: 45.0},
    4: {4: -48.0},
    5: {5: 45.0},
    6: {5: 32.0, 6: 32.0},
}
FRICTION = {1: 8.05, 2: 5.53, 3: 1.97, 4: 1.11, 5: 1.86, 6: 0.65}  # N m s/rad at the joints, published


@pytest.fixture
def tx40(measured_data: Path, tmp_path: Path) -> Path:
    """A dataset of the log as it is: positions and torques of the motors, with the robot beside it."""
    folder = measured_data / "tx40"
    if not (folder / "run.parquet").is_file():
        pytest.skip("the measured TX40 data are not here (set PARABENCH_DATA)")
    tendons = "".join(
        f'<fixed name="motor_{motor}">'
        + "".join(f'<joint joint="joint_{joint}" coef="{turns}"/>' for joint, turns in joints.items())
        + "</fixed>"
        for motor, joints in GEARS.items()
    )
    mjcf = (folder / "tx40_joints.xml").read_text(encoding="utf-8")
    mjcf = mjcf.replace("</mujoco>", f"<tendon>{tendons}</tendon></mujoco>")
    (tmp_path / "tx40.xml").write_text(mjcf, encoding="utf-8")
    motors = "".join(f'[[actuators]]\ntendon = "motor_{i}"\ngain = 1.0\ngain_unit = "1"\n' for i in GEARS)
    (tmp_path / "robot.toml").write_text(f'name = "tx40"\nmodel = "tx40.xml"\n{motors}', encoding="utf-8")
    log = parquet.read_table(folder / "run.parquet")
    names = {"motor_position.": "position.motor_", "motor_torque.": "current.motor_"}
    renamed = [
        next((new + name.removeprefix(old) for old, new in names.items() if name.startswith(old)), name)
        for name in log.column_names
    ]
    parquet.write_table(log.rename_columns(renamed), tmp_path / "run.parquet")
    table = 'robot = "."\n[[recordings]]\nfile = "run.parquet"\nuse = "identify"\n'
    (tmp_path / "dataset.toml").write_text(table, encoding="utf-8")
    return tmp_path


@pytest.mark.parametrize("settings", [{"position_cutoff": 20.0, "decimation": 60}, None])
def test_the_coupling_is_understood(tx40: Path, settings: dict[str, float] | None) -> None:
    assert [actuator.gain_unit for actuator in load_robot(tx40).actuators] == ["N*m/(N*m)"] * 6
    effects = ["viscous_friction", "coulomb_friction", "constant_offset"]
    found = identify(load_dataset(tx40), effects, filters=settings)
    assert found.error.identify < 0.10
    by_motor = {
        motor: found.effect_parameters["viscous_friction"][f"motor_{motor}"]["Fv"].value for motor in GEARS
    }
    for joint, published in FRICTION.items():
        # a torque of a motor is felt at every joint that turns with it, times the gear; so is its speed
        felt = sum(by_motor[motor] * turns.get(joint, 0.0) ** 2 for motor, turns in GEARS.items())
        assert felt == pytest.approx(published, rel=0.15), f"joint_{joint}"
