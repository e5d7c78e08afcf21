"""Standard parameters of real bodies that reproduce the identified base parameters: two semidefinite programs.

The first computes the distance, in standard errors, of the nearest bodies with positive definite pseudo-inertias from
the estimate; the second, of all bodies with those base parameters, those nearest to a prior by the entropic divergence
tr(P P0^-1) - log det(P P0^-1), which keeps all of them definite. Sources: Sousa and Cortesao, "Physical feasibility of
robot base inertial parameter identification: A linear matrix inequality approach", International Journal of Robotics
Research 33(6), 2014; Wensing, Kim and Slotine, "Linear matrix inequalities for physically consistent inertial parameter
identification", IEEE Robotics and Automation Letters 3(1), 2018; Lee, Wensing and Park, "Geometric robot dynamic
identification", IEEE Transactions on Robotics 36(2), 2020.
"""

from dataclasses import dataclass, replace

import numpy as np

from bench.basics.chi_squared import exceeded_with
from bench.basics.errors import BenchError
from bench.export.bodies import BodyEquations, equations_of, pseudo_inertia
from bench.export.identified import IdentifiedModel, identified_model
from bench.export.programs import Programs, Reached
from bench.identification.finding import Code, Finding
from bench.identification.layout import payload_parameter_names
from bench.identification.model_file import SavedModel, apply_model
from bench.identification.problem import Problem
from bench.identification.result import Identification, ModelledRecording, Quantity

BY_CHANCE = 1e-3  # probability with which noise alone may call a real body impossible
LEEWAY = 0.5  # standard errors farther than the nearest real bodies, which are at the limit of what is real
EXACT = 0.01  # standard errors: nearer than this, bodies that reproduce the estimate are looked for


@dataclass(frozen=True)
class Contradiction:
    """The data are `distance` standard errors away from any real bodies; noise explains `expected`.

    culprits: single bodies without whose condition the rest could be real, and the remaining distance, the smallest
    first.
    """

    distance: float
    expected: float
    culprits: tuple[tuple[str, float], ...]

    def words(self) -> str:
        """The contradiction in one line."""
        name, remaining = self.culprits[0]
        enough = [body for body, rest in self.culprits if rest <= self.expected]
        who = " or ".join(enough) if enough else f"{name} most of all (without it {remaining:.1f} remain)"
        return (
            f"no real bodies have these base parameters: the nearest are {self.distance:.1f} standard errors away, "
            f"where noise explains {self.expected:.1f}; it is {who} that would need a negative mass or inertia. An "
            "effect may be missing from the model (bench diagnose)"
        )


@dataclass(frozen=True)
class PhysicalSet:
    """Physically possible bodies.

    bodies: standard parameters (10,) in the frame of the joint that moves each; rotors (n,): Ia, kg m2 or kg, in
    actuator order; payloads (10,) in the tool frame. distance: of their base parameters from the identified ones, in
    standard errors, 0 if reproduced; model: the identified model moved there. contradiction: None if noise explains the
    distance. prior: its source, in words.
    """

    bodies: dict[str, np.ndarray]
    rotors: np.ndarray
    payloads: dict[str, np.ndarray]
    distance: float
    model: IdentifiedModel
    contradiction: Contradiction | None
    prior: str
    guessed: tuple[str, ...]


def physical_set(identified: IdentifiedModel, *, use_cad: bool = True) -> PhysicalSet:
    """Of the real bodies with the identified base parameters, those nearest to a prior.

    use_cad: the prior are the masses of the MJCF, which identification never reads; else bars of equal mass. Raises
    BenchError if the solver fails.
    """
    equations = equations_of(identified, use_cad)
    programs = Programs(equations)
    nearest = programs.nearest()
    contradiction = contradiction_of(equations, programs, nearest.distance, nearest.freedom)
    reached, distance = _drawn_to_prior(programs, nearest.distance)
    parameters, rotors = reached
    names = [body.name for body in equations.bodies]
    count = len(identified.model.geometry.bodies)
    for name, values in zip(names, parameters, strict=True):
        if np.linalg.eigvalsh(pseudo_inertia(values))[0] <= 0.0:
            raise BenchError(f"{identified.path}: the solver's {name} is not positive definite")
    return PhysicalSet(
        bodies=dict(zip(names[:count], parameters[:count], strict=True)),
        rotors=rotors,
        payloads=dict(zip(identified.payloads, parameters[count:], strict=True)),
        distance=distance,
        model=identified.moved(programs.estimated_of(parameters, rotors)) if distance else identified,
        contradiction=contradiction,
        prior=equations.prior.source,
        guessed=equations.prior.guessed,
    )


def _drawn_to_prior(programs: Programs, nearest: float) -> tuple[Reached, float]:
    """The bodies nearest to the prior, and how far from the estimate they may be, in standard errors: 0 if they
    reproduce it.

    nearest: distance of the nearest real bodies. On the limit of what is real, none may reproduce the estimate.
    """
    if nearest < EXACT:
        drawn = programs.drawn_to_prior(0.0)
        moved = programs.moved_onto(drawn) if drawn else None
        if moved:
            return moved, 0.0
    distance = nearest + LEEWAY
    drawn = programs.drawn_to_prior(distance)
    if drawn is None:
        raise programs.not_found()
    return drawn, distance


def explained_by_noise(freedom: int) -> float:
    """Distance of an estimate from real bodies by noise alone, in standard errors.

    freedom: number of active conditions of the bodies on the estimate, which noise may violate.
    """
    return float(np.sqrt(exceeded_with(BY_CHANCE, max(freedom, 1))))


def contradiction_of(
    equations: BodyEquations, programs: Programs, distance: float, freedom: int
) -> Contradiction | None:
    """The contradiction, if noise does not explain the distance of the nearest real bodies."""
    expected = explained_by_noise(freedom)
    if distance <= expected:
        return None
    distances = [(body.name, programs.nearest(without=i).distance) for i, body in enumerate(equations.bodies)]
    return Contradiction(distance, expected, tuple(sorted(distances, key=lambda pair: pair[1])))


def physically_consistent(result: Identification, problem: Problem) -> Identification:
    """The answer moved to the nearest one of real bodies, in standard errors; unchanged if it is possible.

    No mass of the MJCF is read. Covariance and standard errors stay those of the unconstrained fit, an upper bound. A
    finding states the distance or, if noise does not explain it, the impossible body. Raises BenchError if base
    parameters were omitted, or the solver fails or is not installed.
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
    moved = with_values(result, identified.moved(nearest.estimated))
    applied = apply_model(problem, replace(saved, model=moved))
    series = {trace.name: trace for trace in applied.recordings}
    recordings = tuple(series[trace.name] for trace in result.recordings)
    return replace(moved, recordings=recordings, error=applied.error, findings=(*result.findings, finding))


def with_values(result: Identification, model: IdentifiedModel) -> Identification:
    """The answer with a model's values."""
    values = dict(zip(model.model.base.names, model.base.tolist(), strict=True))
    for payload, of_payload in model.payloads.items():
        names = payload_parameter_names(payload, np.array([*of_payload]))
        values |= dict(zip(names, of_payload.values(), strict=True))
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
