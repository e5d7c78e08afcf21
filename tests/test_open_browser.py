"""`bench open` in a real browser: from an empty folder to the applied model, by mouse and by keyboard."""

import json
import re
import shlex
import shutil

import pytest
from playwright.sync_api import expect

from bench.cli import main
from bench.dataset.catalogue import built_in_robots
from bench.dataset.dataset import load_dataset
from tests.open_kit import opened, short_dataset, write_log
from tests.patience import PATIENT, ended_at_a_standstill

LEFT = "viscous_friction:left"
PHONE = 390
WIDER = """(width) => document.documentElement.scrollWidth <= width ? [] : [...document.querySelectorAll("body *")]
    .filter((one) => !one.closest(".scroll, svg") && one.getBoundingClientRect().right > width)
    .map((one) => `${one.tagName} ${one.className} ${one.id} ${one.textContent.slice(0, 40)}`)"""


@pytest.fixture(scope="module")
def logs(tmp_path_factory):
    """Two logs, as a controller writes them."""
    folder = tmp_path_factory.mktemp("logs")
    data = short_dataset(folder / "truth")
    for name in ("free", "held"):
        write_log(folder / f"{name}.csv", data, f"{name}.csv")
    return folder


@pytest.fixture
def look(chromium):
    """Open a page; what the browser complained of is in `heard`."""
    pages = []

    def look(site, width=1366, dark=False):
        page = chromium.new_page(
            viewport={"width": width, "height": 900}, color_scheme="dark" if dark else "light"
        )
        page.set_default_timeout(PATIENT)
        expect.set_options(timeout=PATIENT)
        page.heard = []
        page.on("console", lambda message: page.heard.append(message.text))
        page.on("pageerror", lambda error: page.heard.append(str(error)))
        pages.append(page)
        page.goto(site.address)
        return page

    with ended_at_a_standstill():
        yield look
    for page in pages:
        page.close()


def import_by_mouse(page, log, payload, *, again=False):
    """Drop a log, tell what the page asks for, and import it. again: its units are known from a log before."""
    page.locator("#files").set_input_files(log)
    expect(page.locator("#robot")).to_be_visible()
    if page.locator("#robot").input_value() == "":
        page.locator("#robot").select_option("five_bar")
    if again:
        expect(page.locator("#layout")).to_contain_text("those of free.csv, which has the same headers")
        expect(page.locator(".targets .said.fine").nth(1)).to_contain_text("in deg, as you told before")
    else:
        page.get_by_role("button", name="It is in deg").first.click()
    expect(page.locator(".targets .said.fine")).to_have_count(5)
    expect(page.locator("#import")).to_be_disabled()  # nobody has said yet what was on the tool
    if payload:
        page.get_by_role("radio", name="a new one").check()
        page.locator("#payload").fill(payload)
        page.locator("#mass").fill("0.5")
        page.get_by_text("More is known of it").click()
        page.locator("#center").fill("0, 0.02")
        expect(page.locator("#add-log")).to_contain_text("The centre of mass has three numbers")
        expect(page.locator("#import")).to_be_disabled()
        page.locator("#center").fill("")
    else:
        page.get_by_role("radio", name="none").check()
    page.locator("#import").click()
    expect(page.locator("#add-log .done")).to_be_visible()


def export_by_mouse(page):
    """A model as MJCF, what the command says of it, and the file beside it."""
    page.locator("#effects .export").click()
    row = page.locator("#effects .row:has(> #apply):has(> .export)")
    expect(row.locator("xpath=following-sibling::div[1]").locator(".exported")).to_contain_text(
        "the identified base parameters"
    )
    for name, content in ((".xml", b"<mujoco"), (".twin.json", b'"five_bar"')):
        with page.expect_download() as kept:
            page.locator("#effects").get_by_role("link", name=name).click()
        assert content in kept.value.path().read_bytes()


def models_have_names_of_their_own(page):
    """Four links to four models, and no two that are called the same."""
    names = page.get_by_role("link", name="Download the").all_inner_texts()
    models = [name for name in names if "model" in name]
    assert len(models) == len(set(models)) == 4


def curves_go_where_one_clicks_and_share_a_cursor(page):
    """The error of a motor in a recording shows its curves; those of all motors have one time axis and one cursor."""
    motor, recording = page.locator("#errors select").nth(0), page.locator("#errors select").nth(1)
    for joint, name, numbers in (("right", "held.csv", ("1", "1")), ("left", "free.csv", ("0", "0"))):
        page.get_by_label(f"Show {joint} in {name}").click()
        expect(motor).to_have_value(numbers[0])
        expect(recording).to_have_value(numbers[1])
        expect(page.locator("#errors .screen .notes")).to_contain_text(f"{joint} in {name}")
        expect(page.locator("#errors .charts svg[role=img]")).to_be_in_viewport()
    motor.select_option("all side by side")
    curves = page.locator("#errors .charts svg[role=img]")
    expect(curves).to_have_count(2)
    curves.nth(0).hover()
    expect(page.locator("#errors .values:visible")).to_have_count(0)  # nothing hides the curves
    times = page.locator("#errors .caption span:first-child").all_inner_texts()
    first, second = (float(re.search(r"[\d.]+", time).group()) for time in times)
    assert abs(first - second) < 0.2  # the nearest sample that is not in a gap
    box = curves.nth(1).bounding_box()
    page.mouse.move(box["x"] + 0.4 * box["width"], box["y"] + 60)
    page.mouse.down()
    page.mouse.move(box["x"] + 0.6 * box["width"], box["y"] + 60)
    page.mouse.up()
    expect(page.get_by_role("button", name="Show all of it")).to_have_count(2)
    motor.select_option("left")
    expect(curves).to_have_count(1)


def progress_is_at_its_button_and_in_other_pages_apart(page, other):
    """One bar, with a button that cancels; after that, the diagnosis runs again."""
    page.locator("#diagnose").click()
    expect(page.locator("#missing .row:has(> #diagnose) + .running progress")).to_be_visible()
    expect(other.locator("#job progress")).to_be_visible()
    expect(page.locator("#job")).to_be_hidden()
    page.locator("#missing .running").get_by_role("button", name="Cancel").click()
    expect(page.locator("#missing .row:has(> #diagnose) + .over")).to_contain_text("Cancelled")
    expect(other.locator("#job")).to_be_hidden()
    other.close()
    page.locator("#diagnose").click()
    expect(page.locator("#missing .running")).to_have_count(1)
    expect(page.locator("#missing .over")).to_have_count(0)


def the_diagnosis_has_a_card_for_its_effect(page):
    """Name, motor, size and what it saves; the gains of both motors."""
    expect(page.locator("#missing .verdict")).to_contain_text("Viscous friction at left is missing")
    expect(page.locator("#missing .verdict")).to_contain_text("the drive gain of right is")
    expect(page.locator("#missing .gains tbody tr")).to_have_count(2)
    card = page.locator("#missing .card")
    expect(card).to_have_count(1)
    expect(card).to_contain_text(re.compile(r"Viscous friction at left missing.*Fv = 0\.3.* ± .*N·m·s/rad"))
    expect(card).to_contain_text(
        re.compile(r"error \d.* % → 0\.\d* %.*With viscous friction at left the error")
    )


def effects_are_in_groups(page):
    """What the diagnosis established is first and open; a search opens the group of what it looks for."""
    groups = page.locator("#effects .effects details")
    expect(groups.first.locator("summary")).to_have_text("Established by the diagnosis 1")
    expect(page.locator("#effects .effects fieldset:visible")).to_have_count(1)
    expect(page.locator("#effects input:checked")).to_have_count(1)
    page.get_by_label("Search effects").fill("backlash")
    expect(page.locator("#effects .effects fieldset:visible")).to_have_text(re.compile("^Backlash"))
    found = page.locator("#effects .effects details:visible")
    expect(found.locator("summary")).to_have_text(re.compile(r" 1 of \d+$"))
    rules = "(all) => all.map((one) => getComputedStyle(one).borderBottomWidth)"
    shown = page.locator("#effects .effects fieldset:visible")
    assert {*found.evaluate_all(rules), *shown.evaluate_all(rules)} == {"0px"}  # no rule below the last
    page.get_by_label("Search effects").fill("nonsense")
    expect(page.locator("#effects .effects")).to_contain_text("No effect is called so.")
    page.get_by_label("Search effects").fill("")
    expect(page.locator("#effects .effects fieldset:visible")).to_have_count(1)


def what_is_found_is_applied_where_one_clicks(page):
    """How far it is stands below the button, and so does what came of it."""
    expect(page.locator("#apply-found")).to_be_enabled()
    page.locator("#apply-found").click()
    expect(page.locator("#missing .row:has(> #apply-found) + .running progress")).to_be_visible()
    expect(page.locator("#applied-found h3").first).to_have_text("Applied: viscous friction at left")
    expect(page.locator("#applied-found .charts svg[role=img]")).to_have_count(1)
    expect(page.locator("#applied-found h3").first).to_be_in_viewport()
    expect(page.locator("#missing .running")).to_have_count(0)


def a_doubtful_card_has_its_probability_and_the_command_that_decides(page):
    """An answer as of a dataset that cannot tell two effects apart: its command is a line that can be copied."""

    def doubtful(route):
        answer = route.fetch().json()
        answer["ranking"][0] |= {"verdict": "indistinguishable", "probability": 0.93}
        command = "bench discriminate DATASET viscous_friction quadratic_drag -o DIR"
        answer["summary"].append(
            f"It could as well be quadratic drag. The motion is designed by `{command}`."
        )
        route.fulfill(json=answer)

    page.route("**/*-diagnosis.json", doubtful)
    page.reload()
    expect(page.locator("#missing .card")).to_contain_text("probability 0.93")
    line = "bench discriminate my_data viscous_friction quadratic_drag -o my_data.motion"
    expect(page.locator("#missing .verdict .command pre")).to_have_text(line)
    expect(page.locator("#missing .verdict .command").get_by_role("button", name="Copy")).to_be_visible()
    group = page.locator("#effects .effects details").first
    expect(group.locator("summary")).to_have_text("Named by the diagnosis 1")
    expect(group.locator(".badge")).to_have_text("indistinguishable")


@pytest.mark.slow
def test_from_an_empty_folder_to_the_applied_model_by_mouse(look, logs, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with opened(tmp_path, cwd=tmp_path) as site:
        page = look(site)
        expect(page.locator("#dataset-choice")).to_contain_text("drop the first log")
        import_by_mouse(page, logs / "free.csv", "")
        page.locator("#files").set_input_files(
            {"name": "free.csv", "mimeType": "text/csv", "buffer": b"t,q\n0,0\n"}
        )
        expect(page.locator("#add-log [role=alert]")).to_contain_text("another file of that name")
        assert ["400 (Bad Request)" in one for one in page.heard] == [True]
        page.heard.clear()
        import_by_mouse(page, logs / "held.csv", "disc", again=True)
        expect(page.locator("#add-log .done")).to_be_in_viewport()
        expect(page.locator("nav [aria-current]")).to_have_text("1 Recordings")
        expect(page.locator("#recordings-table")).to_contain_text("disc, 0.5 kg")
        page.locator("#compare").click()
        expect(page.locator("#errors .said").first).to_contain_text("motor left: error")
        expect(page.locator("#errors .charts svg[role=img]")).to_have_count(1)
        curves_go_where_one_clicks_and_share_a_cursor(page)
        progress_is_at_its_button_and_in_other_pages_apart(page, look(site))
        the_diagnosis_has_a_card_for_its_effect(page)
        expect(page.locator("#job")).to_be_hidden()
        effects_are_in_groups(page)
        what_is_found_is_applied_where_one_clicks(page)
        page.locator("#identify").click()
        export_by_mouse(page)
        page.locator("#apply").click()
        expect(page.locator("#applied .charts svg[role=img]")).to_have_count(1)
        page.locator("#applied").get_by_role("button", name="Show the robot in motion").click()
        before = page.locator("#applied output").inner_text()
        page.locator("#applied .charts svg[role=img]").hover()
        expect(page.locator("#applied output")).not_to_have_text(before)  # it moves with the time cursor
        command = page.locator("#missing .command pre").inner_text()
        page.locator("#history input").nth(0).check()
        page.locator("#history input").nth(1).check()
        page.locator("#side-by-side").click()
        expect(page.locator("#history")).to_contain_text("has viscous friction at left")
        with page.expect_download() as kept:
            page.get_by_role("link", name="Download the model with these effects").click()
        assert json.loads(kept.value.path().read_text())["effects"] == [LEFT]
        with page.expect_download() as kept:
            page.get_by_role("link", name="Download this dataset").click()
        assert kept.value.suggested_filename == "my_data.zip"
        models_have_names_of_their_own(page)
        a_doubtful_card_has_its_probability_and_the_command_that_decides(page)
        assert page.heard == []
    ours = json.loads((tmp_path / "my_data.results" / "2-diagnosis.json").read_text())
    words = shlex.split(command)[1:]  # the command of the next diagnosis, given in the shell
    assert main([*words[: words.index("-o")], "-q"]) == 0
    assert json.loads((tmp_path / words[words.index("--json") + 1]).read_text()) == ours


def press_until(page, key, wanted, most=200):
    """Press a key until the element that has the focus is the wanted one."""
    for _ in range(most):
        page.keyboard.press(key)
        if page.evaluate("(wanted) => document.activeElement?.matches(wanted)", wanted):
            return
    raise AssertionError(f"no way to {wanted} by {key}")


def tables_are_stacked_on_a_phone(page):
    """Rate and checks of the recordings, and all errors that can be clicked, are on the screen."""
    cells = page.locator("#recordings-table td, #errors td:has(button.place)")
    assert cells.count() == 2 * 6 + 2 * 2
    ends = cells.evaluate_all("(all) => all.map((one) => one.getBoundingClientRect().right)")
    assert max(ends) <= PHONE
    expect(page.locator("#recordings-table td[data-head=rate]").first).to_contain_text("Hz")
    errors = page.locator("#errors td[data-head^=error]").all_inner_texts()
    assert all(re.search(r"(\d\.\d\d|\d\d\.\d|0\.\d{3}|\d{3}) %$", one) for one in errors)


def test_the_same_by_keyboard_and_on_a_phone(look, logs, tmp_path):
    names = {"time": "t_ms", "position.left": "q_left", "position.right": "q_right"}
    names |= {"current.left": "i_left", "current.right": "i_right"}
    words = [word for column, name in names.items() for word in ("--map", f"{column}={name}")]
    words += ["--scale", "time=ms", "--scale", "position=deg", "-o", str(tmp_path / "my_data")]
    words += ["--name", "free_and_slow_on_monday.csv"]  # too long for a phone beside its label
    assert main(["import", str(logs / "free.csv"), "--robot", "five_bar", *words]) == 0
    (tmp_path / "held.csv").write_bytes((logs / "held.csv").read_bytes())
    with opened(tmp_path, cwd=tmp_path) as site:
        page = look(site, width=PHONE, dark=True)
        expect(page.locator("#compare")).to_be_visible()
        expect(page.locator("#effects summary").first).to_have_text(
            "After a diagnosis, or from the whole list"
        )
        for step in ("effects", "history"):  # what has nothing to show yet is one line
            assert page.locator(f"#{step}").evaluate("(part) => part.offsetHeight") < 60
        press_until(page, "Tab", "#add-log .logs button")
        page.keyboard.press("Enter")
        expect(page.locator("#robot")).to_have_value("five_bar")
        press_until(page, "Tab", "[id='unit-position.left']")
        page.keyboard.type("deg")
        press_until(page, "Tab", "[id='unit-position.right']")
        page.keyboard.type("deg")
        expect(page.locator(".targets .said.fine")).to_have_count(5)
        press_until(page, "Tab", "input[name=load]")
        page.keyboard.press("ArrowUp")  # the last choice: a new one
        press_until(page, "Tab", "#mass")
        page.keyboard.type("0.5")
        press_until(page, "Tab", "#import")
        page.keyboard.press("Enter")
        expect(page.locator("#add-log .done")).to_be_visible()
        press_until(page, "Tab", "#compare")
        page.keyboard.press("Enter")
        expect(page.locator("#errors .charts svg[role=img]")).to_have_count(1)
        tables_are_stacked_on_a_phone(page)
        model = json.loads((tmp_path / "my_data.results" / "1-compare" / "model.json").read_text())
        gain = model["drive_gains"]["left"]
        row = page.locator("#errors .gains tr", has_text="left")
        expect(row).to_contain_text(re.compile(rf"{gain['value']:.4f}"[:4] + ".* ± "))
        press_until(page, "Tab", "#effects summary")
        page.keyboard.press("Enter")
        press_until(page, "Tab", "#effects input[type=search]")
        page.keyboard.type("viscous")
        press_until(page, "Tab", "#effects [id='viscous_friction:left']")
        page.keyboard.press("Space")
        expect(page.locator("#apply")).to_be_visible()
        press_until(page, "Tab", "#apply")
        page.keyboard.press("Enter")
        expect(page.locator("#applied .charts svg[role=img]")).to_have_count(1)
        expect(page.locator("#applied h3").first).to_be_in_viewport()
        assert page.evaluate(WIDER, PHONE) == []
        assert page.heard == []
    models = sorted((tmp_path / "my_data.results").glob("model-*.json"))
    assert json.loads(models[-1].read_text())["effects"] == [LEFT]


def test_a_payload_in_grams_is_asked_about_and_a_wrong_import_replaced(look, logs, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    own = tmp_path / "elsewhere" / "my_five_bar"
    shutil.copytree(built_in_robots()["five_bar"], own)
    with opened(tmp_path, "--robot", own, cwd=tmp_path) as site:
        page = look(site)
        page.locator("#files").set_input_files(logs / "held.csv")
        expect(page.locator("#robot")).to_have_value(str(own))  # the one that the command named
        page.locator("#robot").select_option("five_bar")
        mend = "Mend first what stands at position.left, position.right."
        expect(page.locator("#add-log")).to_contain_text(mend)  # the form is drawn, and moves no more
        page.get_by_role("radio", name="none").check()
        expect(page.locator("#import")).to_be_disabled()
        page.locator("#unit-time").select_option("ms")
        page.locator("[id='unit-position.left']").select_option("deg")
        page.locator("[id='column-position.left']").select_option("q_right")
        expect(page.locator("[id='unit-position.left']")).to_have_value(
            "deg"
        )  # the unit is of the joint, not the column
        page.locator("[id='column-position.left']").select_option("q_left")
        page.locator("[id='unit-position.right']").select_option("deg")
        page.get_by_role("radio", name="a new one").check()
        page.locator("#payload").fill("disc")
        page.locator("#mass").fill("1500")
        expect(page.locator("#add-log [role=alert]")).to_contain_text("is that in grams?")
        expect(page.locator("#import")).to_be_disabled()
        page.locator("#meant").click()
        expect(page.locator("#add-log .command pre").last).to_contain_text("--accept mass")
        page.locator("#mass").fill("500")
        expect(page.locator("#import")).to_be_disabled()
        page.locator("#grams").click()
        expect(page.locator("#mass")).to_have_value("0.5")
        page.locator("#import").click()
        expect(page.locator("#add-log .done")).to_be_visible()
        toml = tmp_path / "my_data" / "dataset.toml"
        toml.write_text(toml.read_text().replace("mass = 0.5", "mass = 1500.0"))  # by hand
        page.reload()
        expect(page.locator("#recordings-table")).to_contain_text("is that in grams, 1.5 kg?")
        expect(page.locator("#recordings-table")).not_to_contain_text("all checks passed")
        page.locator("#add-log .logs button").click()
        for column, unit in (("time", "ms"), ("position.left", "deg"), ("position.right", "deg")):
            page.locator(f"[id='unit-{column}']").select_option(unit)
        page.get_by_role("radio", name="a new one").check()
        page.locator("#payload").fill("disc")
        page.locator("#mass").fill("0.5")
        expect(page.locator("#import")).to_have_text("Replace held.csv")
        expect(page.locator("#there")).to_contain_text("kept until the new one is whole")
        page.locator("#import").click()
        expect(page.locator("#add-log .done")).to_be_visible()
        expect(page.locator("#recordings-table")).to_contain_text("disc, 0.5 kg")
        expect(page.locator("#recordings-table")).to_contain_text("all checks passed")
        assert page.heard == []
    assert load_dataset(tmp_path / "my_data").payloads["disc"].mass == 0.5
    assert sorted(path.name for path in (tmp_path / "my_data").iterdir()) == ["dataset.toml", "held.csv"]


def test_names_are_shown_as_they_are_and_never_as_markup(look, tmp_path):
    evil = "<img src=x onerror=document.title='taken'>.csv"
    (tmp_path / evil).write_text("time,<script>document.title='taken'</script>\n0,1\n1,2\n")
    with opened(tmp_path) as site:
        page = look(site)
        button = page.get_by_role("button", name=evil)
        expect(button).to_be_visible()
        button.click()
        held = []
        page.route("**/api/look/columns", lambda route: held.append(route))  # noqa: PLW0108 - it is given attributes
        page.locator("#robot").select_option("five_bar")
        expect(page.locator("#add-log [role=status]")).to_contain_text(f"Reading {evil} (1 kB).")
        while not held:
            page.wait_for_timeout(10)
        held[0].continue_()
        expect(page.locator(".chips")).to_contain_text("<script>")
        expect(page.locator("#add-log [role=status]")).to_have_count(0)
        assert page.locator("main img, main script").count() == 0
        assert "taken" not in page.title()


def test_the_policy_stops_what_does_not_belong(look, tmp_path):
    with opened(tmp_path) as site:
        page = look(site)
        expect(page.locator("#dataset-choice")).to_contain_text("drop the first log")
        page.evaluate("document.body.append(Object.assign(new Image(), {src: 'http://127.0.0.1:9/x.png'}))")
        page.evaluate(
            "document.body.append(Object.assign(document.createElement('script'), {textContent: 'window.foreign = 1'}))"
        )
        page.wait_for_timeout(100)
        assert page.evaluate("window.foreign") is None
        assert sum("Content Security Policy" in one for one in page.heard) == 2


def test_a_page_says_what_cannot_be_and_when_its_server_is_gone(look, logs, tmp_path):
    shutil.copytree(logs / "truth", tmp_path / "data")
    (tmp_path / "data.results").touch()  # no folder can be made there, as in one that is read only
    with opened(tmp_path) as site:
        page = look(site)
        for step in ("errors", "missing", "effects"):
            expect(page.locator(f"#{step}")).to_contain_text("data.results: cannot be made: File exists")
            expect(page.locator(f"#{step} button.main").first).to_be_disabled()
        expect(page.locator("#banner")).to_be_hidden()
        page.evaluate("document.getElementById('job').hidden = false")
    expect(page.locator("#banner")).to_contain_text("If it was ended, so was what ran")
    expect(page.locator("#banner")).to_contain_text("start it again with: bench open")
    expect(page.locator("#job")).to_be_hidden()


def test_later_steps_of_a_dataset_whose_robot_has_moved_refer_to_the_reason(look, logs, tmp_path):
    shutil.copytree(logs / "truth", tmp_path / "data")
    toml = tmp_path / "data" / "dataset.toml"
    model = tmp_path / "data.results" / "model-1.json"
    model.parent.mkdir()
    assert main(["identify", str(toml.parent), "--with", LEFT, "--json", str(model)]) == 0
    toml.write_text(re.sub(r"(?m)^robot = .*$", 'robot = "../moved"', toml.read_text()))
    with opened(tmp_path) as site:
        page = look(site)
        expect(page.locator("#recordings-table .fault")).to_contain_text(
            "neither a built-in robot nor a folder"
        )
        for step in ("errors", "missing", "effects"):
            expect(page.locator(f"#{step}")).to_contain_text(
                "This dataset cannot be read: step 1 has the reason."
            )


def test_a_second_browser_hears_of_what_the_first_does(look, logs, tmp_path):
    with opened(tmp_path) as site:
        first, second = look(site), look(site, dark=True)
        expect(second.locator("#dataset-choice")).to_contain_text("drop the first log")
        import_by_mouse(first, logs / "free.csv", "")
        expect(second.locator("#recordings-table")).to_contain_text("free.csv")
        expect(second.locator("#recordings-table")).to_contain_text("✓ all checks passed")
        first.locator("#add-log .logs button").click()
        expect(first.locator("#into")).to_have_value("my_data")
        first.get_by_role("radio", name="none").check()
        first.locator("#into").select_option(label="a new dataset")
        expect(first.locator("#name")).to_have_value("my_data_2")
        expect(first.locator("#import")).to_be_enabled()
        first.locator("#name").fill("my_data")
        expect(first.locator("#add-log")).to_contain_text("my_data: is there already")
        expect(first.locator("#import")).to_be_disabled()


def test_what_was_chosen_of_a_log_is_there_after_a_reload(look, logs, tmp_path):
    (tmp_path / "free.csv").write_bytes((logs / "free.csv").read_bytes())
    with opened(tmp_path, cwd=tmp_path) as site:
        page = look(site, width=PHONE, dark=True)
        page.locator("#add-log .logs button").click()
        page.locator("#robot").select_option("five_bar")
        page.locator("[id='column-current.left']").select_option("i_right")
        page.locator("[id='column-current.right']").select_option("i_left")
        page.locator("[id='unit-position.left']").select_option("deg")
        page.locator("[id='unit-position.right']").select_option("deg")
        page.locator("#rate").fill("1000")
        page.get_by_role("radio", name="a new one").check()
        page.locator("#payload").fill("disc")
        page.locator("#mass").fill("0.5")
        page.get_by_role("radio", name="only compare with it").check()
        page.locator("#name").fill("monday")
        command = page.locator("#add-log .command pre")
        expect(command).to_contain_text("monday")
        line = command.inner_text()
        for word in ("current.left=i_right", "position.left=deg", "--rate 1000.0", "--use validate", "disc"):
            assert word in line
        page.reload()
        expect(command).to_have_text(line)
        expect(page.locator("#rate")).to_have_value("1000")
        assert page.evaluate(WIDER, PHONE) == []
        (tmp_path / "free.csv").unlink()
        page.reload()
        expect(page.locator("#add-log")).to_contain_text("A robot of your own")
        expect(page.locator("#robot")).to_have_count(0)  # the log is gone, and so is what was chosen of it
        assert page.heard == []
    with opened(tmp_path, cwd=tmp_path) as site:
        kept = look(site).evaluate("JSON.stringify(sessionStorage)")
        assert "monday" not in kept  # a new server begins anew


def test_a_robot_of_one_s_own_is_made_of_its_mjcf_and_takes_a_log_with_lines_on_top(
    look, logs, tmp_path, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    log = tmp_path / "outside" / "free.csv"
    log.parent.mkdir()
    log.write_text("one,two,three,four,five,six\n" + (logs / "free.csv").read_text())
    shutil.copy(built_in_robots()["five_bar"] / "five_bar.xml", log.parent / "my_arm.xml")
    (tmp_path / "opened").mkdir()
    with opened(tmp_path / "opened", cwd=tmp_path) as site:
        page = look(site, width=PHONE)
        page.locator("#files").set_input_files(log.parent / "my_arm.xml")
        expect(page.locator("#add-log [role=status]")).to_contain_text("my_arm.xml is in the folder")
        expect(page.locator("#mjcf")).to_have_value("my_arm.xml")
        expect(page.locator("#make-robot")).to_be_disabled()
        for joint, gain in (("left", "3"), ("right", "3.2")):
            page.locator(".motors label").filter(has_text=f"{joint} hinge").locator("input").check()
            page.get_by_label(f"Nominal drive gain of {joint}", exact=True).fill(gain)
        expect(page.locator("#robot-tool")).to_have_value("tool")
        assert page.evaluate(WIDER, PHONE) == []
        line = page.locator("#own-robot .command pre").inner_text()
        page.locator("#make-robot").click()
        expect(page.locator("#make-robot")).to_have_count(0)  # made: the panel is new
        page.locator("#files").set_input_files(log)
        page.locator("#robot").select_option("my_arm")
        page.locator("#skip").fill("1")
        page.locator("#skip").press("Enter")
        page.get_by_role("button", name="It is in deg").first.click()
        expect(page.locator(".targets .said.fine")).to_have_count(5)
        page.get_by_role("radio", name="none").check()
        expect(page.locator("#add-log .command pre").last).to_contain_text("--skip-rows 1")
        page.locator("#import").click()
        expect(page.locator("#add-log .done")).to_be_visible()
        assert page.heard == []
    written = tmp_path / "opened" / "my_arm" / "robot.toml"
    ours = written.read_bytes()
    written.unlink()
    assert main(shlex.split(line)[1:]) == 0  # the command in the shell
    assert written.read_bytes() == ours
    assert load_dataset(tmp_path / "opened" / "my_data").robot.nominal_gains.tolist() == [3.0, 3.2]
