"""Data without a recording to judge on: the page fits all rows as `bench identify` does, and judges on a part."""

import json

import pytest

from bench.cli import main
from bench.dataset.dataset import load_dataset
from bench.diagnosis.split import with_held_out_parts
from bench.identification.identify import identify
from bench.identification.prepare import prepare
from bench.identification.problem import problem_of
from bench.page.parts import Page, Section
from bench.page.render import Workbench, render_page
from bench.signals.settings import FilterSettings
from bench.workbench.page_data import page_data, with_command
from bench.workbench.page_files import script, style
from tests.workbench_kit import FOUND, RECORDINGS, diagnosis_of, write_dataset
from tests.workbench_sets import Carried

LAWS = ("coulomb_friction", "constant_offset", "stribeck_friction", "viscous_friction")
FRICTIONS = ("coulomb_friction", "viscous_friction")
CASES = [
    (robot, requests)
    for robot, found in (("five_bar", FOUND), ("emps", FRICTIONS))
    for requests in ((), found, ("coulomb_friction",), ("constant_offset", "viscous_friction"))
]


@pytest.fixture(scope="module")
def five_bar(tmp_path_factory):
    return write_dataset(tmp_path_factory.mktemp("whole") / "data", recordings=RECORDINGS[:2])


@pytest.fixture(scope="module")
def emps(measured_data, tmp_path_factory):
    log = measured_data / "emps" / "DATA_EMPS.mat"
    if not log.is_file():
        pytest.skip("the measured EMPS data are not here (set PARABENCH_DATA)")
    folder = tmp_path_factory.mktemp("whole") / "emps"
    columns = ["--map", "position.axis=qm", "--map", "current.axis=vir", "--map", "time=t"]
    assert main(["import", str(log), "--robot", "emps", *columns, "-o", str(folder)]) == 0
    return folder


@pytest.fixture(scope="module")
def page(request, tmp_path_factory):
    """For each robot, once: the dataset, what is fitted where a part is judged, and the page."""
    made = {}

    def of(robot):
        if robot not in made:
            dataset = load_dataset(request.getfixturevalue(robot))
            parts, held_out = with_held_out_parts(dataset)
            hidden = FOUND if robot == "five_bar" else FRICTIONS
            data = page_data(problem_of(dataset), diagnosis_of(parts, hidden, LAWS, held_out=held_out))
            data = json.loads(json.dumps(data, allow_nan=False))
            file = tmp_path_factory.mktemp("page") / "page.html"
            page = Page("A page", (), (), (), (Section("ranking", "Ranking", "", ()),), "")
            tool = Workbench(with_command(data, "bench identify data"), script(), style())
            file.write_text(render_page(page, tool), encoding="utf-8")
            made[robot] = (dataset, parts, data, file)
        return made[robot]

    return of


@pytest.mark.parametrize(("robot", "requests"), CASES, ids=str)
def test_all_rows_are_fitted_as_identify_does(page, robot, requests):
    dataset, parts, data, _ = page(robot)
    expected, judged = (
        identify(prepare(problem_of(dataset, requests))),
        identify(prepare(problem_of(parts, requests))),
    )
    for carried, known in ((data["whole"], expected), (data, judged)):
        solver = Carried(carried)
        found = solver.fit(solver.keys(requests))
        assert found.fitted == pytest.approx(known.error.identify, rel=5e-5)
        for gain, other in zip(found.gains, known.drive_gains.values(), strict=True):
            assert gain == pytest.approx(other.value, rel=5e-5)
    assert found.judged == pytest.approx(judged.error.validate, rel=5e-5)
    # the difference that the page would show otherwise
    assert judged.error.identify != pytest.approx(expected.error.identify, rel=1e-3)


@pytest.mark.parametrize(("robot", "requests"), CASES, ids=str)
def test_a_browser_shows_what_identify_shows(chromium, page, robot, requests):
    from bench.page.browser import blank

    dataset, parts, _, file = page(robot)
    expected, judged = (
        identify(prepare(problem_of(dataset, requests))),
        identify(prepare(problem_of(parts, requests))),
    )
    shown = blank(chromium)
    heard = []
    shown.on("console", lambda message: heard.append(message.text))
    shown.on("pageerror", lambda error: heard.append(str(error)))
    shown.goto(f"{file.as_uri()}#workbench?with={','.join(requests) or 'none'}")
    shown.wait_for_selector("#workbench[data-ready=true]")

    def value(name):
        return float(shown.locator(f"#workbench {name}").get_attribute("data-value"))

    assert value("[data-figure=identify]") == pytest.approx(expected.error.identify, rel=5e-5)
    assert value("[data-figure=validate]") == pytest.approx(judged.error.validate, rel=5e-5)
    for joint, gain in expected.drive_gains.items():
        assert value(f"[data-gain={joint}]") == pytest.approx(gain.value, rel=5e-5)
    for effect, joints in expected.effect_parameters.items():
        for joint, values in joints.items():
            for name, known in values.items():
                near = max(1e-4 * abs(known.value), 0.01 * known.std)
                at = f"[data-key='{effect}:{joint}'][data-parameter='{name}']"
                if shown.locator(f"#workbench {at}").count():
                    assert value(at) == pytest.approx(known.value, abs=near), (effect, joint, name)
    status = shown.locator("#workbench [role=status]").text_content()
    assert "fit to all rows" in status
    assert "last 30 % of every recording" in status
    assert heard == []
    shown.close()


def test_filters_set_by_hand_hold_for_all_rows_too(five_bar):
    dataset = load_dataset(five_bar)
    parts, _ = with_held_out_parts(dataset)
    diagnosis = diagnosis_of(
        parts, FOUND, ("coulomb_friction", "viscous_friction"), filters={"decimation": 5}
    )
    assert isinstance(diagnosis.before.settings, FilterSettings)
    solver = Carried(page_data(problem_of(dataset), diagnosis)["whole"])
    expected = identify(prepare(problem_of(dataset, FOUND, filters={"decimation": 5})))
    assert solver.fit(set(FOUND)).fitted == pytest.approx(expected.error.identify, rel=5e-5)
