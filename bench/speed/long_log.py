"""Logs of any length: simulated movements of 20 s, which begin and end at rest, one after the other."""

from pathlib import Path

import numpy as np

from bench.dataset import RecordingEntry, write_dataset_toml
from bench.recording import write_recording
from bench.scenario import Scenario, load_scenario, payload_declared
from bench.truth.sensors import sense
from bench.truth.simulate import simulate

PARTS = 3  # movements that are simulated for each recording; they take turns
PART = 20.0  # s
FRICTION = {
    "effect": "coulomb_friction"
}  # not in the model: the fit's band is then wide, as on a real machine


def write_long_dataset(folder: Path, duration: float, robot: str = "five_bar", friction: float = 0.2) -> Path:
    """A dataset of a robot with dry friction [N*m]: two Parquet logs, unloaded and loaded, of so many seconds.

    Every second of them has noise of its own, though movements repeat.
    """
    scenario, payload = _scenario(robot, friction)
    simulation = simulate(scenario, threads=1)
    rate = 1.0 / scenario.log_period
    samples = round(duration * rate)
    entries = []
    for name, carried in (("unloaded", None), ("loaded", payload)):
        parts = [one for one in simulation.recordings if one.table.payload == carried]
        count = -(-samples // len(parts[0].position))
        position = np.concatenate([_closed(parts[k % PARTS].position) for k in range(count)])[:samples]
        current = np.concatenate([parts[k % PARTS].current for k in range(count)])[:samples]
        log = sense(
            scenario.settings.sensors,
            scenario.robot.joints,
            scenario.settings.seed,
            name,
            np.arange(samples) / rate,
            position,
            current,
        )
        file = f"{name}.parquet"
        folder.mkdir(parents=True, exist_ok=True)
        write_recording(folder / file, log.time, log.position, log.current, scenario.robot.joints)
        entries.append(RecordingEntry(file, "identify", carried))
    declared = payload_declared(payload, scenario.settings.payloads[payload])
    write_dataset_toml(folder, robot, entries, [declared])
    return folder


def _closed(position: np.ndarray) -> np.ndarray:
    """Positions (N, n) that end where they begin: what friction keeps them from is spread over all of them."""
    return position - np.linspace(0.0, 1.0, len(position))[:, None] * (position[-1] - position[0])


def _scenario(robot: str, friction: float) -> tuple[Scenario, str]:
    """So many movements of the robot without its payload, and as many with it."""
    payload = next(iter(load_scenario(robot).settings.payloads))
    recordings = [
        {
            "name": f"{payload}_{k}" if loaded else f"free_{k}",
            "use": "identify",
            "design": {"seed": 2 * k + loaded},
        }
        | ({"payload": payload} if loaded else {})
        for k in range(PARTS)
        for loaded in (False, True)
    ]
    design = {"optimise": False, "duration": PART}
    return load_scenario(
        robot, {"design": design, "recordings": recordings, "hidden": [{**FRICTION, "Fc": friction}]}
    ), payload
