"""The page of a robot with many effects: fewer digits, and small changes computed at few samples."""

import json

import numpy as np
import pytest

from bench.dataset import load_dataset
from bench.effects import CATALOGUE
from bench.estimate.identify import identify
from bench.estimate.prepare import prepare
from bench.report.parts import Page, Section
from bench.report.render import Workbench, render_page
from bench.workbench import kinds, reduce
from bench.workbench.encode import short_triangle
from bench.workbench.page_data import page_data
from bench.workbench.page_files import script, style
from bench.workbench.small_changes import small_changes
from tests.workbench_kit import FOUND, Solver, diagnosis_of, numbers, write_dataset

LAWS = (
    "coulomb_friction",
    "drive_flexibility",
    "encoder_offset",
    "geometric_error",
    "presliding_hysteresis",
    "stribeck_friction",
    "viscous_friction",
)


@pytest.fixture(scope="module")
def dataset(tmp_path_factory):
    return load_dataset(write_dataset(tmp_path_factory.mktemp("many") / "data"))


@pytest.fixture(scope="module")
def solver(dataset):
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(kinds, "MANY", 0)
        patch.setattr(reduce, "MOST_BYTES", 0)
        return Solver(json.loads(json.dumps(page_data(dataset, diagnosis_of(dataset, names=LAWS)))))


@pytest.mark.parametrize(
    ("requests", "close"),
    [
        ((), 1e-4),
        (FOUND, 1e-4),
        (("viscous_friction",), 1e-4),
        ((*FOUND, "geometric_error:left_rod"), 2e-3),
        ((*FOUND, "drive_flexibility:left"), 2e-3),
        (("stribeck_friction", "viscous_friction"), 1e-4),
        (("coulomb_friction", "stribeck_friction", "viscous_friction"), 1e-4),
        (("presliding_hysteresis", "viscous_friction"), 5e-4),
    ],
    ids=lambda one: "+".join(one) or "nothing" if isinstance(one, tuple) else "",
)
def test_fewer_digits_find_what_identify_finds(dataset, solver, requests, close):
    expected = identify(dataset, requests)
    found = solver.fit({key for key in solver.places if {key, key.partition(":")[0]} & set(requests)})
    assert solver.data["basis"] is not None
    assert found.fitted == pytest.approx(expected.error.identify, rel=close)
    assert found.judged == pytest.approx(expected.error.validate, rel=close)


@pytest.mark.parametrize("name", ["drive_flexibility", "encoder_offset", "geometric_error"])
def test_small_changes_are_the_changes(dataset, name):
    prepared = prepare(dataset)
    joint = "left_rod" if name == "geometric_error" else "left"
    whole = CATALOGUE[name].columns(prepared.signals[0], joint)
    thin = CATALOGUE[name].columns(small_changes(prepared.signals[0]), joint)
    lengths = np.linalg.norm(whole, axis=(0, 1))
    assert np.all(np.linalg.norm(thin - whole, axis=(0, 1)) < 0.02 * lengths)


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


def test_a_browser_shows_nearly_that_at_once_and_then_that(chromium, dataset, solver, tmp_path):
    from bench.report.browser import opened

    page = Page("A page", (), (), (), (Section("ranking", "Ranking", "", ()),), "")
    file = tmp_path / "page.html"
    file.write_text(render_page(page, Workbench(solver.data, script(), style())), encoding="utf-8")
    shown = opened(chromium, file)
    shown.wait_for_selector("#workbench[data-ready=true]")
    # read in the same task as the click, before anything that follows
    at_once = shown.evaluate(
        """() => {
          document.querySelector("#workbench input[data-effect=stribeck_friction]").click();
          return Number(document.querySelector("#workbench [data-figure=validate]").dataset.value);
        }"""
    )
    shown.wait_for_selector("#workbench[data-ready=true]")
    then = shown.locator("#workbench [data-figure=validate]").get_attribute("data-value")
    expected = identify(dataset, (*FOUND, "stribeck_friction")).error.validate
    assert float(then) == pytest.approx(expected, rel=1e-4)
    assert at_once == pytest.approx(expected, rel=0.05)
    ladder = shown.locator("#workbench svg[role=img]").first.text_content()
    assert "Stribeck friction" in ladder
    assert f"{float(format(100.0 * expected, '.3g')):g} %" in ladder
    shown.close()
