"""The measured logs as datasets: unchanged if they are datasets, otherwise imported as by a user."""

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
"""TX40, as published: motor -> joint -> turns of the motor for one of the joint. Joint 5 also turns motor 6."""


def as_it_is(data: Path, _folder: Path) -> Path:
    """A dataset that needs no import."""
    return data


def imported_emps(data: Path, folder: Path) -> Path:
    """Import the MATLAB file of the EMPS slide."""
    columns = {"time": "t", "position.axis": "qm", "current.axis": "vir"}
    import_log("emps", LogRequest(data / "DATA_EMPS.mat", LogMap(columns)), folder / "emps")
    return folder / "emps"


def imported_tx40(data: Path, folder: Path) -> Path:
    """Import positions and torques of the motors; each motor is a fixed tendon over the joints coupled to it."""
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
"""Name of a machine, and of its folder in the measured data -> function that returns the dataset, which it may create
in another folder.
"""


def dataset_of(name: str, measured: Path, folder: Path) -> Path:
    """The dataset of a machine, created in `folder` if necessary. Raises BenchError if its logs are missing."""
    data = measured / name
    if not data.is_dir():
        raise BenchError(f"{data}: no measured logs; set $PARABENCH_DATA to their folder")
    return MACHINES[name](data, folder)
