"""A small robot and clean recordings of it, for tests of what comes in."""

from pathlib import Path

import numpy as np

from bench.dataset.dataset import RecordingEntry, write_dataset_toml
from bench.dataset.payload import Payload
from bench.dataset.recording import write_recording

JOINTS = ("arm", "rail", "wheel")
RATE = 500.0
COUNT = 2000

MJCF = """<mujoco>
  <compiler angle="radian"/>
  <worldbody>
    <body name="arm">
      <joint name="arm" type="hinge" axis="0 1 0" range="-2 2"/>
      <geom size="0.05" mass="1"/>
      <site name="tool" pos="0 0 0.3"/>
    </body>
    <body name="carriage" pos="1 0 0">
      <joint name="rail" type="slide" axis="1 0 0" range="-0.4 0.4"/>
      <geom size="0.05" mass="1"/>
    </body>
    <body name="wheel" pos="2 0 0">
      <joint name="wheel" type="hinge" axis="0 1 0"/>
      <geom size="0.05" mass="1"/>
    </body>
    <body name="extra" pos="3 0 0">
      <freejoint name="floating"/>
      <geom size="0.05" mass="1"/>
    </body>
  </worldbody>
</mujoco>
"""

ROBOT = """name = "bench_robot"
model = "robot.xml"

[[actuators]]
joint = "arm"
gain = 3.0
gain_unit = "N*m/A"

[[actuators]]
joint = "rail"
gain = 35.0
gain_unit = "N/V"

[[actuators]]
joint = "wheel"
gain = 2.0
gain_unit = "N*m/A"

[tool]
site = "tool"
"""


def time_stamps(count: int = COUNT, rate: float = RATE) -> np.ndarray:
    return np.arange(count) / rate


def movement(time: np.ndarray, seed: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """Positions (N, 3) and currents (N, 3): harmonics of 0.25 Hz and something that resembles dynamics."""
    rng = np.random.default_rng(seed)
    position = np.empty((time.size, 3))
    current = np.empty((time.size, 3))
    for joint, amplitude in enumerate((0.5, 0.08, 0.6)):
        q, qd, qdd = np.zeros((3, time.size))
        for harmonic in range(1, 6):
            omega = 2 * np.pi * 0.25 * harmonic
            a = amplitude * rng.uniform(0.3, 1.0) / harmonic
            phase = omega * time + rng.uniform(0, 2 * np.pi)
            q += a * np.sin(phase)
            qd += a * omega * np.cos(phase)
            qdd -= a * omega**2 * np.sin(phase)
        position[:, joint] = q
        current[:, joint] = 0.3 * qdd + 0.2 * qd + 0.5 * np.sign(qd) + 0.4 * np.cos(q)
    return position, current


def write_robot(folder: Path) -> Path:
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "robot.xml").write_text(MJCF)
    (folder / "robot.toml").write_text(ROBOT)
    return folder


def write_good_dataset(folder: Path) -> Path:
    """A dataset with a CSV, a Parquet file and a payload; its robot lies in the folder `robot` inside."""
    write_robot(folder / "robot")
    time = time_stamps()
    noise = 0.01 * np.random.default_rng(1).standard_normal((COUNT, 3))
    for seed, name in enumerate(("unloaded.csv", "loaded.parquet")):
        position, current = movement(time, seed)
        write_recording(folder / name, time, position, current + noise, JOINTS)
    write_dataset_toml(
        folder,
        "./robot",
        [RecordingEntry("unloaded.csv", "identify"), RecordingEntry("loaded.parquet", "validate", "disc")],
        [Payload("disc", 0.5, np.array([0.0, 0.0, 0.02]), np.array([1e-3, 1e-3, 2e-3, 0.0, 0.0, 0.0]))],
    )
    return folder
