"""The page of a robot with many effects: fewer digits."""

import json

import numpy as np
import pytest

from bench.dataset.dataset import load_dataset
from bench.identification.identify import identify
from bench.identification.prepare import prepare
from bench.identification.problem import problem_of
from bench.page.parts import Page, Section
from bench.page.render import Workbench, render_page
from bench.workbench import room
from bench.workbench.decorrelated import set_apart
from bench.workbench.encode import short_triangle
from bench.workbench.page_data import page_data, with_command
from bench.workbench.page_files import script, style
from tests.workbench_kit import FOUND, diagnosis_of, write_dataset
from tests.workbench_sets import Carried, numbers

LAWS = (
    "constant_offset",
    "coulomb_friction",
    "drive_flexibility",
    "encoder_offset",
    "geometric_error",
    "presliding_hysteresis",
    "stribeck_friction",
    "viscous_friction",
)

RAISED = str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789")


@pytest.fixture(scope="module")
def dataset(tmp_path_factory):
    return load_dataset(write_dataset(tmp_path_factory.mktemp("many") / "data"))


@pytest.fixture(scope="module")
def solver(dataset):
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(room, "MOST_BYTES", 0)
        return Carried(
            json.loads(json.dumps(page_data(problem_of(dataset), diagnosis_of(dataset, names=LAWS))))
        )


@pytest.mark.parametrize(
    ("requests", "close"),
    [
        ((), 1e-4),
        (FOUND, 1e-4),
        (("viscous_friction",), 1e-4),
        (("coulomb_friction", "constant_offset", "viscous_friction"), 1e-4),
        ((*FOUND, "geometric_error:left_rod"), 2e-3),
        ((*FOUND, "drive_flexibility:left"), 2e-3),
    ],
    ids=lambda one: "+".join(one) or "nothing" if isinstance(one, tuple) else "",
)
def test_fewer_digits_find_what_identify_finds(dataset, solver, requests, close):
    expected = identify(prepare(problem_of(dataset, requests)))
    found = solver.fit(solver.keys(requests))
    assert solver.data["short"]
    assert found.fitted == pytest.approx(expected.error.identify, rel=close)
    assert found.judged == pytest.approx(expected.error.validate, rel=close)


def test_a_short_triangle_keeps_four_digits_of_every_product():
    rows = np.random.default_rng(5).normal(size=(200, 12)) * np.logspace(-3, 3, 12)
    factor = np.linalg.qr(rows, mode="r")
    given = short_triangle(factor)
    inner = np.zeros((10, 10))
    inner[np.triu_indices(10, 1)] = numbers(given["counts"], "<i2")
    inner = inner * numbers(given["steps"])[:, None] + np.diag(numbers(given["diagonal"]))
    found = np.column_stack((np.pad(inner, ((0, 2), (0, 0))), numbers(given["answers"]).reshape(-1, 2)))
    found *= numbers(given["sizes"])
    sizes = np.linalg.norm(rows, axis=0)
    np.testing.assert_allclose(
        found.T @ found / np.outer(sizes, sizes), rows.T @ rows / np.outer(sizes, sizes), atol=1e-4
    )


def test_columns_set_apart_are_the_same_model():
    random = np.random.default_rng(7)
    before = random.normal(size=(60, 2, 7)) * np.array([1.0, 1e3, 1e-3, 5.0, 1.0, 1.0, 1.0])
    before[:, :, 5] = before[:, :, 0] + 0.02 * before[:, :, 5]  # near to the model's own
    columns, reference = before.copy(), np.ones(7)
    basis = set_apart(columns, reference, before.copy(), 4)
    for coordinates in (reference, random.normal(size=7)):
        parameters = np.append(basis @ coordinates, coordinates[4:])
        np.testing.assert_allclose(before @ parameters, columns @ coordinates, atol=1e-9)
    np.testing.assert_allclose(basis @ reference, np.ones(4), rtol=1e-9)
    rows = columns.reshape(-1, 7)
    np.testing.assert_allclose(rows[:, :4].T @ rows[:, :4], np.eye(4), atol=1e-9)
    assert np.abs(rows[:, :4].T @ rows[:, 5]).max() < 1e-9
    np.testing.assert_array_equal(columns[:, :, [4, 6]], before[:, :, [4, 6]])


def test_a_browser_shows_that_at_once(chromium, dataset, solver, tmp_path):
    from bench.page.browser import opened

    page = Page("A page", (), (), (), (Section("ranking", "Ranking", "", ()),), "")
    file = tmp_path / "page.html"
    tool = Workbench(with_command(solver.data, "bench identify data"), script(), style())
    file.write_text(render_page(page, tool), encoding="utf-8")
    shown = opened(chromium, file)
    shown.wait_for_selector("#workbench[data-ready=true]")
    # read in the same task as the click, before anything that follows
    at_once = shown.evaluate(
        """() => {
          document.querySelector("#workbench input[data-effect=constant_offset]").click();
          return Number(document.querySelector("#workbench [data-figure=validate]").dataset.value);
        }"""
    )
    shown.wait_for_selector("#workbench[data-ready=true]")
    then = shown.locator("#workbench [data-figure=validate]").get_attribute("data-value")
    identified = identify(prepare(problem_of(dataset, (*FOUND, "constant_offset"))))
    expected = identified.error.validate
    assert float(then) == pytest.approx(expected, rel=1e-4)
    assert at_once == float(then)
    ladder = shown.locator("#workbench svg[role=img]").first.text_content()
    cells = shown.evaluate(
        """() => [...document.querySelectorAll("#workbench details tbody tr")].map((row) => row.cells[1].textContent)"""
    )
    for text, parameter in zip(cells, identified.parameters, strict=True):
        mantissa, _, power = text.replace("−", "-").partition("·10")
        value = float(mantissa) * 10.0 ** int(power.translate(RAISED) or 0)
        assert value == pytest.approx(parameter.value, rel=1e-4, abs=0.02 * parameter.std)
    assert "constant offset" in ladder
    assert f"{float(format(100.0 * expected, '.3g')):g} %" in ladder
    shown.close()
