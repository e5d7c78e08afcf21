"""Plan an experiment: the motions, their expected accuracy, and the comparison with random motions."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from bench.basics.errors import BenchError
from bench.basics.mapper import IN_TURN, Mapper
from bench.basics.progress import SILENT, Progress
from bench.basics.threads import on_one_thread
from bench.dataset.names import Use
from bench.dataset.payload import Payload
from bench.dataset.robot import Robot, refuse_redundant
from bench.effects import CATALOGUE, Effect, EffectInstance, places_in, select_effects
from bench.effects.select import parameter_slices
from bench.excitation.bounds import SEARCH
from bench.excitation.experiment.covariance import RelativeErrors, Volume
from bench.excitation.experiment.descent import best_near
from bench.excitation.experiment.nominal import Evidence, Noise, Nominal, reference_sizes, seen
from bench.excitation.experiment.request import (
    PAYLOAD,
    ExperimentTable,
    asked_payload,
    joint_values,
)
from bench.excitation.experiment.room import Room, room_of
from bench.excitation.experiment.search import (
    Candidate,
    Proven,
    Search,
    Shape,
    Tried,
    all_proven,
    check_proven_at_home,
    check_standing,
    random_candidates,
)
from bench.export.bodies import cad_prior
from bench.identification.finding import Finding
from bench.identification.fixed_scale import random_states, scale_of
from bench.identification.layout import parameter_layout
from bench.identification.scale_words import scale_findings, scale_sentence
from bench.model.model import IdentificationModel, build_model
from bench.scenario.trajectory import FourierTrajectory

Criterion = Literal["worst", "d-optimal"]
ALL, GAINS, PARAMETERS = "all", "gains", "parameters"
NAMES = ("unloaded", "loaded")


@dataclass(frozen=True)
class Aim:
    """What to minimise, and how.

    wanted: "all" (gains and base parameters), "gains", "parameters", or effects as EFFECT or EFFECT:JOINT. criterion:
    the largest relative standard error, or the volume of the error ellipsoid.
    """

    wanted: tuple[str, ...] = (ALL,)
    criterion: Criterion = "worst"
    steps: int = SEARCH.steps
    seed: int = 0

    @property
    def effects(self) -> tuple[str, ...]:
        """The effects among what is wanted."""
        return tuple(name for name in self.wanted if name not in (ALL, GAINS, PARAMETERS))


WHOLE = Aim()


@dataclass(frozen=True)
class PlannedRecording:
    """A planned recording: its use, its payload or None, its motion with the proof that it keeps all limits."""

    name: str
    use: Use
    payload: str | None
    proven: Proven

    @property
    def trajectory(self) -> FourierTrajectory:
        """The motion of the motors."""
        return self.proven.tried.trajectory


@dataclass(frozen=True)
class ExperimentPlan:
    """An experiment. names, motions, proofs: of every recording to fit, its name, its motion, and the proof that this
    keeps all limits; checks: other motions with the same payloads, to judge on; sizes (P,): to which standard errors
    are relative; targets: the wanted unknowns; value: the criterion, relative; random: the same of random motions,
    `best` and `median` of `SEARCH.random`.
    """

    robot: Robot
    nominal: Nominal
    room: Room
    search: Search
    names: tuple[str, ...]
    motions: tuple[Tried, ...]
    proofs: tuple[Proven, ...]
    checks: tuple[Proven, ...]
    sizes: np.ndarray
    targets: np.ndarray
    aim: Aim
    value: float
    random: Mapping[str, float]
    before: float | None = None  # the criterion of existing recordings

    @property
    def recordings(self) -> tuple[PlannedRecording, ...]:
        """All recordings to make, those to fit first."""
        uses: tuple[tuple[Use, str, tuple[Proven, ...]], ...] = (
            ("identify", "", self.proofs),
            ("validate", "_check", self.checks),
        )
        return tuple(
            PlannedRecording(f"{name}{suffix}", use, load, proof)
            for use, suffix, proofs in uses
            for name, load, proof in zip(self.names, self.search.loads, proofs, strict=True)
        )


@dataclass(frozen=True)
class Started:
    """A search, and starting motions: random, and with few harmonics."""

    search: Search
    random: list[Candidate]
    sparse: list[Candidate]


def nominal_machine(
    robot: Robot, table: ExperimentTable, requests: Sequence[str], catalogue: Mapping[str, Effect]
) -> Nominal:
    """The expected machine: masses of the MJCF, nominal gains, the requested payload.

    Raises BenchError for a payload that fixes no drive gain, whatever the motion.
    """
    refuse_redundant(robot, "a planned experiment")
    model = build_model(robot)
    payload = asked_payload(robot, table.payload)
    payloads: dict[str, Payload] = {} if payload is None else {PAYLOAD: payload}
    scale = _open_scale(model, payloads)
    effects = select_effects(requests, places_in(model.geometry, tuple(payloads)), catalogue)
    check_linear(effects)
    prior = cad_prior(model.geometry)
    count = sum(len(instance.effect.parameters) for instance in effects)
    layout = parameter_layout(model, payloads, [None, *payloads], count)
    return Nominal(
        model=model,
        base=model.base.grouping @ prior.parameters + model.base.rotors @ prior.rotors,
        gains=robot.nominal_gains,
        payloads=payloads,
        layout=layout,
        effects=effects,
        gains_fitted=payload is not None and scale is None,
        scale=scale,
        noise=noise_of(robot, table),
        source=f"{prior.source} and nominal gains",
    )


def _open_scale(model: IdentificationModel, payloads: Mapping[str, Payload]) -> Finding | None:
    """Why the payloads leave all drive gains open, and what would fix them; None where they fix some."""
    if not payloads:
        return None
    scale = scale_of(model, payloads, random_states(model, [None, *payloads]))
    if np.any(scale.fitted(model.geometry.robot.joints)):
        return None
    (finding,) = scale_findings(scale)
    return finding


def noise_of(robot: Robot, table: ExperimentTable) -> Noise:
    """The expected noise of the log."""
    sensors, joints = table.sensors, robot.joints
    current = None
    if sensors.current_noise is not None:
        current = joint_values("sensors.current_noise", sensors.current_noise, joints)
        if np.any(current <= 0.0):
            raise BenchError(
                "sensors.current_noise: must be greater than 0: without noise nothing has a standard error"
            )
    encoder = joint_values("sensors.encoder_resolution", sensors.encoder_resolution, joints)
    return Noise(current, sensors.current_noise_ratio, encoder, table.rate)


def check_linear(effects: Sequence[EffectInstance]) -> None:
    """Raise BenchError for an effect with nonlinear parameters."""
    for instance in effects:
        if instance.effect.shape:
            names = ", ".join(shape.name for shape in instance.effect.shape)
            raise BenchError(
                f"effect {instance.request!r}: nothing can be told of it before there are data, {names} "
                "is not linear: plan for the linear effect that is most like it"
            )


@on_one_thread
def plan_experiment(
    robot: Robot,
    table: ExperimentTable,
    aim: Aim = WHOLE,
    effects: Sequence[str] = (),
    *,
    catalogue: Mapping[str, Effect] = CATALOGUE,
    mapper: Mapper = IN_TURN,
    progress: Progress = SILENT,
) -> ExperimentPlan:
    """Design motions, without and with the payload, that minimise the standard errors of wanted unknowns.

    effects: further effects of the model, not targets. The plan does not depend on the mapper. Raises BenchError for
    unknown names and limits that leave no room.
    """
    progress.phase("reading the robot")
    nominal = nominal_machine(robot, table, [*effects, *aim.effects], catalogue)
    room = room_of(nominal.model.geometry, table)
    loads: tuple[str | None, ...] = (None, *nominal.payloads)
    begun = started(nominal, room, shape_of(room, table), loads, aim, mapper=mapper, progress=progress)
    return searched(robot, begun, NAMES[: len(loads)], aim, mapper, progress)


def searched(
    robot: Robot, begun: Started, names: tuple[str, ...], aim: Aim, mapper: Mapper, progress: Progress
) -> ExperimentPlan:
    """The best motions that a search finds, one for each name."""
    search = begun.search
    progress.phase("improving the best motions", aim.steps)
    best = best_near(search, [*begun.random, *begun.sparse], aim.steps, mapper, progress)
    progress.phase("proving that the limits are kept")
    # of a few random motions that are independent of those of the search, the most informative, to judge the fit on
    others = random_candidates(search, SEARCH.validation, aim.seed, stream=2, mapper=mapper)
    both = [*best, *min(others, key=search.value)]
    proven = all_proven(search, list(zip(both, 2 * search.loads, strict=True)), mapper)
    proofs, checks = proven[: len(best)], proven[len(best) :]
    motions = tuple(proof.tried for proof in proofs)
    values = sorted(map(search.value, begun.random))
    return ExperimentPlan(
        robot=robot,
        nominal=search.nominal,
        room=search.room,
        search=search,
        names=names,
        motions=motions,
        proofs=proofs,
        checks=checks,
        sizes=search.errors.sizes,
        targets=search.errors.targets,
        aim=aim,
        value=search.value(motions),
        random={"best": values[0], "median": float(np.median(values))},
    )


def started(
    nominal: Nominal,
    room: Room,
    shape: Shape,
    loads: tuple[str | None, ...],
    aim: Aim,
    *,
    known: tuple[Evidence, ...] = (),
    sizes: np.ndarray | None = None,
    mapper: Mapper = IN_TURN,
    progress: Progress = SILENT,
) -> Started:
    """The search with random starting motions."""
    measure = RelativeErrors if aim.criterion == "worst" else Volume
    targets = targets_of(nominal, aim.wanted)
    first = Search(nominal, room, shape, loads, known, measure(np.ones(nominal.size), targets))
    check_standing(first)
    check_proven_at_home(first)
    progress.phase("trying motions at random", 2 * SEARCH.random)
    starts = random_candidates(first, SEARCH.random, aim.seed, mapper=mapper, progress=progress)
    sparse = random_candidates(first, SEARCH.random, aim.seed, few=True, mapper=mapper, progress=progress)
    if sizes is None:  # by a few random motions
        few = [zip(candidate, loads, strict=True) for candidate in starts[: SEARCH.torque_motions]]
        looked_at = [seen(nominal, trial.motion, load) for candidate in few for trial, load in candidate]
        sizes = reference_sizes(nominal, looked_at)
    search = Search(nominal, room, shape, loads, known, measure(sizes, targets))
    return Started(search, starts, sparse)


def shape_of(room: Room, table: ExperimentTable) -> Shape:
    """Without a given base frequency, the highest harmonic is that at which a sine of the largest speed has the largest
    acceleration, in the median of the joints; at least one period fits into the motion.
    """
    if 2.0 * table.ramp > table.duration:
        raise BenchError(f"duration: {table.duration:g} s is too short for two ramps of {table.ramp:g} s")
    if table.base_frequency is not None:
        frequency = lowest = highest = table.base_frequency
    else:
        top = float(np.median(room.acceleration / room.velocity)) / (2.0 * np.pi)
        frequency = max(top / table.harmonics, 1.0 / table.duration)
        lowest = max(frequency / SEARCH.frequency_range, 1.0 / table.duration)
        highest = SEARCH.frequency_range * frequency
    if SEARCH.table_points * highest * table.harmonics > table.rate:
        raise BenchError(
            f"rate: {table.rate:g} Hz is too slow for a motion of up to {highest * table.harmonics:.3g} Hz"
        )
    return Shape(table.harmonics, frequency, lowest, highest, table.duration, table.ramp)


def targets_of(nominal: Nominal, wanted: Sequence[str]) -> np.ndarray:
    """Indices of the target unknowns. Raises BenchError for gains whose scale no payload fixes."""
    layout = nominal.layout
    gains = np.arange(layout.size, nominal.size)
    indices: list[int] = []
    for name in wanted:
        if name == GAINS and not nominal.gains_fitted:
            if nominal.scale is not None:
                raise BenchError(
                    f"{PAYLOAD}: the drive gains cannot be planned for: {scale_sentence(nominal.scale)}"
                )
            raise BenchError("the drive gains cannot be identified without a payload of known mass: give one")
        if name in (ALL, PARAMETERS):
            indices += range(layout.base)
        if name in (ALL, GAINS):
            indices += gains.tolist()
        for instance, part in parameter_slices(nominal.effects):
            if instance.request == name:
                first = layout.effect_slice.start
                indices += range(first + part.start, first + part.stop)
    return np.unique(indices)
