"""The measured logs as datasets: as they are where they come so, else imported as a user would."""

from collections.abc import Callable, Mapping
from pathlib import Path

from bench.basics.errors import BenchError
from bench.dataset.logs.columns import LogMap
from bench.dataset.logs.importing import LogRequest, import_log

GEARS: Mapping[int, Mapping[int, float]] = {
    1: {1: 32.0},
    2: {2: 32.0},
    3: {3: 45.0},
    4: {4: -48.0},
    5: {5: 45.0},
    6: {5: 32.0, 6: 32.0},
}
"""TX40, as published: motor -> joint -> turns of the motor for one of the joint. Motor 6 turns with joint 5 as well."""


def as_it_is(data: Path, _folder: Path) -> Path:
    """A dataset that needs no import."""
    return data


def imported_emps(data: Path, folder: Path) -> Path:
    """The slide's MATLAB file."""
    columns = {"time": "t", "position.axis": "qm", "current.axis": "vir"}
    import_log("emps", LogRequest(data / "DATA_EMPS.mat", LogMap(columns)), folder / "emps")
    return folder / "emps"


def imported_tx40(data: Path, folder: Path) -> Path:
    """Positions and torques of the motors, each a fixed tendon over the joints that it turns with."""
    robot = folder / "tx40_robot"
    robot.mkdir()
    tendons = "".join(
        f'<fixed name="motor_{motor}">'
        + "".join(f'<joint joint="joint_{joint}" coef="{turns}"/>' for joint, turns in joints.items())
        + "</fixed>"
        for motor, joints in GEARS.items()
    )
    mjcf = (data / "tx40_joints.xml").read_text(encoding="utf-8")
    mjcf = mjcf.replace("</mujoco>", f"<tendon>{tendons}</tendon></mujoco>")
    (robot / "tx40.xml").write_text(mjcf, encoding="utf-8")
    motors = "".join(f'[[actuators]]\ntendon = "motor_{i}"\ngain = 1.0\ngain_unit = "1"\n' for i in GEARS)
    (robot / "robot.toml").write_text(f'name = "tx40"\nmodel = "tx40.xml"\n{motors}', encoding="utf-8")
    columns = {"time": "time"}
    for motor in GEARS:
        columns |= {
            f"position.motor_{motor}": f"motor_position.{motor}",
            f"current.motor_{motor}": f"motor_torque.{motor}",
        }
    request = LogRequest(data / "run.parquet", LogMap(columns), name="run.parquet")
    import_log(str(robot), request, folder / "tx40")
    return folder / "tx40"


MACHINES: Mapping[str, Callable[[Path, Path], Path]] = {
    "double_pendulum": as_it_is,
    "emps": imported_emps,
    "kuka": as_it_is,
    "mtm": as_it_is,
    "psm": as_it_is,
    "psm1": as_it_is,
    "tx40": imported_tx40,
    "ur10e": as_it_is,
}
"""Name of a machine and of its folder among the measured data -> the dataset, made in another folder if need be."""


def dataset_of(name: str, measured: Path, folder: Path) -> Path:
    """The dataset of a machine. Raises BenchError where its logs are not there."""
    data = measured / name
    if not data.is_dir():
        raise BenchError(f"{data}: no measured logs; set $PARABENCH_DATA to their folder")
    return MACHINES[name](data, folder)
