"""The runs of a sweep by number, computed on demand, and settings by dotted path."""

import hashlib
import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import groupby
from math import prod
from typing import Any

from bench.basics.errors import BenchError
from bench.scenario.file import find_scenario, read_with_bases, with_absolute_paths
from bench.studies.sweep.axes import Axis, DrawnAxis, GridAxis, Value, flat
from bench.studies.sweep.sweep_file import IDENTIFY, LARGEST, Sweep

NAMES = ("name", "effect")  # an element of a list of tables is named by one of these keys, or by its number
MOVEMENT, MACHINE, SENSING, FITTING, METHOD = range(5)
SENSED = ("sensors",)
FITTED = ("filter", "effects")
SOLVED = ("method", "deviations", "essential", "fit_gains", "diagnose")
MOVED = ("base", "robot", "design", "recordings")
NOT_MOTION = ("seed", "sensors", "filter", "tolerances", "description", "file_format")


def with_setting(content: Mapping[str, Any], path: str, value: Any) -> dict[str, Any]:
    """`content` with the setting at `path`; unchanged parts are shared, not copied.

    Missing tables are created; a list element is named by its number, or by its `name` or `effect`. Raises BenchError
    if a list has no such element.
    """
    return dict(_with(content, path.split("."), value, path))


def _with(container: Any, parts: Sequence[str], value: Any, path: str) -> Any:
    head, rest = parts[0], parts[1:]
    if isinstance(container, Mapping):
        below = _with(container.get(head, {}), rest, value, path) if rest else value
        return {**container, head: below}
    if isinstance(container, Sequence) and not isinstance(container, str):
        at = _position(container, head)
        if at is None:
            known = ", ".join(_element_name(container, i) for i in range(len(container))) or "nothing"
            raise BenchError(f"{path}: the list has no {head!r}; it has {known}")
        below = _with(container[at], rest, value, path) if rest else value
        return [*container[:at], below, *container[at + 1 :]]
    # a number for all joints is replaced by a table
    return {head: _with({}, rest, value, path) if rest else value}


def flat_settings(content: Any, prefix: str = "") -> Iterator[tuple[str, Any]]:
    """Every setting of a scenario with its path; lists of numbers and the like as JSON text."""
    if isinstance(content, Mapping):
        for key, value in content.items():
            yield from flat_settings(value, f"{prefix}.{key}" if prefix else str(key))
    elif isinstance(content, Sequence) and content and all(isinstance(x, Mapping) for x in content):
        for i in range(len(content)):
            yield from flat_settings(content[i], f"{prefix}.{_element_name(content, i)}")
    else:
        yield prefix, plain(content)


def plain(value: Any) -> Any:
    """A value for one cell of a table: numbers, text, booleans and None unchanged, lists of text joined, the rest as
    JSON text.
    """
    if value is None or isinstance(value, bool | int | float | str):
        return value
    if isinstance(value, Sequence) and all(isinstance(x, str) for x in value):
        return " + ".join(value) or "none"
    return json.dumps(value)


def _position(elements: Sequence[Any], name: str) -> int | None:
    if name.isdecimal():
        return int(name) if int(name) < len(elements) else None
    indices = [i for i in range(len(elements)) if _element_name(elements, i) == name]
    return indices[0] if indices else None


def _element_name(elements: Sequence[Any], index: int) -> str:
    """The element's `name` or `effect` if no other element has the same, otherwise its number."""
    for key in NAMES:
        names = [element.get(key) if isinstance(element, Mapping) else None for element in elements]
        its_name = names[index]
        if isinstance(its_name, str) and names.count(its_name) == 1:
            return its_name
    return str(index)


@dataclass(frozen=True)
class Run:
    """One run: a scenario and the settings of its identification.

    number: its row in the table. axes: name -> value as in tables. content: of a scenario file, merged with its base.
    identify: method, effects, deviations, essential, fit_gains, diagnose. design, motion, equations: digests of
    everything that the trajectories, the motion and the prepared equations depend on; runs with the same digest share
    the work.
    """

    number: int
    seed: int
    axes: Mapping[str, Value]
    base: str
    content: Mapping[str, Any]
    identify: Mapping[str, Any]
    design_content: Mapping[str, Any]
    design: str
    motion: str
    equations: str


@dataclass(frozen=True)
class Plan:
    """The runs of a sweep, ordered so that runs that share work are adjacent."""

    sweep: Sweep

    @cached_property
    def axes(self) -> tuple[GridAxis | None, ...]:
        """The grid's axes, slowest first; None represents the seeds."""
        ordered = sorted(self.sweep.grid, key=level)
        slow = sum(level(axis) <= MACHINE for axis in ordered)
        return (*ordered[:slow], None, *ordered[slow:])

    @cached_property
    def shape(self) -> tuple[int, ...]:
        """Number of values of each of `axes`."""
        return tuple(len(self.sweep.seeds if axis is None else axis.points) for axis in self.axes)

    @property
    def size(self) -> int:
        """Number of runs."""
        return prod(self.shape)

    @cached_property
    def axis_names(self) -> tuple[str, ...]:
        """Names of all axes, those drawn included, in the order of the file."""
        return tuple(axis.name for axis in self.sweep.axes)

    def run(self, number: int) -> Run:
        """The run of that number, from 0."""
        seed, settings, labels = self._values(number)
        drawn = {axis.name: axis.value(seed) for axis in self.sweep.axes if isinstance(axis, DrawnAxis)}
        settings, labels = settings | drawn, labels | drawn
        identify = self.sweep.table.identify.model_dump() | {
            k: v for k, v in settings.items() if k in IDENTIFY
        }
        base, content = self._content(settings, seed)
        if self.sweep.table.design == "once":
            moved = {path: value for path, value in settings.items() if path.split(".")[0] in MOVED}
            design_content = self._content(moved, 0)[1]
        else:
            design_content = content
        design = digest(
            {key: design_content.get(key) for key in ("robot", "design", "recordings", "payloads")}
        )
        motion = {key: value for key, value in content.items() if key not in NOT_MOTION}
        motion["payloads"], declared = _declarations(content.get("payloads") or {})
        if (content.get("gains") or {}).get("error_within"):
            motion["seed"] = seed
        motion_digest = digest([design, motion])
        fitted = [content.get("sensors"), content.get("filter"), identify["effects"], declared]
        return Run(
            number=number,
            seed=seed,
            axes={name: plain(labels[name]) for name in self.axis_names},
            base=base,
            content=content,
            identify=identify,
            design_content=design_content,
            design=design,
            motion=motion_digest,
            equations=digest([motion_digest, seed, fitted]),
        )

    def tasks(self, is_done: Callable[[int], bool] = lambda _: False) -> Iterator[tuple[Run, ...]]:
        """All runs that are not done, in order; runs with the same equations form one task."""
        wanted = (self.run(i) for i in range(self.size) if not is_done(i))
        for _, same in groupby(wanted, key=lambda run: run.equations):
            yield tuple(same)

    def _values(self, number: int) -> tuple[int, dict[str, Value], dict[str, Value]]:
        """Seed, settings by path and labels by axis of a run number; the last axis varies fastest."""
        if not 0 <= number < self.size:
            raise IndexError(number)
        seed = 0
        settings: dict[str, Value] = {}
        labels: dict[str, Value] = {}
        rest = number
        for axis, size in zip(reversed(self.axes), reversed(self.shape), strict=True):
            rest, at = divmod(rest, size)
            if axis is None:
                seed = self.sweep.seeds[at]
            else:
                labels[axis.name] = axis.points[at].label
                settings.update(axis.points[at].settings)
        return seed, settings, labels

    def _content(self, settings: Mapping[str, Value], seed: int) -> tuple[str, dict[str, Any]]:
        base = str(settings.get("base", self.sweep.table.base))
        content = self._based(base)
        for path, value in settings.items():
            if path != "base" and path not in IDENTIFY:
                content = with_setting(content, path, value)
        content["seed"] = seed
        if isinstance(settings.get("robot"), str):
            content = with_absolute_paths(content, self.sweep.path.parent)
        return base, content

    @cached_property
    def _bases(self) -> dict[str, dict[str, Any]]:
        return {}

    def _based(self, base: str) -> dict[str, Any]:
        """The content of a base scenario with the settings common to all runs."""
        if base not in self._bases:
            folder = self.sweep.path.parent
            content = read_with_bases(find_scenario(base, folder))
            for path, value in flat(self.sweep.table.scenario):
                content = with_setting(content, path, value)
            self._bases[base] = with_absolute_paths(content, folder)
        return dict(self._bases[base])


def make_plan(sweep: Sweep) -> Plan:
    """The plan of a sweep. Raises BenchError if an axis varies the seed, two axes vary the same setting, or there are
    too many runs.
    """
    owner: dict[str, str] = {}
    for axis in sweep.axes:
        for path in axis.paths:
            if path == "seed":
                raise BenchError(f"{sweep.path}: axes.{axis.name}: seeds have their key, `seeds`")
            for other, name in owner.items():
                if name != axis.name and (
                    f"{path}.".startswith(f"{other}.") or f"{other}.".startswith(f"{path}.")
                ):
                    raise BenchError(f"{sweep.path}: axes.{axis.name}: axes.{name} varies {other} already")
            owner[path] = axis.name
    plan = Plan(sweep)
    if plan.size > LARGEST:
        counts = " × ".join(str(size) for size in plan.shape)
        raise BenchError(f"{sweep.path}: {counts} = {plan.size} runs, more than {LARGEST}")
    return plan


def level(axis: Axis) -> int:
    """How much work is repeated for a new value of an axis: most for MOVEMENT, least for METHOD."""
    return min(map(_level, axis.paths), default=METHOD)


def _level(path: str) -> int:
    head, *rest = path.split(".")
    if head == "payloads" and "declared" in rest:
        return FITTING
    for changes, heads in ((SENSING, SENSED), (FITTING, FITTED), (METHOD, SOLVED), (MOVEMENT, MOVED)):
        if head in heads:
            return changes
    return MACHINE


def _declarations(payloads: Mapping[str, Any]) -> tuple[dict[str, Any], dict[str, Any]]:
    """The true payloads, and those that the dataset declares."""
    true = {name: {k: v for k, v in table.items() if k != "declared"} for name, table in payloads.items()}
    return true, {name: table.get("declared") for name, table in payloads.items()}


def digest(value: Any) -> str:
    """Sixteen hexadecimal digits that distinguish values."""
    text = json.dumps(value, sort_keys=True, separators=(",", ":"), default=list)
    return hashlib.sha256(text.encode()).hexdigest()[:16]
