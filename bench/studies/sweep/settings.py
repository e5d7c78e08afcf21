"""Settings by dotted path: `sensors.current_noise_ratio`, `recordings.loaded.design.span`, `hidden.0.Fv`."""

import json
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from bench.basics.errors import BenchError

NAMES = ("name", "effect")  # an element of a list of tables goes by one of these keys, or by its number


def with_setting(content: Mapping[str, Any], path: str, value: Any) -> dict[str, Any]:
    """`content` with the setting at `path`; what is not touched is shared, not copied.

    Tables that are missing are made; a list element goes by its number, or by its `name` or `effect`.
    Raises BenchError if the path leads through something else.
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
    # a number that represents all joints gives way to a table
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
    """A value for one cell of a table: numbers, text and truth as they are, the rest as JSON text."""
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
    """The element's `name` or `effect` where no other element has the same, otherwise its number."""
    for key in NAMES:
        names = [element.get(key) if isinstance(element, Mapping) else None for element in elements]
        its_name = names[index]
        if isinstance(its_name, str) and names.count(its_name) == 1:
            return its_name
    return str(index)
