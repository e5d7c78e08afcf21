"""Read a user's TOML file: a pydantic model validates it, and an error is reported in one line."""

import re
import tomllib
from pathlib import Path
from typing import Any, TypeVar

from pydantic import BaseModel, ConfigDict, ValidationError

from bench.basics.errors import BenchError, nearest


class UserTable(BaseModel):
    """Base of every table that users write: an unknown key is an error, values are frozen."""

    model_config = ConfigDict(extra="forbid", frozen=True)


Table = TypeVar("Table", bound=UserTable)


def read_toml(path: Path, table: type[Table]) -> Table:
    """Read `path` and validate it against `table`.

    Raises BenchError, one line with the file and the key, if the file cannot be read, is not TOML, or does not match
    the model.
    """
    try:
        text = path.read_text(encoding="utf-8-sig")
    except OSError as error:
        raise BenchError(f"{path}: cannot be read: {error.strerror or error}") from error
    except UnicodeDecodeError as error:
        raise BenchError(f"{path}: not UTF-8 text (byte {error.start})") from error
    try:
        content = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise BenchError(f"{path}: not valid TOML: {one_line(error)}") from error
    try:
        return table.model_validate(content)
    except ValidationError as error:
        line = line_of(text, mistakes_of(error)[0]["loc"])
        where = str(path) if line is None else f"{path}, line {line}"
        raise BenchError(f"{where}: {first_mistake(error)}") from error


def line_of(text: str, location: tuple[int | str, ...]) -> int | None:
    """The line of TOML, counted from 1, with the key of this location, or with its table; None if it is not located."""
    wanted = [str(part) for part in location]
    heading: list[str] = []
    counts: dict[str, int] = {}
    best: tuple[int, int] | None = None
    for number, line in enumerate(text.splitlines(), start=1):
        header = re.match(r"\s*(\[\[?)\s*([\w.\"'-]+)\s*\]", line)
        key = re.match(r"\s*([\w.\"'-]+)\s*=", line)
        if header:
            name = header.group(2).replace('"', "").replace("'", "")
            counts[name] = counts.get(name, -1) + 1
            heading = [*name.split("."), *([str(counts[name])] if header.group(1) == "[[" else [])]
            path = heading
        elif key:
            path = [*heading, *key.group(1).replace('"', "").replace("'", "").split(".")]
        else:
            continue
        if wanted[: len(path)] == path and (best is None or len(path) > best[0]):
            best = len(path), number
    return best[1] if best else None


def mistakes_of(error: ValidationError) -> list[Any]:
    """The errors of a pydantic validation, an unknown key first, since it is usually a misspelling of the missing
    one.
    """
    return sorted(error.errors(include_url=False), key=lambda m: m["type"] != "extra_forbidden")


def first_mistake(error: ValidationError) -> str:
    """The first error of a pydantic validation as "key: what is wrong, got value", in one line.

    An unknown key takes precedence over a missing one.
    """
    mistakes = mistakes_of(error)
    first = mistakes[0]
    text = f"{key_name(first['loc'])}: {_explain(first['type'], first['msg'])}"
    if (misspelt := _missing_instead(mistakes)) is not None:
        text += f": did you mean {misspelt['loc'][-1]!r}?"
        mistakes.remove(misspelt)
    if first["type"] not in ("missing", "extra_forbidden"):
        text += f", got {_shorten(first['input'])}"
    if len(mistakes) > 1:
        text += f"; and {len(mistakes) - 1} more, for example {key_name(mistakes[1]['loc'])}"
    return one_line(text)


def _missing_instead(mistakes: list[Any]) -> Any | None:
    """The missing key that the first mistake, an unknown key, stands for: one with a like name, or the only one of its
    table.
    """
    if mistakes[0]["type"] != "extra_forbidden":
        return None
    *table, name = mistakes[0]["loc"]
    missing = {m["loc"][-1]: m for m in mistakes if m["type"] == "missing" and [*m["loc"][:-1]] == table}
    near = nearest(str(name), missing) or (next(iter(missing)) if len(missing) == 1 else None)
    return None if near is None else missing[near]


def key_name(location: tuple[int | str, ...]) -> str:
    """A pydantic location as a path of keys: ("actuators", 1, "gain") -> "actuators[1].gain"."""
    name = ""
    for part in location:
        name += f"[{part}]" if isinstance(part, int) else f".{part}" if name else part
    return name or "top level"


def one_line(text: object) -> str:
    """A text with all white space, including line breaks, reduced to single spaces."""
    return " ".join(str(text).split())


def _explain(kind: str, message: str) -> str:
    if kind == "missing":
        return "missing"
    if kind == "extra_forbidden":
        return "unknown key"
    if kind in ("tuple_type", "list_type"):
        return "should be an array"
    if kind in ("model_type", "model_attributes_type", "dict_type"):
        return "should be a table"
    return message.removeprefix("Value error, ").replace("Input should", "should")


def _shorten(value: Any, limit: int = 60) -> str:
    text = repr(value)
    return text if len(text) <= limit else text[: limit - 3] + "..."
