"""Solutions of a problem by this program: with everything identified, and with all but two masses known."""

import time
from dataclasses import dataclass, replace

import numpy as np

from bench.benchmarks.peers.problems import UNKNOWN_BODIES, PeerProblem
from bench.dataset.dataset import Dataset
from bench.identification.estimators import DEFAULT_METHOD
from bench.identification.identify import identify
from bench.identification.prepare import prepare
from bench.identification.problem import problem_of
from bench.identification.result import Identification
from bench.model.model import IdentificationModel, build_model
from bench.studies.sweep.accuracy import true_base_parameters
from bench.truth.dataset import as_dataset
from bench.truth.report import truth


@dataclass(frozen=True)
class Answer:
    """Estimates of gains (n,) and masses (2,) with standard deviations; None if the method does not give them."""

    solver: str
    seconds: float
    gains: np.ndarray
    gain_stds: np.ndarray | None
    masses: np.ndarray | None
    mass_stds: np.ndarray | None


def solve_all_unknown(problem: PeerProblem, effects: tuple[str, ...] = ()) -> tuple[Answer, Identification]:
    """Gains and all base parameters from only the measurements and the payload."""
    name = "parabench" + (f", with {' + '.join(effects)}" if effects else "")
    return _identified(as_dataset(problem.simulation), effects, name)


def solve_output_error(problem: PeerProblem, effects: tuple[str, ...] = ()) -> Answer:
    """As `solve_all_unknown`, by output error, with the control law and references that mujoco.sysid also receives."""
    simulation = problem.simulation
    settings = simulation.scenario.settings
    controller = settings.controller.model_copy(update={"declared": True})
    scenario = replace(simulation.scenario, settings=settings.model_copy(update={"controller": controller}))
    name = "parabench, output error" + (f", with {' + '.join(effects)}" if effects else "")
    return _identified(as_dataset(replace(simulation, scenario=scenario)), effects, name, "oe")[0]


def _identified(
    dataset: Dataset, effects: tuple[str, ...], name: str, method: str = DEFAULT_METHOD
) -> tuple[Answer, Identification]:
    start = time.process_time()
    result = identify(prepare(problem_of(dataset, effects)), method)
    seconds = time.process_time() - start
    gains = list(result.drive_gains.values())
    values, stds = (np.array([getattr(gain, key) for gain in gains]) for key in ("value", "std"))
    return Answer(name, seconds, values, stds, None, None), result


def solve_mass_known(problem: PeerProblem) -> Answer:
    """Gains and all base parameters from only the measurements and the payload's mass."""
    dataset = as_dataset(problem.simulation)
    payloads = {
        name: replace(payload, center_of_mass=None, inertia=None)
        for name, payload in dataset.payloads.items()
    }
    return _identified(replace(dataset, payloads=payloads), (), "parabench, payload's mass alone")[0]


def solve_two_masses(problem: PeerProblem, effects: tuple[str, ...] = ()) -> Answer:
    """As `solve_all_unknown`, then the two masses and the gains that fit best with everything else known.

    Base parameters are linear in the masses: generalised least squares with the identified base parameters, their
    covariance, and the known contribution of all other masses.
    """
    everything, result = solve_all_unknown(problem, effects)
    model = build_model(problem.simulation.robot)
    rest, per_mass = _base_of_masses(problem, model)  # known beforehand, from CAD
    start = time.process_time()
    base, gains = len(rest), len(everything.gains)
    kept = [i for i, unknown in enumerate(result.covariance_rows) if i < base or unknown.kind == "gain"]
    covariance = result.covariance[np.ix_(kept, kept)]
    measured = np.concatenate(
        [[parameter.value for parameter in result.parameters[:base]] - rest, everything.gains]
    )
    columns = np.zeros((len(kept), 2 + gains))
    columns[:base, :2] = per_mass
    columns[base:, 2:] = np.eye(gains)
    scale = np.sqrt(np.diag(covariance))
    weight = np.linalg.inv(np.linalg.cholesky(covariance / np.outer(scale, scale)))
    weighted = weight @ (columns / scale[:, None])
    solution = np.linalg.lstsq(weighted, weight @ (measured / scale))[0]
    stds = np.sqrt(np.diag(np.linalg.inv(weighted.T @ weighted)))
    seconds = everything.seconds + time.process_time() - start
    name = everything.solver.replace("parabench", "parabench, rest from CAD")
    return Answer(name, seconds, solution[2:], stds[2:], solution[:2], stds[:2])


def _base_of_masses(problem: PeerProblem, model: IdentificationModel) -> tuple[np.ndarray, np.ndarray]:
    """Base parameters (nb,) without the two masses, and those per kg at the centre of mass of each (nb, 2)."""
    full = true_base_parameters(model, truth(problem.simulation))
    bodies = problem.simulation.machine.models[None]
    points = [
        {name: {"mass": 1.0, "center_of_mass": bodies.body(name).ipos, "inertia": [0.0] * 6}}
        for name in UNKNOWN_BODIES[problem.robot]
    ]
    per_mass = np.column_stack([true_base_parameters(model, {"bodies": p, "joints": {}}) for p in points])
    return full - per_mass @ problem.masses, per_mass
