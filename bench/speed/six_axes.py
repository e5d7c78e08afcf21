"""Cost of identifying a measured arm of six axes at 5 kHz, 9 s: the TX40 among the measured data, on the joints' side.

Motors and joints turn as motor = RATIOS @ joint: motor 6 also turns with joint 5. Torques follow by the transpose.
"""

import shutil
from pathlib import Path
from tempfile import TemporaryDirectory
from time import process_time

import numpy as np
import pyarrow.parquet as pq

from bench.dataset.dataset import RecordingEntry, load_dataset, write_dataset_toml
from bench.dataset.recording import write_recording
from bench.dataset.recording_checks import Check
from bench.identification.identify import fit, prepare
from bench.identification.swapped_columns import swapped_columns

LIMIT = 2.0  # s
AXES = 6
RATIOS = np.diag([32.0, 32.0, 45.0, -48.0, 45.0, 32.0])
RATIOS[5, 4] = 32.0
ROBOT = 'name = "tx40"\nmodel = "tx40.xml"\n'
ACTUATOR = '\n[[actuators]]\njoint = "joint_{i}"\ngain = 1.0\ngain_unit = "N*m/A"\n'
ACCEPTED: tuple[Check, ...] = (
    "frozen",
    "spikes",
    "saturated",
)  # the controller's torque is held between its own samples


def write_six_axes(data: Path, folder: Path) -> Path:
    """A dataset of the arm's joints, currents being torques, from the measured run in `data`."""
    log = pq.read_table(data / "run.parquet")

    def motors(kind: str) -> np.ndarray:
        return np.column_stack([log[f"{kind}.{i + 1}"].to_numpy() for i in range(AXES)])

    robot = folder / "tx40"
    robot.mkdir(parents=True)
    shutil.copyfile(data / "tx40_joints.xml", robot / "tx40.xml")
    actuators = "".join(ACTUATOR.format(i=i + 1) for i in range(AXES))
    (robot / "robot.toml").write_text(ROBOT + actuators, encoding="utf-8")
    position = np.linalg.solve(RATIOS, motors("motor_position").T).T
    torque = motors("motor_torque") @ RATIOS
    names = [f"joint_{i + 1}" for i in range(AXES)]
    write_recording(folder / "run.parquet", log["time"].to_numpy(), position, torque, names)
    write_dataset_toml(folder, "tx40", [RecordingEntry("run.parquet", "identify", accept=ACCEPTED)])
    return folder


def measure(data: Path) -> float:
    """Processor seconds to read the recording, identify and look for columns that were taken for each other."""
    with TemporaryDirectory() as name:
        folder = write_six_axes(data, Path(name) / "dataset")
        start = process_time()
        dataset = load_dataset(folder)
        prepared = prepare(dataset)
        swapped_columns(dataset, fit(prepared), prepared)
        return process_time() - start
