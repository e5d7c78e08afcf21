"""From a dataset to equations: model, filters, and every recording as rows."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from bench.basics.errors import BenchError
from bench.basics.threads import on_one_thread
from bench.dataset.dataset import Dataset
from bench.dataset.recording import Recording
from bench.effects import EffectInstance, RobotSignals, places_in, select_effects
from bench.identification.effect_columns import PresentModel, declared_parameters, robot_signals
from bench.identification.effect_rows import effect_rows
from bench.identification.filtered import (
    Measured,
    contradicted_closures,
    logged_velocities,
    measure,
    velocity_noise,
)
from bench.identification.finding import Finding
from bench.identification.fixed_columns import FixedColumns
from bench.identification.fixed_scale import recorded_states, scale_of
from bench.identification.layout import ParameterLayout, parameter_layout, payload_columns
from bench.identification.observation import Observation, observe
from bench.identification.perturbations import Nearby
from bench.identification.problem import Problem
from bench.identification.scale import NOT_WANTED, Scale
from bench.identification.scale_words import refusal
from bench.identification.solution import NominalGains
from bench.model.model import IdentificationModel, build_model
from bench.signals.settings import Bands, FilterSettings, completed, signal_bands


@dataclass(frozen=True)
class Prepared:
    """A dataset prepared for a fit: the model, the filters, and every recording as equations.

    measured and observations belong together, one per usable recording. present: the model about which effects are
    linearised; signals: their inputs from each recording. scale: which drive gains are unknowns, and what keeps the
    others nominal. converged: whether nonlinear effects have their shape and are linearised about this very model;
    nearby: source of small changes of the torque, in place of exact ones. contradicted: loop closures that other
    encoders contradict. bands: from the spectra of the recordings to identify from, None if not computed. rejected:
    filters rejected for narrower ones, the widest first. halved: the same recordings in half of the band, if known.
    kept: what models of these recordings share.
    """

    dataset: Dataset
    model: IdentificationModel
    settings: FilterSettings
    effects: tuple[EffectInstance, ...]
    measured: tuple[Measured, ...]
    observations: tuple[Observation, ...]
    layout: ParameterLayout
    present: PresentModel
    signals: tuple[RobotSignals, ...]
    scale: Scale = NOT_WANTED
    converged: bool = False
    nearby: Nearby | None = None
    contradicted: tuple[Finding, ...] = ()
    bands: Bands | None = None
    rejected: tuple[FilterSettings, ...] = ()
    halved: "Prepared | None" = field(default=None, compare=False, repr=False)
    kept: dict[str, FixedColumns | None] = field(default_factory=dict, compare=False, repr=False)

    @property
    def gains(self) -> NominalGains:
        """The declared drive gains, and whether they are unknowns."""
        robot = self.dataset.robot
        return NominalGains(robot.nominal_gains, self.scale.fitted(robot.joints))

    @property
    def fit_gains(self) -> bool:
        """Whether any drive gain is an unknown."""
        return bool(np.any(self.gains.fitted))

    @property
    def unusable(self) -> tuple[str, ...]:
        """Recordings whose payload is neither declared in full nor carried by a fitted recording."""
        used = {observation.name for observation in self.observations}
        return tuple(recording.name for recording in self.dataset.recordings if recording.name not in used)

    @property
    def logs(self) -> tuple[str, ...]:
        """Names of the fitted recordings, each with a value of some effects."""
        return logs_of([entry.recording for entry in self.measured if entry.recording.use == "identify"])

    @property
    def fitted(self) -> tuple[Observation, ...]:
        """The observations of recordings to identify from."""
        return tuple(observation for observation in self.observations if observation.use == "identify")

    @property
    def fitted_signals(self) -> tuple[RobotSignals, ...]:
        """The same recordings as effects see them."""
        return tuple(
            signals
            for signals, entry in zip(self.signals, self.measured, strict=True)
            if entry.recording.use == "identify"
        )


@on_one_thread
def prepare(problem: Problem, *, fitted_only: bool = True, logs: Sequence[str] | None = None) -> Prepared:
    """Build the model and turn every recording into equations, filtered and decimated alike.

    The filters and the unknown payload parameters follow from the recordings to fit, or (not `fitted_only`) from all. A
    recording whose payload no such recording carries is excluded, unless all parameters of the payload are declared.
    logs: those for which effects may have a value each; by default the fitted ones. Raises BenchError naming what is
    unusable in the data or the robot.
    """
    dataset, filters = problem.dataset, problem.filters
    fitted = [recording for recording in dataset.recordings if recording.use == "identify" or not fitted_only]
    if not fitted:
        raise BenchError(f'{dataset.folder}: no recording has use = "identify"')
    model = build_model(dataset.robot)
    weighed = dataset.weighed
    each = logs_of(fitted) if logs is None else logs
    instances = select_effects(problem.effects, places_in(model.geometry, weighed), problem.catalogue, each)
    bands = None
    if isinstance(filters, FilterSettings):
        settings = filters
    else:
        positions, currents = [entry.position for entry in fitted], [entry.current for entry in fitted]
        bands = signal_bands(positions, currents, fitted[0].rate)
        settings = completed(filters or {}, positions, currents, fitted[0].rate, bands)
        velocities = [logged_velocities(entry, dataset.robot.joints, settings) for entry in fitted]
        if any(velocity.taken for every in velocities for velocity in every.values()):
            noise = [velocity_noise(dataset.robot.joints, every) for every in velocities]
            bands = signal_bands(positions, currents, fitted[0].rate, noise)
            settings = completed(filters or {}, positions, currents, fitted[0].rate, bands)
    carried = [entry.payload for entry in fitted]
    declared = [
        name for name, payload in dataset.payloads.items() if not len(payload_columns(payload).unknown)
    ]
    layout = parameter_layout(model, dataset.payloads, [*carried, *declared], 0)
    if any(name in weighed for name in carried):
        layout = replace(layout, redundant=len(dataset.robot.redundant))
    usable = [
        recording
        for recording in dataset.recordings
        if recording.payload is None or recording.payload in layout.payloads
    ]
    measured = tuple(measure(model, recording, settings) for recording in usable)
    present = _first_model(dataset, model, measured)
    prepared = Prepared(
        dataset=dataset,
        model=model,
        settings=settings,
        effects=(),
        measured=measured,
        observations=tuple(observe(model, entry) for entry in measured),
        layout=layout,
        present=present,
        signals=tuple(robot_signals(model, entry, present) for entry in measured),
        contradicted=contradicted_closures(model.geometry, measured),
        bands=bands if fitted_only else None,
    )
    return with_gains(with_effects(prepared, instances), problem.fit_gains if fitted_only else False)


def with_gains(prepared: Prepared, wanted: bool | None) -> Prepared:
    """The same with drive gains as unknowns or not; by default, those that the declared payloads fix.

    Raises BenchError if they are wanted and none is fixed.
    """
    if wanted is False:
        return replace(prepared, scale=NOT_WANTED)
    dataset = prepared.dataset
    scale = scale_of(prepared.model, dataset.payloads, recorded_states(prepared.fitted))
    if wanted and not np.any(scale.fitted(dataset.robot.joints)):
        raise BenchError(f"{dataset.folder}: {refusal(scale)}")
    return replace(prepared, scale=scale)


def logs_of(recordings: Sequence[Recording]) -> tuple[str, ...]:
    """The logs of recordings or of parts of them, each once."""
    return tuple(dict.fromkeys(recording.log for recording in recordings))


def with_effects(
    prepared: Prepared,
    effects: Sequence[EffectInstance],
    present: PresentModel | None = None,
    *,
    fitted_only: bool = False,
) -> Prepared:
    """The same recordings with the columns of these effects, linearised about another model where given.

    fitted_only: recordings that are not fitted get none, if nothing is judged on them.
    """
    signals = prepared.signals
    if present is None or present is prepared.present:
        present = prepared.present
    else:
        signals = tuple(robot_signals(prepared.model, entry, present) for entry in prepared.measured)
        if prepared.nearby is not None:
            signals = prepared.nearby.signals(present, signals)
    decimation = prepared.settings.decimation
    observations = tuple(
        replace(
            observation,
            effects=effect_rows(
                seen, decimation, () if fitted_only and observation.use != "identify" else effects
            ),
        )
        for seen, observation in zip(signals, prepared.observations, strict=True)
    )
    count = sum(len(effect.effect.parameters) for effect in effects)
    layout = replace(prepared.layout, effects=count)
    return replace(
        prepared,
        effects=tuple(effects),
        observations=observations,
        layout=layout,
        present=present,
        signals=signals,
        converged=False,
    )


def with_judged(prepared: Prepared) -> Prepared:
    """The same, with the effects' columns also for recordings that are not fitted."""
    decimation, effects = prepared.settings.decimation, prepared.effects
    observations = tuple(
        observation
        if observation.use == "identify"
        else replace(observation, effects=effect_rows(seen, decimation, effects))
        for seen, observation in zip(prepared.signals, prepared.observations, strict=True)
    )
    return replace(prepared, observations=observations)


def seen_nearby(prepared: Prepared, nearby: Nearby) -> Prepared:
    """The same with small changes of the torque from `nearby`."""
    signals = nearby.signals(prepared.present, prepared.signals)
    return replace(prepared, signals=signals, nearby=nearby, converged=False)


def _first_model(dataset: Dataset, model: IdentificationModel, measured: Sequence[Measured]) -> PresentModel:
    """Nominal gains and guessed masses, until a fit has better ones."""
    fitted = [entry for entry in measured if entry.recording.use == "identify"] or list(measured)
    declared = declared_parameters(dataset.payloads)
    extra = model.geometry.redundant
    speeds = [
        np.hstack((entry.velocity, entry.tree.v[:, extra])) if len(extra) else entry.velocity
        for entry in fitted
    ]
    return PresentModel(
        gains=dataset.robot.nominal_gains,
        base=model.guessed,
        payloads=declared,
        declared=declared,
        speeds=np.sqrt(np.concatenate([values**2 for values in speeds]).mean(axis=0)),
        redundant_gains=np.array([entry.gain for entry in dataset.robot.redundant]),
    )
