"""Write the tables of effects in READMEs anew, from the classes: python docs/made/readme_tables.py."""

from collections.abc import Iterable, Sequence
from dataclasses import MISSING, fields
from pathlib import Path

from bench.effects import CATALOGUE
from bench.truth.hidden import HIDDEN_EFFECTS

ROOT = Path(__file__).parents[2]
SITS = {"actuator": "motor", "passive": "passive joint", "bearing": "passive joint"}
EFFECTS_HEAD = ("effect", "sits at", "parameters", "shape parameters", "special cases")
HIDDEN_HEAD = ("effect", "parameters", "law")


def effects_table() -> str:
    """The catalogue, for bench/effects/README.md."""
    return table(
        EFFECTS_HEAD,
        (
            (
                f"`{name}`",
                SITS.get(one.place, one.place) + (", ball joint" if one.in_balls else ""),
                named(parameter.name for parameter in one.parameters),
                named(parameter.name for parameter in one.shape),
                named(one.contains),
            )
            for name, one in CATALOGUE.items()
        ),
    )


def hidden_table(*, in_catalogue: bool) -> str:
    """What a scenario can hide, for scenarios/README.md."""
    return table(
        HIDDEN_HEAD,
        (
            (
                f"`{name}`",
                ", ".join(
                    f"`{one.name}`" + ("" if one.default is MISSING else f" = {one.default:g}")
                    for one in fields(kind)
                    if one.name != "joint"
                ),
                kind.law.replace("|", "\\|"),
            )
            for name, kind in HIDDEN_EFFECTS.items()
            if kind.in_catalogue == in_catalogue
        ),
    )


def named(names: Iterable[str]) -> str:
    """Such as `Fc`, `Fs`."""
    return ", ".join(f"`{name}`" for name in names)


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """As Markdown."""
    lines = [f"| {' | '.join(head)} |", "|---" * len(head) + "|"]
    lines += ["|" + "".join(f" {cell} |" if cell else " |" for cell in row) for row in rows]
    return "\n".join(lines) + "\n"


def with_tables(text: str, tables: Sequence[str]) -> str:
    """A text with its tables that have the heads of these in their place, in their order."""
    for new in dict.fromkeys(one.splitlines()[0] for one in tables):
        parts = text.split(f"{new}\n")
        same = [one for one in tables if one.startswith(f"{new}\n")]
        if len(parts) != len(same) + 1:
            raise ValueError(f"{len(parts) - 1} tables with the head {new}, not {len(same)}")
        text = parts[0] + "".join(one + after_table(rest) for one, rest in zip(same, parts[1:], strict=True))
    return text


def after_table(text: str) -> str:
    """What stands behind the rows with which a text begins."""
    lines = text.splitlines(keepends=True)
    count = next((i for i, line in enumerate(lines) if not line.startswith("|")), len(lines))
    return "".join(lines[count:])


def made() -> dict[Path, str]:
    """Every README with such tables, as it should be."""
    tables = {
        ROOT / "bench" / "effects" / "README.md": [effects_table()],
        ROOT / "scenarios" / "README.md": [hidden_table(in_catalogue=True), hidden_table(in_catalogue=False)],
    }
    return {path: with_tables(path.read_text(encoding="utf-8"), own) for path, own in tables.items()}


if __name__ == "__main__":
    for readme, new_text in made().items():
        readme.write_text(new_text, encoding="utf-8")
