"""The workbench in a real browser: its figures are those of `bench identify --with`, to four digits."""

import json
import math
import re

import pytest
from playwright.sync_api import expect

from bench.cli import main
from bench.dataset.dataset import load_dataset
from bench.diagnosis.split import with_held_out_parts
from bench.identification.identify import identify
from bench.identification.model_file import apply_model, load_model, model_json
from bench.identification.prepare import prepare
from bench.identification.problem import problem_of
from bench.page.workbench.page_data import page_data
from docs.pictures.browser import blank
from tests.workbench_kit import ABSORBED, FOUND, RECORDINGS, diagnosis_of, write_dataset, write_page
from tests.workbench_sets import Carried

LAWS = (
    "coulomb_friction",
    "current_delay",
    "drive_flexibility",
    "geometric_error",
    "load_dependent_friction",
    "passive_viscous_friction",
    "rotor_inertia",
    "stribeck_friction",
    "viscous_friction",
)
FRICTIONS = ("coulomb_friction", "viscous_friction")


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A dataset, and a page with nothing but the workbench."""
    folder = tmp_path_factory.mktemp("workbench")
    dataset = load_dataset(write_dataset(folder / "data"))
    diagnosis = diagnosis_of(dataset, names=LAWS)
    data, model = page_data(problem_of(dataset), diagnosis), model_json(diagnosis.after, dataset.folder)
    (folder / "page.json").write_text(json.dumps(data))
    write_page(folder / "page.html", data, model)
    return folder


@pytest.fixture
def look(chromium, folder):
    pages = []

    def look(address="", file=folder / "page.html", **options):
        page = blank(chromium, **options)
        pages.append(page)
        page.heard = []
        page.on("console", lambda message: page.heard.append(message.text))
        page.on("pageerror", lambda error: page.heard.append(str(error)))
        page.on("request", lambda request: page.heard.append(request.url))
        page.goto(file.as_uri() + address)
        page.heard = [one for one in page.heard if not one.startswith(file.as_uri())]
        return converged(page)

    yield look
    for page in pages:
        page.close()


def converged(page):
    page.wait_for_selector("#workbench[data-ready=true]")
    return page


def press(page, place, key="Space"):
    page.locator(place).focus()
    page.keyboard.press(key)
    return converged(page)


def shown(page):
    """Numbers on the page: errors, gains by joint, effect parameters by key."""
    return page.evaluate(
        """() => {
          const value = (one) => Number(one.dataset.value);
          const all = (name) => [...document.querySelectorAll(`#workbench ${name}`)];
          return {
            error: Object.fromEntries(all("[data-figure]").map((one) => [one.dataset.figure, value(one)])),
            words: Object.fromEntries(all("[data-figure]").map((one) => [one.dataset.figure, one.textContent])),
            deviations: Object.fromEntries(all("[data-deviation]").map((one) => [one.dataset.deviation, value(one)])),
            gains: Object.fromEntries(all("[data-gain]").map((one) => [one.dataset.gain, value(one)])),
            parameters: all("[data-parameter]").map((one) => [one.dataset.key, one.dataset.parameter, value(one)]),
            then: Object.fromEntries(all(".bench-effect").map((one) =>
              [one.dataset.effect, value(one.querySelector(".bench-then"))])),
          };
        }"""
    )


def identified(folder, *requests):
    answer = folder / "answer.json"
    asked = [word for one in requests for word in ("--with", one)]
    assert main(["identify", str(folder / "data"), *asked, "--json", str(answer)]) == 0
    return json.loads(answer.read_text())


def agree(seen, answer, sure=None):
    for use in ("identify", "validate"):
        assert seen["error"][use] == pytest.approx(answer["error"][use], rel=5e-5)
        digits = format(100.0 * answer["error"][use], ".4g")
        assert seen["words"][use] == f"{float(digits):g} %"
    for joint, gain in answer["drive_gains"].items():
        assert seen["gains"][joint] == pytest.approx(gain["value"], rel=5e-5)
    compared = 0
    for key, name, value in seen["parameters"]:
        effect, _, place = key.partition(":")
        known = answer["effect_parameters"][effect][place or "robot"][name]
        if sure is None or (key, name) in sure:
            # four digits of what is known at all: a hundredth of its deviation where that is wider
            near = max(1e-4 * abs(known["value"]), 0.01 * known["std"])
            assert value == pytest.approx(known["value"], abs=near), (key, name)
            compared += 1
    assert compared == len(sure or seen["parameters"])


def as_found(seen, folder, *requests):
    """The page's figures are those that `solve_set` gives with what the page carries."""
    carried = Carried(json.loads((folder / "page.json").read_text()))
    answer = carried.fit(carried.keys(requests))
    assert seen["error"]["identify"] == pytest.approx(answer.fitted, rel=1e-5), requests
    assert seen["error"]["validate"] == pytest.approx(answer.held_out, rel=1e-5), requests
    assert list(seen["gains"].values()) == pytest.approx(list(answer.gains), rel=2e-5), requests


def test_what_was_found_is_ticked_and_agrees(look, folder):
    page = look()
    seen = shown(page)
    agree(seen, identified(folder, *FOUND))
    for joint, gain in seen["gains"].items():  # to two digits of the standard error, which stands beside it
        decimals = 1 - math.floor(math.log10(seen["deviations"][joint]))
        cells = page.locator(f"tr:has([data-gain={joint}]) td").all_inner_texts()
        assert f"{gain:.{decimals}f} ± {seen['deviations'][joint]:.{decimals}f} N·m/A" in cells
    assert page.locator("[data-effect=coulomb_friction] input[data-effect]").is_checked()
    assert page.get_by_role("button", name="Found by diagnose").get_attribute("aria-pressed") == "true"
    assert page.heard == []


def test_effects_ticked_by_keyboard_agree_with_the_command(look, folder):
    page = look()
    page.get_by_role("button", name="Nothing").focus()
    page.keyboard.press("Enter")
    before = shown(converged(page))
    agree(before, identified(folder))
    page.keyboard.press("Tab")  # on to the first effect
    assert page.evaluate("document.activeElement.dataset.effect") == "coulomb_friction"
    page.keyboard.press("Space")
    one = shown(converged(page))
    agree(one, identified(folder, "coulomb_friction:left"))  # where it was ticked before
    assert before["then"]["coulomb_friction"] == pytest.approx(one["error"]["validate"], rel=1e-9)
    two = shown(press(page, "input[data-effect=stribeck_friction]"))
    assert one["then"]["stribeck_friction"] == pytest.approx(two["error"]["validate"], rel=1e-9)
    press(page, "input[data-effect=coulomb_friction]")
    as_found(shown(page), folder, "stribeck_friction")
    command = page.locator("#workbench pre").text_content()
    assert command == "bench identify 'my data' \\\n  --with stribeck_friction"
    assert page.heard == []


def test_with_nothing_ticked_a_sentence_stands_for_the_ladder(look):
    """A point on its axis says nothing."""
    page = look()
    title = page.locator(".part", has=page.get_by_role("heading", name="Error, effect by effect"))
    chart, alone = title.locator(".chart"), page.locator(".bench-alone")
    expect(chart).to_be_visible()
    expect(alone).to_be_hidden()
    page.get_by_role("button", name="Nothing").click()
    seen = shown(converged(page))
    expect(chart).to_be_hidden()
    expect(alone).to_contain_text("No effect is ticked: the model as it is leaves an error of")
    assert f"{100.0 * seen['error']['validate']:.3g}" in alone.text_content()
    press(page, "input[data-effect=coulomb_friction]")
    expect(chart).to_be_visible()
    expect(alone).to_be_hidden()
    assert page.heard == []


def test_every_effect_is_fitted_at_once_as_a_diagnosis_fits_a_set(look, folder):
    page = look()
    places = {
        "coulomb_friction": ["coulomb_friction:left"],
        "viscous_friction": ["viscous_friction:left"],
    }  # as found
    for name in LAWS:
        # read in the same task as the clicks, before anything that follows; what is absorbed is not listed
        at_once = page.evaluate(
            """(name) => {
              document.querySelector("#workbench .bench-buttons button:nth-child(3)").click();
              document.querySelector(`#workbench input[data-effect=${name}]`)?.click();
              return Number(document.querySelector("#workbench [data-figure=validate]").dataset.value);
            }""",
            name,
        )
        seen = shown(page)
        assert at_once == seen["error"]["validate"]
        as_found(seen, folder, *(() if name in ABSORBED else places.get(name, [name])))
    assert page.heard == []


def test_without_recordings_to_judge_on_the_parts_of_the_diagnosis_are_told(look, tmp_path):
    dataset = load_dataset(write_dataset(tmp_path / "data", recordings=RECORDINGS[:2]))
    parts, held_out = with_held_out_parts(dataset)
    data = page_data(problem_of(dataset), diagnosis_of(parts, names=FRICTIONS, held_out=held_out))
    write_page(tmp_path / "page.html", data)
    seen = shown(page := look(file=tmp_path / "page.html"))
    known = identify(prepare(problem_of(parts, FOUND)))
    assert seen["error"] == pytest.approx(
        {"identify": known.error.identify, "validate": known.error.validate}, rel=5e-5
    )
    gains = {joint: gain.value for joint, gain in known.drive_gains.items()}
    assert seen["gains"] == pytest.approx(gains, rel=5e-5)
    said = page.locator("#workbench [role=status]").text_content()
    assert "fitted without the last 30 % of every recording" in said


def test_places_of_an_effect_can_be_ticked_one_by_one(look, folder):
    page = look()
    opener = "[data-effect=geometric_error] .bench-open"
    press(page, opener, "Enter")
    assert page.locator(opener).get_attribute("aria-expanded") == "true"
    press(page, "input[data-key='geometric_error:left_rod']")
    as_found(
        shown(page), folder, "coulomb_friction:left", "geometric_error:left_rod", "viscous_friction:left"
    )
    some = page.locator("[data-effect=geometric_error] .bench-some")
    assert some.text_content() == "A dash: at 1 of 5 places: left_rod"
    assert page.locator("[data-effect=geometric_error] input[data-effect]").evaluate(
        "one => one.indeterminate"
    )


def test_the_address_holds_the_choice_and_back_takes_it_back(look, folder):
    page = look()
    press(page, "input[data-effect=viscous_friction]")
    page.get_by_label("Motor").select_option(label="right")
    converged(page)
    address = page.evaluate("location.hash")
    assert re.fullmatch(r"#workbench\?with=coulomb_friction:left&motor=right&recording=\S+", address)
    seen = shown(page)
    again = look(address)
    assert shown(again) == seen
    assert again.get_by_label("Motor").evaluate("one => one.selectedOptions[0].text") == "right"
    page.go_back()
    converged(page)
    page.go_back()
    converged(page)
    agree(shown(page), identified(folder, *FOUND))
    assert page.heard == [] == again.heard


def test_what_stays_as_found_is_said(look, folder):
    page = look("#workbench?with=drive_flexibility,stribeck_friction")
    status = page.locator("#workbench [role=status]").text_content()
    assert "Drive flexibility and Stribeck friction: in the shape" in status
    assert "may find other values" in status
    assert "Shapes, such as a speed or a period, stay" in page.locator("#workbench .lead").text_content()
    assert "as found" in page.locator("[data-parameter=vs]").first.text_content()
    assert "rotor inertia" in page.locator("#workbench .bench-list").text_content()
    as_found(shown(page), folder, "drive_flexibility", "stribeck_friction")
    assert page.locator("#workbench [role=status]").is_visible()
    assert look().locator("#workbench [role=status]").text_content() == ""  # the model that diagnose fitted


def test_deviations_stand_beside_the_gains_of_what_was_fitted(look, folder):
    page = look()
    for requests in (FOUND, ()):
        known = identified(folder, *requests)["drive_gains"]
        seen = shown(page)["deviations"]
        assert seen == {joint: pytest.approx(one["std"], rel=1e-6) for joint, one in known.items()}
        page.get_by_role("button", name="Nothing").click()
        converged(page)
    press(page, "input[data-effect=rotor_inertia], input[data-effect=stribeck_friction]")
    assert shown(page)["deviations"] == {}


def test_the_command_can_be_copied_and_the_model_downloaded(look, tmp_path, folder):
    page = look()
    page.get_by_role("button", name="Copy the command").click()
    expect(page.locator(".bench-command button")).to_have_text(re.compile("Copied|Selected"))
    with page.expect_download() as given:
        page.get_by_role("button", name="Download model").click()
    given.value.save_as(tmp_path / "model.json")
    compared = apply_model(problem_of(load_dataset(folder / "data")), load_model(tmp_path / "model.json"))
    assert compared.error.validate == pytest.approx(shown(page)["error"]["validate"], rel=5e-5)
    page.get_by_role("button", name="Nothing").click()
    converged(page)
    assert page.get_by_role("button", name="Download model").is_disabled()
    assert page.heard == []


def test_two_models_stand_beside_each_other(look):
    page = look()
    before = shown(page)
    page.get_by_role("button", name="Keep as A").click()
    page.get_by_role("button", name="Nothing").click()
    converged(page)
    words = page.locator(".bench-pinned").text_content()
    assert words.startswith("A: Coulomb friction at left, viscous friction at left; not fitted ")
    assert before["words"]["validate"] in words
    assert "error of A" in page.locator("#workbench").text_content()
    of_a = page.locator("#workbench tr").filter(has_text="left of A").text_content()
    assert f"{before['gains']['left']:.3f}" in of_a
    assert "±" in of_a
    page.get_by_role("button", name="Let go of A").click()
    assert page.locator(".bench-pinned").text_content() == ""
    assert page.locator("#workbench tr").filter(has_text="of A").count() == 0


@pytest.mark.parametrize("width", [390, 1366])
def test_buttons_are_large_enough_for_a_finger(look, width):
    page = look(width=width)
    sizes = page.evaluate(
        """() => [...document.querySelectorAll("#workbench button")].map((one) => one.getBoundingClientRect())
          .map((box) => [box.width, box.height])"""
    )
    assert len(sizes) > 8
    assert all(min(size) >= 24 for size in sizes)


@pytest.mark.parametrize("width", [390, 1366])
def test_nothing_is_wider_than_the_page(look, width):
    page = look(width=width)
    assert page.evaluate("document.documentElement.scrollWidth") <= width
    assert page.locator("#workbench svg[role=img]").count() == 2


def test_a_choice_that_the_page_does_not_know_is_left_out(look, folder):
    page = look("#workbench?with=warp_drive,coulomb_friction&motor=third&recording=%E0%A4")
    agree(shown(page), identified(folder, *FOUND))
    page = look("#workbench?with=warp_drive,coulomb_friction&motor=third")
    agree(shown(page), identified(folder, "coulomb_friction"))
