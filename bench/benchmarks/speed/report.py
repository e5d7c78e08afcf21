"""Cost of a report: 60 s at 1 kHz of six motors, with a workbench of the whole catalogue."""

from collections.abc import Mapping
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter
from typing import Any

from bench.benchmarks.speed.hexapod import write_hexapod
from bench.dataset.dataset import Dataset, load_dataset
from bench.diagnosis.reason import Because, Reason
from bench.diagnosis.result import Diagnosis, EffectVerdict, LadderStep, Remainder, Unexplained
from bench.diagnosis.unexplained import relative_noise_floor
from bench.effects import CATALOGUE
from bench.excitation.scenario import designer
from bench.identification.identify import identify
from bench.identification.prepare import prepare
from bench.identification.problem import problem_of
from bench.page.folder import read_run
from bench.page.section_run import CommandRun
from bench.page.write import write_diagnosis_report, write_saved_run
from bench.scenario.scenario import resolve_trajectories, scenario_from_dict
from bench.truth.dataset import write_simulation
from bench.truth.simulate import simulate

LIMIT = 15.0  # s
AGAIN_LIMIT = 2.0  # s
DURATION = 20.0  # s, of each of three recordings
MISSING = ("coulomb_friction", "viscous_friction:leg_2")
ABSORBED = ("payload_mass_error", "rotor_inertia")
SCENARIO: Mapping[str, Any] = {
    "seed": 3,
    "gains": {
        "error": {f"leg_{i + 1}": value for i, value in enumerate((0.08, -0.06, 0.05, -0.04, 0.1, -0.09))}
    },
    "payloads": {
        "block": {"mass": 3.0, "center_of_mass": [0.0, 0.0, 0.05], "inertia": [6e-3, 6e-3, 6e-3, 0, 0, 0]}
    },
    "sensors": {"encoder_resolution": 1e-6, "current_noise_ratio": 0.01},
    "design": {
        "harmonics": 8,
        "base_frequency": 0.2,
        "duration": DURATION,
        "span": 0.06,
        "velocity_limit": 0.5,
        "acceleration_limit": 8.0,
    },
    "recordings": [
        {"name": "unloaded", "use": "identify", "design": {"seed": 1}},
        {"name": "loaded", "use": "identify", "payload": "block", "design": {"seed": 2}},
        {"name": "check", "use": "validate", "design": {"seed": 3}},
    ],
    "hidden": [
        {"effect": "coulomb_friction", "Fc": 8.0},
        {"effect": "viscous_friction", "joint": "leg_2", "Fv": 40.0},
    ],
}


def six_motors(folder: Path, duration: float = DURATION) -> Dataset:
    """A platform on six legs, simulated; robot and recordings, of so many s, are written into the folder."""
    content = {**SCENARIO, "robot": str(write_hexapod(folder / "hexapod"))}
    content["design"] = {**content["design"], "duration": duration}
    scenario = scenario_from_dict(content, "hexapod")
    write_simulation(simulate(scenario, resolve_trajectories(scenario, designer)), folder / "data")
    return load_dataset(folder / "data")


def stand_in_diagnosis(dataset: Dataset) -> Diagnosis:
    """What a diagnosis that finds the hidden effects says, without the search: all effects are in its ranking."""
    before, after = identify(prepare(problem_of(dataset))), identify(prepare(problem_of(dataset, MISSING)))
    errors = [(result.error.identify or 0.0, result.error.validate or 0.0) for result in (before, after)]
    missing = tuple(name.partition(":")[0] for name in MISSING)
    ranking = tuple(
        EffectVerdict(
            effect=name,
            verdict="missing" if name in missing else "absorbed" if name in ABSORBED else "not supported",
            error_before=errors[0][1],
            error_after=errors[1][1],
            evidence=1.0,
            actuators=(),
            alternatives=(),
            size={},
            why=Reason(Because.EXPLAINS),
        )
        for name in (*missing, *(name for name in CATALOGUE if name not in missing))
    )
    floor = relative_noise_floor(dataset.recordings, after.recordings, after.settings)
    return Diagnosis(
        robot=dataset.robot.name,
        held_out=0.0,
        missing=missing,
        ladder=(LadderStep((), *errors[0]), LadderStep(missing, *errors[1])),
        ranking=ranking,
        unexplained=Unexplained(Remainder.NOISE, errors[1][1], floor, ()),
        before=before,
        after=after,
    )


def measure() -> tuple[float, float]:
    """Seconds to write the page of a diagnosis that is there, and to write it again from its folder."""
    with TemporaryDirectory() as name:
        folder = Path(name)
        dataset = six_motors(folder)
        diagnosis = stand_in_diagnosis(dataset)
        start = perf_counter()
        write_diagnosis_report(folder / "out", diagnosis, dataset, CommandRun("diagnose", "data"))
        written = perf_counter()
        write_saved_run(folder / "again.html", read_run(folder / "out"), folder / "out")
        return written - start, perf_counter() - written
