"""Tables as values: the same cells in a terminal, in Markdown, on a page and in a data frame."""

import builtins
import io
from dataclasses import replace
from typing import get_args

import pytest
from rich.console import Console

from bench.basics.errors import BenchError
from bench.dataset.robot import load_robot
from bench.document.diagnosis import gains_before_after, ladder_table, parameters_before_after, ranking_table
from bench.document.identification import effects_table, errors_table, gains_table, parameters_table
from bench.document.markdown.tables import markdown
from bench.document.numbers import quantity_text
from bench.document.table import Column, Kind, Table
from bench.document.terminal.tables import printed
from bench.document.typeset import typeset
from bench.identification.result import DriveGain, Quantity
from bench.page.parts import on_page
from tests.report_kit import diagnosis
from tests.shown import dataset_of, identification_of

WIDE = 400


@pytest.fixture(scope="module")
def result():
    return identification_of(dataset_of(load_robot("five_bar")), effects=True)


@pytest.fixture(scope="module")
def tables(result):
    found = diagnosis()
    joints = list(result.drive_gains)
    return [
        gains_table(result, {"left": 3.3}),
        parameters_table(result, before=result),
        parameters_table(result, full=True),
        effects_table(result),
        errors_table(result.recordings, joints, ([0.01] * len(joints), 0.01)),
        ladder_table(found),
        ranking_table(found),
        gains_before_after(found.before, found.after),
        parameters_before_after(found, 1)[0],
    ]


def in_terminal(table: Table) -> str:
    console = Console(file=io.StringIO(), width=WIDE)
    console.print(printed(table, WIDE))
    return " ".join(console.file.getvalue().split())


def test_every_medium_tells_the_same_cells(tables):
    for table in tables:
        text, marked, page = in_terminal(table), markdown(table), on_page(table, "title", "aid")
        told = [one for one in table.columns if one.kind != "bar"]
        assert [one.header for one in page.columns] == [one.header for one in told]
        rows = marked.splitlines()[2:]
        assert len(rows) == len(page.rows) == len(table.mark_of_rows)
        for k, column in enumerate(told):
            for row, cell, line in zip(page.rows, column.texts, rows, strict=True):
                assert cell in line
                assert " ".join(cell.split()) in text or " ± " in cell  # values stand under each other
                if column.kind != "terms":
                    assert row.cells[k].text in {cell, typeset(cell)}


def test_every_kind_of_cell_has_a_text():
    quantity = Quantity(1.25, 0.5, "N*m")
    cells = {
        "text": ("left", "left"),
        "sentence": ("It fits.", "It fits."),
        "effect": ("coulomb_friction", "Coulomb friction"),
        "verdict": ("missing", "missing"),
        "quantity": (quantity, "1.25 ± 0.50"),
        "deviation": (quantity, "40.00 %"),
        "true": (quantity, "1.25"),
        "sigma": (-1.25, "-1.2 σ"),
        "share": (0.25, "25.00 %"),
        "change": (0.25, "+25.00 %"),
        "moved": ((1.0, -2.0), "-3"),
        "number": (1.5, "1.5"),
        "unit": ("N*m/A", "N·m/A"),
        "terms": (["+ 0.33333 m(rod)"], "+ 0.333 m(rod)"),
        "bar": (0.5, "50.00 %"),
    }
    assert set(cells) == set(get_args(Kind))
    for kind, (cell, text) in cells.items():
        assert Column("header", [cell], kind).texts == [text], kind
    assert Column("header", [0.12], "number", format=".3f", unit="s").texts == ["0.120 s"]
    assert Column("header", [None, ""], "share").texts == ["–", ""]
    assert Column("header", ["a_b", "a_b", "c_d"], "effect").texts == ["a b", "", "c d"]
    assert Column(
        "header", [replace(quantity, std=0.0), replace(quantity, std=float("inf"))], "quantity"
    ).texts == [
        "1.25 given",
        "absorbed",
    ]


def test_what_says_little_is_marked_in_every_medium():
    nothing = Column("rel. std", [Quantity(0.0, float("inf"), "")], "deviation")
    assert nothing.poor == [False]  # other parameters take it up
    table = Table((Column("rel. std", [Quantity(1.0, 0.5, "")], "deviation"),), ("poor",))
    assert "! 50.00 %" in in_terminal(table)
    assert "**! 50.00 %**" in markdown(table)
    (row,) = on_page(table, "", "").rows
    assert (row.kind, row.cells[0].kind) == ("weak", "poor")


def test_a_data_frame_keeps_the_numbers(result):
    frame = gains_table(result).to_dataframe()
    assert list(frame.columns) == ["joint", "value", "std of value", "unit", "nominal", "change"]
    gain = result.drive_gains["left"]
    assert tuple(frame.loc[0, ["value", "std of value", "nominal"]]) == (gain.value, gain.std, gain.nominal)
    whole = result.to_dataframe()
    assert whole.to_dict("records") == result.rows()


def test_without_pandas_a_data_frame_says_what_it_needs(result, monkeypatch):
    find = builtins.__import__

    def without(name, *rest, **more):
        if name == "pandas":
            raise ImportError(name)
        return find(name, *rest, **more)

    monkeypatch.setattr(builtins, "__import__", without)
    with pytest.raises(BenchError, match="parabench\\[frames\\]"):
        result.to_dataframe()


@pytest.mark.parametrize(
    ("quantity", "text"),
    [
        (Quantity(-11351789.0, 8.5e12, "kg*m^2"), "not determined"),
        (Quantity(3.0e6, 1.0e6, "N*m/rad"), "3.0000e+06 ± 1.0e+06"),
        (Quantity(1e-5, 0.01, "kg"), "0.000 ± 0.010"),
        (Quantity(1.0, float("inf"), "kg"), "absorbed"),
        (DriveGain(-4.0, 90.0, "N*m/A", 3.0), "not determined"),
        (DriveGain(2.9, 0.1, "N*m/A", 3.0), "2.90 ± 0.10"),
    ],
)
def test_a_value_that_says_nothing_is_not_printed(quantity, text):
    assert quantity_text(quantity) == text
