"""Cost of a report of 60 s at 1 kHz with six motors, and with a workbench of the whole catalogue."""

from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter

from bench.benchmarks.speed.figures import SpeedFigure
from bench.dataset.dataset import Dataset, load_dataset
from bench.diagnosis.reason import Because, Reason
from bench.diagnosis.result import Diagnosis, EffectVerdict, LadderStep, Remainder, Unexplained
from bench.diagnosis.unexplained import relative_noise_floor
from bench.effects import CATALOGUE
from bench.identification.identify import identify
from bench.identification.prepare import prepare
from bench.identification.problem import problem_of
from bench.page.folder import read_run
from bench.page.section_run import CommandRun
from bench.page.write import write_diagnosis_report, write_saved_run
from bench.scenario.file import find_scenario, read_with_bases
from bench.scenario.scenario import load_scenario, resolve_trajectories
from bench.truth.dataset import write_simulation
from bench.truth.simulate import simulate

ROBOT = "stewart"
LIMIT = 15.0  # s
AGAIN_LIMIT = 2.0  # s
DURATION = 20.0  # s, of each of three recordings
HIDDEN = (
    {"effect": "coulomb_friction", "Fc": 8.0},
    {"effect": "viscous_friction", "joint": "axis_2", "Fv": 40.0},
)
MISSING = ("coulomb_friction", "viscous_friction:axis_2")
ABSORBED = ("payload_mass_error", "rotor_inertia")


def six_motors(folder: Path, duration: float = DURATION) -> Dataset:
    """Simulated recordings of `duration` s of the hexapod with friction, written into the folder: two and a check."""
    recordings = read_with_bases(find_scenario(ROBOT))["recordings"][:3]
    changes = {
        "design": {"optimise": False, "duration": duration},
        "recordings": recordings,
        "hidden": HIDDEN,
    }
    scenario = load_scenario(ROBOT, changes)
    write_simulation(simulate(scenario, resolve_trajectories(scenario)), folder / "data")
    return load_dataset(folder / "data")


def stand_in_diagnosis(dataset: Dataset) -> Diagnosis:
    """A diagnosis that names the hidden effects, made without a search, with all effects in its ranking."""
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


def report_figures() -> list[SpeedFigure]:
    """Time to write the report of a diagnosis of a robot with six motors: first, and again from its folder."""
    with TemporaryDirectory() as name:
        folder = Path(name)
        dataset = six_motors(folder)
        diagnosis = stand_in_diagnosis(dataset)
        start = perf_counter()
        write_diagnosis_report(folder / "out", diagnosis, dataset, CommandRun("diagnose", "data"))
        written = perf_counter()
        write_saved_run(folder / "again.html", read_run(folder / "out"), folder / "out")
        again = perf_counter()
    return [
        SpeedFigure("report of 60 s of six motors", written - start, "s", LIMIT),
        SpeedFigure("report of a finished diagnosis", again - written, "s", AGAIN_LIMIT),
    ]
