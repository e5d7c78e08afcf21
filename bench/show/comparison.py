"""Where a model fails, in a terminal."""

from rich.console import Console
from rich.table import Table
from rich.text import Text

from bench.compare.where import WhereItFails
from bench.compare.words import where_sentences
from bench.show.columns import Column, table_of
from bench.show.numbers import percent


def where_report(where: WhereItFails, console: Console | None = None) -> None:
    """Print how large every motor's error is beside the noise, and in sentences where it is."""
    console = console or Console()
    console.print(Text("Where it fails", "bold"))
    console.print(motors_table(where, width=console.width))
    console.print()
    console.print(sentences_list(where_sentences(where)))
    console.print()


def motors_table(where: WhereItFails, *, width: int = 100) -> Table:
    """A row a motor: error, noise of the current, how long errors are alike, warm-up, and payloads."""
    motors = where.motors
    loads = [one.part for one in motors[0].by_load] if motors else []
    columns = [
        Column("motor", [one.joint for one in motors]),
        Column("error", [percent(one.error) for one in motors], "right"),
        Column("noise", [percent(one.noise) for one in motors], "right"),
        Column("× noise", [_ratio(one.error, one.noise) for one in motors], "right"),
        Column("alike over", [f"{one.memory:.2g} s" for one in motors], "right", rank=3),
        Column("first third", [percent(one.warm_up[0].error) for one in motors], "right", rank=1),
        Column("last third", [percent(one.warm_up[1].error) for one in motors], "right", rank=1),
    ]
    if len(loads) > 1:
        columns += [
            Column(load, [percent(one.by_load[k].error) for one in motors], "right", rank=2)
            for k, load in enumerate(loads)
        ]
    return table_of(columns, width)


def sentences_list(sentences: list[str]) -> Table:
    """Sentences as bullets that wrap under themselves."""
    grid = Table.grid(padding=(0, 1, 0, 0))
    grid.add_column()
    grid.add_column()
    for one in sentences:
        grid.add_row("•", one)
    return grid


def _ratio(error: float, noise: float) -> str:
    ratio = error / noise if noise > 0 else float("inf")
    return f"{ratio:.2f}" if ratio < 10.0 else f"{ratio:.0f}" if ratio < float("inf") else "–"
