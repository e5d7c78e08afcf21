"""Identification with bodies that can exist: least squares under the condition that pseudo-inertias are definite.

The fit's least squares, (x - x0)' S^-1 (x - x0) of all unknowns x about the unconstrained estimate x0 with its
covariance S, is made small over all x whose base parameters some set of real bodies has. That is a semidefinite
program: Sousa and Cortesao, "Physical feasibility of robot base inertial parameter identification: A linear matrix
inequality approach", International Journal of Robotics Research 33(6), 2014. Gains and effects go along as S says.
"""

from dataclasses import replace

from bench.basics.errors import BenchError
from bench.export.bodies import equations_of
from bench.export.identified import IdentifiedModel, identified_model
from bench.export.physical import EXACT, contradiction_of, explained_by_noise
from bench.export.programs import Programs
from bench.identification.finding import Code, Finding
from bench.identification.model_file import SavedModel, apply_model
from bench.identification.problem import Problem
from bench.identification.result import Identification, ModelledRecording, Quantity


def physically_consistent(result: Identification, problem: Problem) -> Identification:
    """The answer moved to the nearest that real bodies give, in standard errors; as it is where it is one already.

    No mass of the MJCF is read. Covariance and standard errors stay those of the fit without the condition, and are
    no larger with it. A finding tells the distance, or which body could not be real where noise does not explain it.
    Raises BenchError where base parameters were omitted, or the solver fails or is not installed.
    """
    if result.left_out:
        raise BenchError("real bodies need all base parameters: identify without --essential")
    dataset = problem.dataset
    modelled = tuple(ModelledRecording(trace.name, trace.use, trace.payload) for trace in result.recordings)
    saved = SavedModel(dataset.folder, result, dataset.folder, modelled)
    identified = identified_model(dataset.folder, saved, dataset.robot, dataset.payloads, problem.catalogue)
    equations = equations_of(identified, use_cad=False)
    programs = Programs(equations)
    nearest = programs.nearest()
    if nearest.distance < EXACT:
        finding = Finding(Code.PHYSICAL, numbers={"distance": 0.0})
        return replace(result, findings=(*result.findings, finding))
    wrong = contradiction_of(equations, programs, nearest.distance, nearest.freedom)
    numbers = {"distance": nearest.distance, "expected": explained_by_noise(nearest.freedom)}
    if wrong is None:
        finding = Finding(Code.PHYSICAL, numbers=numbers)
    else:
        finding = Finding(Code.NOT_REAL, (wrong.culprits[0][0],), numbers=numbers)
    moved = _with_values(result, identified.moved(nearest.estimated))
    applied = apply_model(problem, replace(saved, model=moved))
    series = {trace.name: trace for trace in applied.recordings}
    recordings = tuple(series[trace.name] for trace in result.recordings)
    return replace(moved, recordings=recordings, error=applied.error, findings=(*result.findings, finding))


def _with_values(result: Identification, model: IdentifiedModel) -> Identification:
    """The answer with a model's values."""
    names = list(model.model.base.names)
    values = dict(zip(names, model.base.tolist(), strict=True))
    loads = [value for each in model.payloads.values() for value in each.values()]
    values |= dict(
        zip(
            [parameter.name for parameter in result.parameters if parameter.name not in values],
            loads,
            strict=True,
        )
    )
    parameters = tuple(
        replace(parameter, value=float(values[parameter.name])) for parameter in result.parameters
    )
    gains = {
        joint: replace(drive_gain, value=float(value))
        for (joint, drive_gain), value in zip(result.drive_gains.items(), model.gains, strict=True)
    }
    effects: dict[str, dict[str, dict[str, Quantity]]] = {
        effect: {place: dict(values) for place, values in places.items()}
        for effect, places in result.effect_parameters.items()
    }
    for each in model.effects:
        at = effects[each.name][each.instance.place]
        for name, value in each.values.items():
            at[name] = replace(at[name], value=float(value))
    return replace(result, parameters=parameters, drive_gains=gains, effect_parameters=effects)
