"""Lines of TOML with keys and values formatted by tomlkit, to be added to a user's file."""

from collections.abc import Mapping, Sequence
from typing import Any

Value = str | float | int | Sequence[Any] | Mapping[str, Any]
"""Texts, numbers, lists of these, and mappings to these as inline tables."""


def toml_line(key: str, value: Value) -> str:
    """A key with its value; a mapping is an inline table."""
    import tomlkit  # noqa: PLC0415 - slow to import, needed only to write a file

    return f"{tomlkit.key(key).as_string()} = {_text(value)}"


def toml_header(*keys: str) -> str:
    """The header of a table, as in [payloads.disc]."""
    import tomlkit  # noqa: PLC0415 - likewise

    return f"[{tomlkit.key(keys).as_string()}]"


def _text(value: Value) -> str:
    import tomlkit  # noqa: PLC0415 - likewise

    if not isinstance(value, Mapping):
        return str(tomlkit.item(value).as_string())
    table = tomlkit.inline_table()
    for key, entry in value.items():
        table.append(key, entry)
    return table.as_string()
