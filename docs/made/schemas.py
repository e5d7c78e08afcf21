"""JSON schemas of the files that users write, from the very models that check them, and tables of their keys."""

import json
from collections.abc import Iterator, Mapping
from typing import Any

import mkdocs_gen_files

from bench.basics.files.toml_input import UserTable
from bench.dataset.dataset_toml import DatasetSpec
from bench.dataset.logs.mapping_file import MappingTable
from bench.dataset.robot import RobotTable
from bench.document.markdown.tables import rows_in_markdown
from bench.scenario.tables import ScenarioTable
from bench.studies.sweep.sweep_file import SweepTable

FILES: dict[str, tuple[type[UserTable], str]] = {
    "robot.toml": (RobotTable, "a robot"),
    "dataset.toml": (DatasetSpec, "recordings and payloads"),
    "map.toml": (MappingTable, "many logs at once, for `bench import --mapping`"),
    "scenario.toml": (ScenarioTable, "a simulated experiment, once its base is read in"),
    "sweep.toml": (SweepTable, "many of them"),
}


WORDS = {"null": "nothing", "boolean": "true or false", "string": "text", "integer": "whole number"}


def keys(
    schema: Mapping[str, Any], of: Mapping[str, Any], before: str = ""
) -> Iterator[tuple[str, str, str]]:
    """Key by its path, what it takes, and what it is where it is left out."""
    for name, one in of.get("properties", {}).items():
        path = f"{before}{name}"
        target, many = _target(schema, one)
        default = _default(one, target)
        needed = "needed" if name in of.get("required", ()) else default
        yield (
            f"`{path}{many}`",
            _takes(schema, one),
            needed if needed == "needed" else f"`{needed}`" * bool(needed),
        )
        if target is not None:
            yield from keys(schema, target, f"{path}{many}.")


def _default(one: Mapping[str, Any], target: Mapping[str, Any] | None) -> str:
    """As JSON; nothing for none, and for a table whose keys have their own."""
    value = one.get("default")
    return "" if value is None or (target and value) else json.dumps(value, ensure_ascii=False)


def _target(schema: Mapping[str, Any], one: Mapping[str, Any]) -> tuple[Mapping[str, Any] | None, str]:
    """The table that a key holds, and how many: "" for one, "[]" for a list, ".NAME" for named ones."""
    for choice in one.get("anyOf", [one]):
        for part, many in (
            (choice, ""),
            (choice.get("items", {}), "[]"),
            (choice.get("additionalProperties"), ".NAME"),
        ):
            if isinstance(part, Mapping) and "$ref" in part:
                found = schema["$defs"][part["$ref"].rpartition("/")[2]]
                if "properties" in found:
                    return found, many
    return None, ""


def _takes(schema: Mapping[str, Any], one: Mapping[str, Any]) -> str:
    """In words what a key takes."""
    if "anyOf" in one:
        return " or ".join(dict.fromkeys(_takes(schema, choice) for choice in one["anyOf"]))
    if "$ref" in one:
        found = schema["$defs"][one["$ref"].rpartition("/")[2]]
        return "table" if "properties" in found else _takes(schema, found)
    if "enum" in one or "const" in one:
        return ", ".join(f"`{value}`" for value in one.get("enum", [one.get("const")]))
    kind = one.get("type", "anything")
    if kind == "array":
        inside = _takes(schema, one["items"]) if one.get("items") else "values"
        return f"list of {'tables' if inside == 'table' else inside}"
    if kind == "object":
        return _takes_named(schema, one.get("additionalProperties"))
    return WORDS.get(kind, kind)


def _takes_named(schema: Mapping[str, Any], named: Any) -> str:
    """Of a table with keys of any name what these take."""
    if not isinstance(named, Mapping):
        return "table"
    inside = _takes(schema, named) if "type" in named else "table"
    return f"{inside}s by name"


def page() -> str:
    """A section a file."""
    sections = []
    for name, (table, about) in FILES.items():
        schema = table.model_json_schema()
        file = f"schemas/{name.removesuffix('.toml')}.json"
        with mkdocs_gen_files.open(f"reference/{file}", "w") as written:
            written.write(json.dumps(schema, indent=2, ensure_ascii=False) + "\n")
        rows = rows_in_markdown(("key", "takes", "if left out"), keys(schema, schema))
        sections.append(f"## {name}\n\nFor {about}. [JSON schema]({file})\n\n{rows}\n")
    return "\n".join(sections)


with mkdocs_gen_files.open("reference/keys.md", "w") as written:
    written.write(
        "# Files that you write, key by key\n\nMade from what checks them: an unknown key is refused. "
        "What the keys mean stands in [formats](formats.md), [scenarios](scenarios.md) and [sweeps](sweeps.md).\n\n"
        + page()
    )
