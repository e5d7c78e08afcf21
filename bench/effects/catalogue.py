"""The effects by name, sorted: each class in `bench/effects/laws`."""

from bench.basics.class_files import classes_of
from bench.effects import laws
from bench.effects.effect import Effect

CATALOGUE: dict[str, Effect] = {name: law() for name, law in classes_of(laws).items()}
