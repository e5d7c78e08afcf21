"""A saved model with all that an export needs: its robot, its effects, its covariance."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from bench.basics.errors import BenchError
from bench.basics.files.toml_input import read_toml
from bench.dataset.dataset_toml import DatasetSpec, payload_of
from bench.dataset.names import DATASET_FILE
from bench.dataset.payload import Payload
from bench.dataset.robot import Robot, load_robot, refuse_other_locks, refuse_redundant
from bench.effects import Effect, EffectInstance, catalogue_for, places_in, select_effects
from bench.identification.layout import parameter_layout, payload_columns
from bench.identification.model_file import SavedModel, load_model, with_saved_effects
from bench.model.model import IdentificationModel, build_model
from bench.model.regressor import PARAMETERS


@dataclass(frozen=True)
class EffectValues:
    """One effect at its place, in its shape, with the values of its linear parameters."""

    instance: EffectInstance
    values: Mapping[str, float]

    @property
    def name(self) -> str:
        """The name of the effect."""
        return self.instance.name

    @property
    def place(self) -> str:
        """Joint, body or payload; empty for the whole robot."""
        return self.instance.joint


@dataclass(frozen=True)
class IdentifiedModel:
    """Identified values.

    base (nb,) base parameters; payloads: the estimates of each, by index among its ten standard parameters (empty if
    undeclared ones move no motor); declared: the dataset's declarations; gains (n,) in actuator order. covariance of
    [base, payloads in their order, linear parameters of effects, gains], (k, k); fixed (nb + ...,): base and payload
    parameters omitted as unneeded, zero and without a deviation.
    """

    path: Path
    saved: SavedModel
    robot: Robot
    model: IdentificationModel
    base: np.ndarray
    payloads: Mapping[str, Mapping[int, float]]
    declared: Mapping[str, Payload]
    effects: tuple[EffectValues, ...]
    gains: np.ndarray
    covariance: np.ndarray
    fixed: np.ndarray
    effect_files: tuple[Path, ...] = ()

    @property
    def estimated(self) -> np.ndarray:
        """Base and payload parameters (nz,), in the covariance's order."""
        loads = [value for values in self.payloads.values() for value in values.values()]
        return np.concatenate((self.base, loads))

    def effects_in(self, log: str = "") -> tuple[EffectValues, ...]:
        """The effects in a recording: with its values if it has any, otherwise with their mean."""
        merged: dict[tuple[str, str], EffectValues] = {}
        for effect in self.effects:
            share, key = effect.instance.share(log), (effect.name, effect.place)
            before = merged[key].values if key in merged else dict.fromkeys(effect.values, 0.0)
            values = {name: before[name] + share * value for name, value in effect.values.items()}
            everywhere = effect.instance.everywhere()
            shaped = replace(everywhere, effect=everywhere.effect.about(values))
            merged[key] = EffectValues(shaped, values)
        return tuple(merged.values())

    def moved(self, estimated: np.ndarray) -> "IdentifiedModel":
        """The model with other base and payload parameters (nz,); the rest moves along by the covariance."""
        nz, step = len(estimated), estimated - self.estimated
        std = np.sqrt(np.maximum(np.diag(self.covariance), 0.0))
        free = np.flatnonzero(std[:nz] > 0.0)
        correlation = self.covariance[:nz, :nz][np.ix_(free, free)] / np.outer(std[free], std[free])
        weights = np.linalg.lstsq(correlation, step[free] / std[free], rcond=1e-10)[0] / std[free]
        along = self.covariance[nz:][:, free] @ weights
        effects, start = [], 0
        for effect in self.effects:
            shift = along[start : start + len(effect.values)]
            values = {name: float(v + d) for (name, v), d in zip(effect.values.items(), shift, strict=True)}
            instance = replace(effect.instance, effect=effect.instance.effect.about(values))
            effects.append(EffectValues(instance, values))
            start += len(shift)
        loads, place = {}, len(self.base)
        for name, known in self.payloads.items():
            loads[name] = dict(zip(known, estimated[place : place + len(known)].tolist(), strict=True))
            place += len(known)
        return replace(
            self,
            base=estimated[: len(self.base)],
            payloads=loads,
            effects=tuple(effects),
            gains=self.gains + along[start : start + len(self.gains)],
        )


def load_identified(
    path: str | Path, robot: str | Path | None = None, effect_files: Sequence[Path] = ()
) -> IdentifiedModel:
    """Read a model file with its robot: the one given, or that of the dataset from which it was identified.

    Raises BenchError if model and robot do not match.
    """
    path = Path(path)
    saved = load_model(path)
    payloads: dict[str, Payload] = {}
    files: tuple[Path, ...] = ()
    loaded: Robot | None = None
    if saved.dataset is not None and (saved.dataset / DATASET_FILE).is_file():
        spec = read_toml(saved.dataset / DATASET_FILE, DatasetSpec)
        file = saved.dataset / DATASET_FILE
        payloads = {name: payload_of(file, name, entry) for name, entry in spec.payloads.items()}
        files = tuple(saved.dataset / name for name in spec.effects)
        if robot is None:
            loaded = load_robot(spec.robot, relative_to=saved.dataset)
    if loaded is None:
        loaded = load_robot(saved.model.robot if robot is None else robot)
    known = catalogue_for(files, tuple(effect_files))
    wider = with_saved_effects(known, saved)
    saved_files = () if wider is known else saved.effect_files
    model = identified_model(path, saved, loaded, payloads, wider)
    return replace(model, effect_files=(*files, *effect_files, *saved_files))


def declaring(identified: IdentifiedModel, payloads: Mapping[str, Payload]) -> IdentifiedModel:
    """The model with a dataset's declarations of payloads."""
    declared = {**identified.declared, **payloads}
    return replace(
        identified,
        declared=declared,
        payloads={**_moving_nothing(identified.model, declared), **identified.payloads},
    )


def identified_model(
    path: Path,
    saved: SavedModel,
    robot: Robot,
    payloads: Mapping[str, Payload],
    catalogue: Mapping[str, Effect],
) -> IdentifiedModel:
    """A saved model together with its robot and payloads. Raises BenchError if they do not match."""
    refuse_redundant(robot, "an export or replay")
    if set(robot.joints) != set(saved.model.drive_gains):
        raise BenchError(
            f"{path}: a model of {saved.model.robot} ({', '.join(saved.model.drive_gains)}), but robot {robot.name} "
            f"has the motors {', '.join(robot.joints)}"
        )
    refuse_other_locks(robot, saved.model.locked, str(path))
    model = build_model(robot)
    names = model.base.names
    unknown = [name for name in names if name not in saved.parameters and name not in saved.model.left_out]
    if unknown:
        raise BenchError(
            f"{path}: no base parameter {unknown[0]}: the model does not belong to robot {robot.name}, or its "
            "geometry has changed since"
        )
    loads = {**_moving_nothing(model, payloads), **_payload_values(saved, names)}
    weighed = [name for name, payload in payloads.items() if payload.mass is not None]
    instances = select_effects(
        saved.model.effects, places_in(model.geometry, weighed), catalogue, saved.fitted
    )
    effects = tuple(_with_values(path, saved, instance) for instance in instances)
    every = (*names, *(f"{PARAMETERS[i]}({load})" for load, values in loads.items() for i in values))
    count = len(every) + sum(len(effect.values) for effect in effects) + len(robot.joints)
    return IdentifiedModel(
        path=path,
        saved=saved,
        robot=robot,
        model=model,
        base=np.array([saved.parameters.get(name, 0.0) for name in names]),
        payloads=loads,
        declared=payloads,
        effects=effects,
        gains=np.array([saved.model.drive_gains[joint].value for joint in robot.joints]),
        covariance=_covariance(path, saved.model.covariance, count),
        fixed=np.array([name in saved.model.left_out for name in every]),
    )


def _payload_values(saved: SavedModel, base: Sequence[str]) -> dict[str, dict[int, float]]:
    """Estimated parameters of payloads by payload and index, including omitted ones, in the fit's order."""
    by_payload: dict[str, dict[int, float]] = {}
    for name in (*saved.parameters, *saved.model.left_out):
        if name not in base:
            symbol, _, payload = name.removesuffix(")").partition("(")
            by_payload.setdefault(payload, {})[PARAMETERS.index(symbol)] = saved.parameters.get(name, 0.0)
    return {payload: dict(sorted(values.items())) for payload, values in by_payload.items()}


def _moving_nothing(
    model: IdentificationModel, payloads: Mapping[str, Payload]
) -> dict[str, dict[int, float]]:
    """Payloads whose unknown parameters move no motor, as on a platform that does not turn: none is estimated."""
    weighed = [
        name
        for name, payload in payloads.items()
        if payload.mass is not None and len(payload_columns(payload).unknown)
    ]
    seen = parameter_layout(model, payloads, weighed, 0).payloads
    return {name: {} for name in weighed if not len(seen[name])}


def _with_values(path: Path, saved: SavedModel, instance: EffectInstance) -> EffectValues:
    effect = instance.effect
    known = saved.model.effect_parameters.get(effect.name, {}).get(instance.place, {})
    given = {name: quantity.value for name, quantity in known.items()}
    wanted = [shape.name for shape in effect.shape] + [parameter.name for parameter in effect.parameters]
    for name in wanted:
        if name not in given:
            raise BenchError(f"{path}: no {name} of {effect.name} at {instance.place!r}")
    linear = {parameter.name: given[parameter.name] for parameter in effect.parameters}
    shaped = replace(effect, **{shape.name: given[shape.name] for shape in effect.shape}).about(linear)
    return EffectValues(replace(instance, effect=shaped), linear)


def _covariance(path: Path, covariance: np.ndarray, count: int) -> np.ndarray:
    """The rows and columns of the model's parameters, its effects' and the gains."""
    if covariance.ndim != 2 or min(covariance.shape) < count or not np.isfinite(covariance).all():
        raise BenchError(
            f"{path}: its covariance is {' x '.join(map(str, covariance.shape))}, and {count} parameters are needed"
        )
    return covariance[:count, :count]


def unknown_payload(model: IdentifiedModel, payload: str) -> BenchError:
    """Message on a payload that the model does not know sufficiently."""
    known = ", ".join(sorted({*model.payloads, *model.declared})) or "none"
    return BenchError(
        f"{model.path}: neither the model nor its dataset knows payload {payload!r} in full ({known})"
    )


def payload_values(model: IdentifiedModel, payload: str) -> np.ndarray:
    """A payload's standard parameters (10,) in the tool frame, declared and estimated; zero for those without effect.

    Raises BenchError if some are neither.
    """
    estimated = model.payloads.get(payload)
    declared = model.declared.get(payload)
    if estimated is None and (declared is None or len(payload_columns(declared).unknown)):
        raise unknown_payload(model, payload)
    values = np.zeros(10) if declared is None else payload_columns(declared).known
    for index, value in (estimated or {}).items():
        values[index] = value
    return values


def carried(model: IdentifiedModel, payload: str | None = None) -> tuple[np.ndarray, np.ndarray]:
    """Columns of the regressor (k,), standard parameters by index, and their values (k,): base, then the payload's.

    Raises BenchError for a payload that is not sufficiently known, and for a robot without a tool.
    """
    built = model.model
    if payload is None:
        return built.base.columns, model.base
    columns, values = built.payload_columns, payload_values(model, payload)
    if built.payload is None:
        raise unknown_payload(model, payload)
    return np.concatenate((built.base.columns, columns)), np.concatenate((model.base, built.payload @ values))
