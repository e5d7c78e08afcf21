"""The page of the robots that come along, from robots/README.md and the folders that it names."""

import json
from pathlib import Path

import mkdocs_gen_files
import numpy as np
import pyarrow.parquet as pq

from bench.dataset.catalogue import built_in_robots, built_in_scenarios
from bench.document.markdown.tables import rows_in_markdown
from bench.effects.display_names import spoken

ROOT = Path(__file__).resolve().parents[2]


def page() -> str:
    """The table of robots, its pictures copied beside it."""
    text = (ROOT / "robots" / "README.md").read_text(encoding="utf-8")
    for folder in sorted(path.parent for path in (ROOT / "robots").glob("*/robot.toml")):
        for picture in folder.glob("*.png"):
            with mkdocs_gen_files.open(f"robots/{folder.name}/{picture.name}", "wb") as copy:
                copy.write(picture.read_bytes())
        text = text.replace(f'src="{folder.name}/', f'src="robots/{folder.name}/')
        text = text.replace(f"[`{folder.name}`]({folder.name}/robot.toml)", f"`{folder.name}`")
    return text.replace(
        "[bench/effects/README.md](../bench/effects/README.md)", "[the atlas](atlas/index.md)"
    )


def shown() -> str:
    """Accuracy of the gains, and what data of each robot can show, from results."""
    effects = json.loads((ROOT / "results" / "atlas" / "robots.json").read_text(encoding="utf-8"))
    errors = gain_errors()
    without = " and ".join(f"`{name}`" for name in built_in_robots() if name not in built_in_scenarios())
    rows = []
    for robot, of in effects["robots"].items():
        accuracy = "–"
        if robot in errors:
            median = f"{100 * float(np.median(errors[robot])):.3g} %"
            accuracy = f"{median}, {len(errors[robot])} seeds"
        absorbed = ", ".join(f"[{spoken(name)}](atlas/{name}.md)" for name in of["absorbed"])
        rows.append((f"`{robot}`", accuracy, str(len(of["shows"])), absorbed))
    heads = (
        "robot",
        "largest gain error, median",
        "effects that its data can show",
        "absorbed by its parameters",
    )
    return (
        "## How accurate, and what its data can show\n\n"
        "Gains from 20-bit encoders and 1 % current noise "
        "([how far to trust it](trust.md#are-gains-and-intervals-right)). "
        "Effects of [the atlas](atlas/index.md) that its scenario's motions and payloads can show: `make atlas`, "
        f"commit `{effects['about']['commit'][:7]}`; {without} have no scenario.\n\n"
        f"{rows_in_markdown(heads, rows)}\n\n"
    )


def gain_errors() -> dict[str, list[float]]:
    """The largest gain error of every run, by robot."""
    found: dict[str, list[float]] = {}
    for path in sorted((ROOT / "results" / "montecarlo").glob("*_seeds.parquet")):
        for row in pq.read_table(path, columns=["scenario", "gain_error"]).to_pylist():
            found.setdefault(row["scenario"], []).append(row["gain_error"])
    return found


BEFORE = "All of them:\n"
whole = page()
if BEFORE not in whole:
    raise ValueError(f"robots/README.md has no line {BEFORE!r}")
with mkdocs_gen_files.open("robots.md", "w") as written:
    written.write(whole.replace(BEFORE, f"{shown()}## What they have in common\n", 1))
