"""Packages with one class in each file."""

from importlib import import_module
from pkgutil import iter_modules
from types import ModuleType
from typing import Any


def classes_of(package: ModuleType) -> dict[str, Any]:
    """The classes by the names of their files, sorted; CoulombFriction is in coulomb_friction.py."""
    names = sorted(module.name for module in iter_modules(package.__path__))
    modules = {name: import_module(f"{package.__name__}.{name}") for name in names}
    return {name: vars(module)[name.title().replace("_", "")] for name, module in modules.items()}
