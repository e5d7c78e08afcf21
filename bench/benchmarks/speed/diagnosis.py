"""Cost of a diagnosis against the whole catalogue: time, processor time, memory, and several at once."""

from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter
from typing import Any

from bench.benchmarks.measured_data import measured_data
from bench.benchmarks.speed import report
from bench.benchmarks.speed.one_diagnosis import Cost, cost_alone, cost_of
from bench.dataset.dataset import Dataset, load_dataset
from bench.excitation.scenario import designer
from bench.scenario.file import find_scenario, read_with_bases
from bench.scenario.scenario import resolve_trajectories, scenario_from_dict
from bench.truth.dataset import as_dataset
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
THREE: Hidden = (
    {"effect": "coulomb_friction", "Fc": 0.3},
    {"effect": "cogging_torque", "a": 0.1, "b": 0.05, "period": 0.52},
    {"effect": "viscous_friction", "Fv": 0.15},
)


def simulated(robot: str, hidden: Hidden, *, checked: bool) -> Dataset:
    """A dataset from a robot's scenario with effects that no model contains.

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
    return as_dataset(simulate(scenario, resolve_trajectories(scenario, designer)))


def hexapod(folder: Path) -> Dataset:
    """Three recordings of a platform on six legs; robot and recordings are written into the folder."""
    return report.six_motors(folder, HEXAPOD)


def cases(folder: Path) -> Iterator[tuple[str, float, Dataset]]:
    """Name, limit in s, and dataset of every case; the measured one only if its data are available."""
    for robot, limit in (("five_bar", 1.5), ("delta", 4.0)):
        data = simulated(robot, OFFSET_AND_FRICTION[robot], checked=False)
        yield f"diagnose two recordings of 24 s, {robot}", limit, data
    three = "diagnose two recordings of 24 s and one of 14 s, three_rrr"
    yield three, 4.0, simulated("three_rrr", (), checked=True)
    yield f"{three} with three hidden effects", 8.0, simulated("three_rrr", THREE, checked=True)
    yield "diagnose three recordings of 10 s, hexapod", 10.0, hexapod(folder)
    measured = measured_data() / "ur10e"
    if measured.is_dir():
        yield "diagnose four measured logs, six-axis arm", 15.0, load_dataset(measured)


def costs() -> Iterator[tuple[str, float, Cost]]:
    """Name, limit in s and cost of every case, each in a separate process."""
    with TemporaryDirectory() as folder:
        for name, limit, dataset in cases(Path(folder)):
            yield name, limit, cost_alone(dataset)


def three_over_two() -> float:
    """Time of three simultaneous diagnoses over that of two; the shortest of `REPEATS` each, alternating."""
    dataset = simulated("five_bar", OFFSET_AND_FRICTION["five_bar"], checked=False)
    with _workers(2) as two, _workers(3) as three:
        pools = {2: two, 3: three}
        for count, pool in pools.items():
            list(pool.map(cost_of, [dataset] * count))  # imports and caches
        times: dict[int, list[float]] = {2: [], 3: []}
        for count in (2, 3) * REPEATS:
            start = perf_counter()
            list(pools[count].map(cost_of, [dataset] * count))
            times[count].append(perf_counter() - start)
    return min(times[3]) / min(times[2])


def _workers(count: int) -> ProcessPoolExecutor:
    return ProcessPoolExecutor(count, mp_context=get_context("spawn"))
