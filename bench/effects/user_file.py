"""A user's effects: classes in a Python file, treated like built-in ones."""

import inspect
import sys
from collections.abc import Iterable, Mapping
from dataclasses import fields
from pathlib import Path
from typing import get_args

from bench.basics.errors import BenchError
from bench.basics.files.python_file import module_of, read_source
from bench.effects.catalogue import CATALOGUE
from bench.effects.effect import Effect, EffectParameter, Place, ShapeParameter, unit_at

PREFIX = "bench_user_effects_"


def catalogue_for(*files: Iterable[Path]) -> Mapping[str, Effect]:
    """The built-in effects and those of the user's files, by name in alphabetical order.

    Raises BenchError that names a file and its fault, or two effects of the same name.
    """
    effects = dict(CATALOGUE)
    origin = dict.fromkeys(CATALOGUE, "a built-in one")
    for file in dict.fromkeys(path.resolve() for group in files for path in group):
        for name, effect in load_effects(file).items():
            if name in effects:
                raise BenchError(f"{file}: effect {name!r} has the name of {origin[name]}")
            effects[name] = effect
            origin[name] = f"one in {file}"
    return dict(sorted(effects.items()))


def load_effects(path: str | Path) -> dict[str, Effect]:
    """The effects that a Python file defines, by name: its subclasses of Effect or ActuatorEffect.

    The file is run. Raises BenchError that names the file and, if possible, the line.
    """
    path = Path(path)
    return effects_in(read_source(path), path)


def effects_in(source: str, path: Path) -> dict[str, Effect]:
    """The effects that the text of such a file defines, whether the file exists or not."""
    module = module_of(source, path, PREFIX)
    classes = [
        member
        for member in vars(module).values()
        if isinstance(member, type) and issubclass(member, Effect) and member.__module__ == module.__name__
    ]
    effects = [_instance(kind, path) for kind in classes if not inspect.isabstract(kind)]
    if not effects:
        unfinished = ", ".join(
            f"{kind.__name__} lacks {', '.join(sorted(kind.__abstractmethods__))}" for kind in classes
        )
        raise BenchError(
            f"{path}: no subclass of Effect or ActuatorEffect{unfinished and f' ({unfinished})'}"
        )
    names = [effect.name for effect in effects]
    if len(set(names)) < len(names):
        raise BenchError(f"{path}: two effects have the same name: {', '.join(names)}")
    return dict(zip(names, effects, strict=True))


def user_file_of(effect: Effect) -> Path | None:
    """The user's file that defines an effect; None for a built-in one."""
    module = type(effect).__module__
    return Path(str(sys.modules[module].__file__)) if module.startswith(PREFIX) else None


def _instance(kind: type[Effect], path: Path) -> Effect:
    try:
        effect = kind()
    except TypeError as error:
        raise BenchError(f"{path}: class {kind.__name__} cannot be made without arguments: {error}") from None
    fault = effect_fault(effect)
    if fault is not None:
        raise BenchError(f"{path}: class {kind.__name__}: {fault}")
    return effect


def effect_fault(effect: Effect) -> str | None:
    """The fault of an effect's class, in words; None if there is none."""
    name = getattr(effect, "name", None)
    parameters = getattr(effect, "parameters", ())
    if not isinstance(name, str) or not name.isidentifier():
        return f"name must be a word, for example 'my_friction', not {name!r}"
    if not _all_of(parameters, EffectParameter) or not parameters:
        return "parameters must be a tuple of EffectParameter, at least one"
    if not _all_of(effect.shape, ShapeParameter):
        return "shape must be a tuple of ShapeParameter"
    if effect.place not in get_args(Place):
        return f"place {effect.place!r} is none of {', '.join(get_args(Place))}"
    if effect.varies_by_run and len(parameters) != 1:
        return "varies_by_run goes with one parameter"
    return _parameter_fault(effect)


def _parameter_fault(effect: Effect) -> str | None:
    every: list[EffectParameter | ShapeParameter] = [*effect.parameters, *effect.shape]
    symbols = [effect_parameter.name for effect_parameter in every]
    if len(set(symbols)) < len(symbols):
        return f"two parameters have the same name: {', '.join(symbols)}"
    field_names = {field.name for field in fields(effect)}
    for shape in effect.shape:
        if shape.name not in field_names or not shape.candidates:
            return (
                f"shape parameter {shape.name!r} needs candidates and a field of the same name in a dataclass"
            )
    for parameter in every:
        try:
            unit_at(parameter.unit, rotates=True)
        except (KeyError, IndexError, ValueError):
            return (
                f"unit {parameter.unit!r}: only {{effort}}, {{angle}}, {{turn}} and {{drive}} are filled in"
            )
    return None


def _all_of(values: object, kind: type) -> bool:
    return isinstance(values, tuple) and all(isinstance(value, kind) for value in values)
