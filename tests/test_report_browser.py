"""The report in a real browser: nothing asked for, nothing wrong, keyboard, colours, phone, paper."""

import re
from dataclasses import replace

import numpy as np
import pytest
from playwright.sync_api import expect

from docs.pictures.browser import blank, scrolled
from tests.report_kit import dataset, diagnosed_page, identified_page, write
from tests.shown import identification_of

PHONE = 390
PAPER = (688, 1017)  # px, of A4 within its margins


@pytest.fixture(scope="module")
def report(tmp_path_factory):
    return write(tmp_path_factory.mktemp("report") / "report.html", diagnosed_page())


@pytest.fixture
def look(chromium, report):
    """Open the report; what the browser complained of and asked for is in `heard`."""
    pages = []

    def look(path=report, **options):
        heard = []
        page = blank(chromium, **options)
        page.on("console", lambda message: heard.append(message.text))
        page.on("pageerror", lambda error: heard.append(str(error)))
        page.on("request", lambda request: heard.append(request.url))
        pages.append(page)
        page.goto(path.resolve().as_uri())
        heard.remove(path.resolve().as_uri())
        page.heard = heard
        return page

    yield look
    for page in pages:
        page.close()


def colours(page, *names):
    style = "getComputedStyle(document.documentElement).getPropertyValue"
    return [page.evaluate(f"{style}('--{name}').trim()") for name in names]


def test_all_figures_are_drawn_and_nothing_is_wrong_or_asked_for(look):
    page = scrolled(look())
    assert page.heard == []
    for holder in page.locator("[data-figure]").all():
        assert holder.locator("svg[role=img]").count() >= 1
    assert page.locator("#currents svg path.line").count() >= 4
    assert page.locator("svg text", has_text="NaN").count() == 0
    assert page.evaluate(
        "[...document.querySelectorAll('svg path')].every((p) => !/NaN|Infinity/.test(p.outerHTML))"
    )


def test_a_page_of_an_identification_is_drawn_too(look, tmp_path):
    page = scrolled(look(write(tmp_path / "identified.html", identified_page())))
    assert page.heard == []
    assert page.locator("#gains .plot circle").count() == 2


def test_the_policy_stops_what_does_not_belong(look):
    page = look()
    page.evaluate("document.body.append(Object.assign(new Image(), {src: 'http://127.0.0.1:9/x.png'}))")
    page.evaluate(
        "document.body.append(Object.assign(document.createElement('script'), {textContent: 'window.foreign = 1'}))"
    )
    page.wait_for_timeout(100)
    assert page.evaluate("window.foreign") is None
    assert sum("Content Security Policy" in one for one in page.heard) == 2


def test_choosing_a_motor_shows_its_curves(look):
    page = look()
    page.locator("#currents").scroll_into_view_if_needed()
    before = page.locator("#currents svg[role=img]").get_attribute("aria-label")
    shown, other = ("left", "right") if "left" in before else ("right", "left")
    assert shown in before
    page.locator("#currents .segments label", has_text=other).click()
    after = page.locator("#currents svg[role=img]").get_attribute("aria-label")
    assert other in after
    assert other in page.locator("#currents .notes").inner_text()


def test_where_it_fails_leads_to_the_curves_and_those_of_all_motors_share_a_cursor(look):
    page = scrolled(look())
    joints = page.locator("#currents .segments label").all_inner_texts()
    assert joints[-1] == "all side by side"
    for joint in joints[:-1]:
        page.locator("#where .segments label", has_text=joint).first.click()
        page.locator("#where").get_by_role("link", name=f"curves of {joint}").click()
        expect(page.locator("#currents .segments label:has(:checked)")).to_have_text(joint)
        assert joint in page.locator("#currents .notes").inner_text()
    page.locator("#currents .segments label", has_text="all side by side").click()
    curves = page.locator("#currents svg[role=img]")
    expect(curves).to_have_count(len(joints) - 1)
    assert page.locator("#currents .charts h4").all_inner_texts() == joints[:-1]
    captions = page.locator("#currents .caption")
    resting = captions.all_inner_texts()
    assert all(re.match(r"error [\d.]+\s%", text) for text in resting)  # the heading has the name
    before = curves.first.bounding_box()
    curves.first.hover()
    expect(page.locator("#currents .values:visible")).to_have_count(0)  # nothing hides the curves
    expect(captions.first).to_have_text(re.compile(r"at .* s.*measured .* A.*error .* A"))
    assert curves.first.bounding_box() == before
    page.mouse.move(0, 0)
    expect(captions.first).to_have_text(resting[0])
    assert page.heard == []


def test_a_rounded_zero_has_no_sign_and_level_errors_are_a_condition(look):
    page = look()
    known = page.evaluate(
        "[[-1e-8, 6.6e-5], [-0.004, 0.0012]].map((pair) => ChartBasics.formatKnown(...pair))"
    )
    assert known == ["0.000000", "−0.0040"]
    assert "If level with the band, nothing depends on it." in page.locator("#figures").text_content()


def landed(page, name):
    """How far the heading of a section stands from where a link should bring it, px, once the page is still."""
    page.evaluate("""async () => {
        let before = NaN;
        while (before !== scrollY) {
            before = scrollY;
            await new Promise((done) => setTimeout(done, 150));
        }
    }""")
    return page.evaluate(
        """(name) => {
            const root = document.documentElement;
            const wanted = document.getElementById(name).getBoundingClientRect().top + scrollY - 16;
            return Math.abs(scrollY - Math.min(wanted, root.scrollHeight - innerHeight));
        }""",
        name,
    )


def test_a_link_lands_on_its_section(look, report):
    page = look()
    for name in ("where", "gains", "run"):
        page.locator(f"nav.contents a[href='#{name}']").click()
        assert landed(page, name) <= 2, name
        page.goto("about:blank")
        page.goto(f"{report.resolve().as_uri()}#{name}")
        assert landed(page, name) <= 2, name


def test_a_phone_has_the_contents_in_reach_wherever_it_is_read(look):
    page = look(width=PHONE)
    for name in ("currents", "run"):
        link = page.locator(f"nav.contents a[href='#{name}']")
        link.click()
        landed(page, name)
        expect(link).to_have_attribute("aria-current", "true")
        expect(link).to_be_in_viewport(ratio=0.9)
        top = page.evaluate("(name) => document.getElementById(name).getBoundingClientRect().top", name)
        assert top >= page.locator("nav.contents").bounding_box()["height"] - 2, name
        assert top < 200, name


def test_effects_that_leave_such_errors_lead_to_their_laws(look, tmp_path):
    series = tuple(
        replace(one, modelled=one.measured + 0.05 * np.sign(one.velocity))
        for one in identification_of(dataset()).recordings
    )
    page = look(write(tmp_path / "alike.html", identified_page(recordings=series)))
    page.locator("nav.contents a[href='#where']").click()
    page.locator("#where .notes a").first.click()
    laws = page.locator("#laws-alike table")
    expect(laws).to_be_in_viewport()
    expect(laws).to_contain_text("Fc sign(q̇)")
    expect(laws.locator("tr", has_text="τ = Fc sign(q̇)").first).to_contain_text("question 1")


def test_values_under_the_pointer_have_units_and_stand_once(look):
    page = look()
    page.locator("#currents").scroll_into_view_if_needed()  # charts are drawn when they come near
    plot = page.locator("#currents svg[role=img]")
    plot.scroll_into_view_if_needed()
    plot.hover()
    said = page.locator("#currents .values p").all_inner_texts()
    assert said[0].startswith("at ")
    assert said[0].endswith(" s")
    assert all(one.endswith(" A") for one in said[1:])
    assert len(set(said)) == len(said) == 5  # measured, modelled, and two errors


def test_the_keyboard_reaches_theme_choices_and_details(look):
    page = look()
    motor = page.locator("#currents input:checked").first.get_attribute("value")
    page.keyboard.press("Tab")
    assert page.evaluate("document.activeElement.id") == "theme"
    page.keyboard.press("Enter")
    assert page.locator("#theme").inner_text() == "Colours: light"
    page.keyboard.press("Enter")
    assert page.locator("#theme").inner_text() == "Colours: dark"
    wanted, reached = {"a", "radio", "summary"}, set()
    for _ in range(120):
        page.keyboard.press("Tab")
        kind = page.evaluate("document.activeElement.type || document.activeElement.tagName.toLowerCase()")
        if kind not in reached and kind == "radio":
            page.keyboard.press("ArrowRight")
        if kind not in reached and kind == "summary":
            page.keyboard.press("Enter")
        reached.add(kind)
        if wanted <= reached:
            break
    assert wanted <= reached
    now = page.locator("#currents input:checked").first.get_attribute("value")
    assert now != motor
    assert {motor, now} < {"0", "1", "all"}
    assert page.locator("#ranking details").first.get_attribute("open") is not None
    assert page.heard == []


def test_light_and_dark_follow_the_system_and_the_switch(look):
    light, dark = look(), look(dark=True)
    assert colours(light, "ground", "measured") == ["#ffffff", "#0072b2"]
    assert colours(dark, "ground", "measured") == ["#14181d", "#56b4e9"]
    dark.locator("#theme").click()
    assert colours(dark, "ground", "measured") == ["#ffffff", "#0072b2"]
    light.locator("#theme").click()
    light.locator("#theme").click()
    assert colours(light, "ground") == ["#14181d"]


@pytest.mark.parametrize("dark", [False, True])
def test_text_stands_out_from_its_ground(look, dark):
    """Contrast of words and lines after WCAG 2: 4.5 for text, 3 for what is drawn."""
    page = look(dark=dark)
    ground, *text = [luminance(one) for one in colours(page, "ground", "ink", "quiet", "accent", "warn")]
    assert min(contrast(ground, one) for one in text) >= 4.5
    drawn = [
        luminance(one) for one in colours(page, "measured", "modelled", "error", "before", "after", "noise")
    ]
    assert min(contrast(ground, one) for one in drawn) >= 3.0


def luminance(colour):
    parts = [int(colour[i : i + 2], 16) / 255 for i in (1, 3, 5)]
    linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in parts]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def contrast(a, b):
    return (max(a, b) + 0.05) / (min(a, b) + 0.05)


@pytest.mark.parametrize("width", [PHONE, 768, 1366])
def test_nothing_is_wider_than_the_screen(look, width):
    page = scrolled(look(width=width, height=844))
    assert page.evaluate("document.documentElement.scrollWidth") <= width
    wide = page.evaluate(
        """(width) => [...document.querySelectorAll("body *")].filter((one) =>
             !one.closest(".scroll, pre, svg, nav.contents") && one.getBoundingClientRect().right > width + 1
           ).map((one) => one.outerHTML.slice(0, 80))""",
        width,
    )
    assert wide == []


def test_labels_stay_inside_their_figures_and_apart(look):
    """Of every figure: no text is cut at its edges, and no two ticks of the x axis touch."""
    for width in (PHONE, 1366):
        page = scrolled(look(width=width))
        bad = page.evaluate(
            """() => {
              const bad = [];
              for (const svg of document.querySelectorAll("svg[role=img]")) {
                const frame = svg.getBoundingClientRect();
                const texts = [...svg.querySelectorAll("text")].map((t) => [t.textContent, t.getBoundingClientRect()]);
                for (const [text, box] of texts)
                  if (box.left < frame.left - 3 || box.right > frame.right + 6) bad.push(`cut: ${text}`);
                for (let i = 0; i < texts.length; i++)
                  for (let k = i + 1; k < texts.length; k++) {
                    const [a, b] = [texts[i][1], texts[k][1]];
                    const across = Math.min(a.right, b.right) - Math.max(a.left, b.left);
                    const down = Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top);
                    if (across > 1 && down > 4) bad.push(`${svg.ariaLabel}: ${texts[i][0]} / ${texts[k][0]}`);
                  }
              }
              return bad;
            }"""
        )
        assert bad == []


def test_curves_are_enlarged_by_dragging_across_them(look):
    page = look()
    page.locator("#currents").scroll_into_view_if_needed()  # drawn when they are near
    curves = page.locator("#currents svg.curves").first
    curves.scroll_into_view_if_needed()
    whole = curves.text_content()
    box = curves.bounding_box()
    across = box["y"] + 0.2 * box["height"]
    page.mouse.move(box["x"] + 0.4 * box["width"], across)
    page.mouse.down()
    page.mouse.move(box["x"] + 0.6 * box["width"], across)
    page.mouse.up()
    back = page.get_by_role("button", name="Show all of it")
    assert back.count() == 1
    enlarged = curves.text_content()
    assert enlarged != whole
    curves.click()  # which is no drag
    assert curves.text_content() == enlarged
    assert page.evaluate("getSelection().toString()") == ""
    back.click()
    assert curves.text_content() == whole
    assert page.heard == []


def test_it_prints_with_everything_unfolded(look, tmp_path):
    page = look(dark=True)
    page.pdf(path=tmp_path / "report.pdf", prefer_css_page_size=True)
    pages = (tmp_path / "report.pdf").read_bytes()
    assert pages.startswith(b"%PDF")
    assert pages.count(b"/Type /Page\n") + pages.count(b"/Type /Page/") + pages.count(b"/Type /Page ") >= 4
    assert page.heard == []
    assert page.locator(".printed").count() == 0  # and the screen is as before


def test_on_paper_all_motors_are_drawn_in_light_colours(look):
    page = look(dark=True)
    page.emulate_media(media="print")
    page.evaluate("dispatchEvent(new Event('beforeprint'))")
    assert colours(page, "ground") == ["#ffffff"]
    assert page.locator("details:not([open])").count() == 0
    for section, count in (("currents", 2), ("where", 2)):
        assert page.locator(f"#{section} .printed:visible h4:first-child").count() >= count
    assert not page.locator("#theme").is_visible()
    page.set_viewport_size({"width": PAPER[0], "height": PAPER[1]})
    heights = page.evaluate(
        "[...document.querySelectorAll('#currents .printed')].map((one) => one.getBoundingClientRect().height)"
    )
    assert len(heights) >= 2
    assert max(heights) < PAPER[1] / 2  # two to a page: the next one never leaves the half of it empty
    page.evaluate("dispatchEvent(new Event('afterprint'))")
    assert page.locator("details[open]").count() == 0


def test_a_chart_of_many_points_is_drawn_anew_quickly(look):
    """The workbench draws curves again at every tick; the limit is generous, the page's own aim is 0.2 s."""
    page = look()
    seconds = page.evaluate(
        """() => {
          const holder = document.body.appendChild(document.createElement("div"));
          const wave = (phase) => Array.from({length: 4000}, (_, i) => Math.sin(i / 50 + phase));
          const figure = (phase) => ({
            x: {label: "time [s]"},
            panels: [0, 1, 2].map((k) => ({y: {label: "current [A]"}, series: [
              {kind: "line", role: "measured", name: "measured", x: {start: 0, step: 0.01}, y: wave(phase + k)},
              {kind: "envelope", role: "error", name: "wide", x: {start: 0, step: 1}, low: wave(0), high: wave(phase)},
            ]})),
          });
          const chart = Charts.create(holder, figure(0));
          const first = holder.querySelector(".plot path.line").getAttribute("d");
          const start = performance.now();
          for (let n = 1; n <= 5; n++) chart.update(figure(n));
          const each = (performance.now() - start) / 5000;
          if (holder.querySelector(".plot path.line").getAttribute("d") === first) throw new Error("not drawn anew");
          chart.destroy();
          if (holder.children.length) throw new Error("not removed");
          return each;
        }"""
    )
    assert seconds < 2.0
