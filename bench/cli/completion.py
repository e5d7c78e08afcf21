"""What a shell may complete: the names of effects, robots, scenarios and sweeps."""

import click

from bench.dataset.catalogue import built_in_robots, built_in_scenarios, catalogue_folder


def effects(_context: click.Context, _option: click.Parameter, begun: str) -> list[str]:
    """Effects of the catalogue."""
    from bench.effects.catalogue import CATALOGUE

    return _beginning(list(CATALOGUE), begun)


def robots(_context: click.Context, _option: click.Parameter, begun: str) -> list[str]:
    """Built-in robots."""
    return _beginning(list(built_in_robots()), begun)


def scenarios(_context: click.Context, _option: click.Parameter, begun: str) -> list[str]:
    """Built-in scenarios."""
    return _beginning(list(built_in_scenarios()), begun)


def sweeps(_context: click.Context, _option: click.Parameter, begun: str) -> list[str]:
    """Built-in sweeps."""
    return _beginning([path.stem for path in catalogue_folder("scenarios").glob("sweeps/*.toml")], begun)


def _beginning(names: list[str], begun: str) -> list[str]:
    return sorted(name for name in names if name.startswith(begun))
