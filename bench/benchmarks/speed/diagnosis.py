"""Cost of a diagnosis as a user types it, start-up and law search included: time, processor time, memory, and several
at once.
"""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from bench.benchmarks.measured_data import measured_data
from bench.benchmarks.speed import report
from bench.benchmarks.speed.one_command import Cost, cost_of, costs_at_once
from bench.excitation.scenario import designer
from bench.scenario.file import find_scenario, read_with_bases
from bench.scenario.scenario import resolve_trajectories, scenario_from_dict
from bench.truth.dataset import write_simulation
from bench.truth.simulate import simulate

DURATION, SHORT, HEXAPOD = 24.0, 14.0, 10.0  # s, of a recording
BUSY = 1.2  # processor time over wall time
AT_ONCE = 1.7  # time of three diagnoses started at once over that of two, on two cores
REPEATS = 3  # the shortest counts: other processes only slow it down
MEGABYTES = 400.0  # of the hexapod's diagnosis
Hidden = Sequence[Mapping[str, Any]]
OFFSET_AND_FRICTION: Mapping[str, Hidden] = {
    "five_bar": (
        {"effect": "coulomb_friction", "Fc": 0.2},
        {"effect": "encoder_offset", "joint": "left", "offset": 0.02},
    ),
    "delta": (
        {"effect": "coulomb_friction", "Fc": 1.0},
        {"effect": "encoder_offset", "joint": "motor_1", "offset": 0.02},
    ),
}
"""A linear effect, and one whose columns depend on the model and are recomputed in every round."""
ONE: Hidden = ({"effect": "coulomb_friction", "Fc": 0.3},)
THREE: Hidden = (
    *ONE,
    {"effect": "cogging_torque", "a": 0.1, "b": 0.05, "period": 0.52},
    {"effect": "viscous_friction", "Fv": 0.15},
)
TWO_LOGS = "diagnose two recordings of 24 s"
THREE_LOGS = f"{TWO_LOGS} and one of 14 s"
SIMULATED: Sequence[tuple[str, float, str, Hidden]] = (
    (f"{TWO_LOGS}, five_bar", 1.5, "five_bar", ()),
    (f"{TWO_LOGS}, delta", 3.0, "delta", ()),
    (f"{TWO_LOGS}, five_bar with two hidden effects", 1.8, "five_bar", OFFSET_AND_FRICTION["five_bar"]),
    (f"{TWO_LOGS}, delta with two hidden effects", 4.0, "delta", OFFSET_AND_FRICTION["delta"]),
    (f"{THREE_LOGS}, three_rrr with one hidden effect", 3.5, "three_rrr", ONE),
    (f"{THREE_LOGS}, three_rrr with three hidden effects", 6.0, "three_rrr", THREE),
)
"""Name of the figure, its limit in s, robot, and hidden effects."""


def simulated(folder: Path, robot: str, hidden: Hidden, *, checked: bool) -> Path:
    """Write a dataset from a robot's scenario with effects that no model contains; return its folder.

    The fitted recordings and, if `checked`, one for validation.
    """
    content = dict(read_with_bases(find_scenario(robot)))
    content["hidden"] = list(hidden)
    content["design"] = {**content["design"], "duration": DURATION}
    fitted = [recording for recording in content["recordings"] if recording["use"] == "identify"]
    others = [recording for recording in content["recordings"] if recording["use"] == "validate"][
        : int(checked)
    ]
    shorter = [{**other, "design": {**other["design"], "duration": SHORT}} for other in others]
    content["recordings"] = [*fitted, *shorter]
    scenario = scenario_from_dict(content, robot)
    write_simulation(simulate(scenario, resolve_trajectories(scenario, designer)), folder)
    return folder


def cases(folder: Path) -> Iterator[tuple[str, float, Path]]:
    """Name, limit in s, and dataset of every case; the measured one only if its data are available."""
    for i, (name, limit, robot, hidden) in enumerate(SIMULATED):
        yield name, limit, simulated(folder / str(i), robot, hidden, checked="three_rrr" in robot)
    yield "diagnose three recordings of 10 s, stewart", 8.0, report.six_motors(folder, HEXAPOD).folder
    measured = measured_data() / "ur10e"
    if measured.is_dir():
        yield "diagnose four measured logs, six-axis arm", 15.0, measured


def costs() -> Iterator[tuple[str, float, Cost]]:
    """Name, limit in s and cost of every case."""
    with TemporaryDirectory() as folder:
        for name, limit, dataset in cases(Path(folder)):
            yield name, limit, cost_of("diagnose", str(dataset))


def identification() -> Cost:
    """The cost of an identification of a five-bar."""
    with TemporaryDirectory() as folder:
        return cost_of("identify", str(simulated(Path(folder) / "data", "five_bar", (), checked=False)))


def three_over_two() -> float:
    """Time of three simultaneous diagnoses over that of two; the shortest of `REPEATS` each, alternating."""
    with TemporaryDirectory() as folder:
        hidden = OFFSET_AND_FRICTION["five_bar"]
        dataset = simulated(Path(folder) / "data", "five_bar", hidden, checked=False)
        times: dict[int, list[float]] = {2: [], 3: []}
        for count in (2, 3) * REPEATS:
            together = costs_at_once([["diagnose", str(dataset)]] * count)
            times[count].append(max(cost.seconds for cost in together))
    return min(times[3]) / min(times[2])
