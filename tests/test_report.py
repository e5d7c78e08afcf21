"""The report: what stands on the page and in which order, what the file may do, and how large it is."""

import base64
import hashlib
import json
import re
from dataclasses import asdict, replace

import numpy as np
import pytest

from bench.diagnosis.result import Remainder, Unexplained
from bench.document.typeset import effect_name, share, typeset
from bench.identification.problem import problem_of
from bench.page.chart_spec import extremes, rounded, thinned
from bench.page.pages import diagnosis_page
from bench.page.parts import Figure, Page, PageTable, Section, Text
from bench.page.render import Workbench, render_page
from bench.page.section_run import CommandRun
from bench.page.verdict import diagnosis_verdict
from tests.report_kit import (
    AGAIN,
    DOUBTFUL,
    MISSING,
    Tags,
    dataset,
    diagnosed_page,
    diagnosis,
    identified_page,
)

ORDER = [
    "verdict",
    "ladder",
    "ranking",
    "currents",
    "where",
    "gains",
    "parameters",
    "conditioning",
    "limits",
    "run",
]


@pytest.fixture(scope="module")
def page():
    return diagnosed_page()


@pytest.fixture(scope="module")
def text(page):
    return render_page(page)


@pytest.fixture(scope="module")
def read(text):
    return Tags(text)


def figures(text):
    (found,) = re.findall(
        r'<script type="application/json" id="figures">(.*?)</script>', text, flags=re.DOTALL
    )
    return json.loads(found)


def test_sections_stand_in_the_order_in_which_an_engineer_reads(read):
    assert [tag["id"] for name, tag in read.tags if name == "section"] == ORDER
    contents = [tag["href"] for name, tag in read.tags if name == "a"]
    assert contents == [f"#{name}" for name in ORDER]


def test_the_verdict_is_three_sentences(page, read):
    assert len(page.verdict) == 3
    assert page.verdict[0].startswith("Viscous friction at left is missing")
    assert "from 12\u00a0% to 1\u00a0% of the current" in page.verdict[0]
    assert "the drive gain of left is 3.63" in page.verdict[1]
    assert (
        page.verdict[2]
        == "The remaining error (1\u00a0%) is at the noise floor of the currents (0.98\u00a0%)."
    )
    assert all(sentence in " ".join(read.said) for sentence in page.verdict)


def test_doubts_and_gains_share_the_second_sentence():
    doubtful = replace(MISSING, verdict="indistinguishable", alternatives=("current_delay", "quadratic_drag"))
    sentences = diagnosis_verdict(replace(diagnosis(), ranking=(doubtful, DOUBTFUL)))
    assert len(sentences) == 3
    assert "the drive gain of left is" in sentences[1]
    assert "instead of viscous friction it could as well be current delay or quadratic drag" in sentences[1]


def test_every_gain_is_said_once():
    middle = diagnosis_page(diagnosis(), problem_of(dataset()), AGAIN).verdict[1]
    assert "drive gain of left is" in middle
    assert "the other drive gains, with the change from nominal: right 3.3000" in middle
    assert "left 3" not in middle


def test_nothing_missing_takes_three_sentences_too():
    found = diagnosis()
    nothing = replace(found, missing=(), ladder=found.ladder[:1], after=found.before, ranking=(DOUBTFUL,))
    page = diagnosis_page(nothing, problem_of(dataset()), AGAIN)
    assert page.verdict[0].startswith("No effect of the catalogue is missing")
    assert len(page.verdict) == 3
    assert "change from the nominal value: left 3.3000 ± 0.0015 N·m/A (+10.00" in page.verdict[1]
    assert " and right 3.3000 ± 0.0015" in page.verdict[1]
    ladder = next(one for one in page.sections if one.id == "ladder")
    assert [one.type for one in ladder.parts] == ["text", "table", "table"]  # one dot is no figure
    assert "No effect was added" in ladder.parts[0].paragraphs[0]
    render_page(page)


def test_what_was_found_stands_on_the_page(read):
    for words in (
        "812.4",
        "indistinguishable",
        "Current delay would explain the data as well as viscous friction: these recordings cannot distinguish them.",
        "Adding backlash improves nothing on recordings that were not fitted",
        "no data of this robot could show",
        "mx(left_crank)",
        "+ 0.2 m(left_rod) − 0.667 mx(left_rod)",
        "loaded.csv",
        "numpy",
        "bench diagnose data -o results",
        "A note that says what limits the answer",
    ):
        assert words in read.words, words


def test_every_figure_and_table_has_a_title_and_a_way_to_read_it(page):
    parts = [part for section in page.sections for part in section.parts]
    for part in parts:
        if isinstance(part, PageTable | Figure):
            assert part.title
            assert part.aid
    for part in parts:
        for variant in part.variants.values() if isinstance(part, Figure) else ():
            for chart in variant.charts:
                assert chart.title or len(variant.charts) == 1
                assert chart.spec["label"]
                shown = [one for panel in chart.spec["panels"] for one in panel["series"]]
                assert shown
                # an axis is named, with its unit, or it is one of names
                for axis in (chart.spec["x"], *(panel["y"] for panel in chart.spec["panels"])):
                    assert axis.get("label") or axis.get("scale") == "band"


def test_every_motor_recording_and_model_can_be_chosen(text):
    found = figures(text)
    currents, where = found["currents-0"], found["where-0"]
    assert [len(one["options"]) for one in currents["choices"]] == [2, 3]
    assert set(currents["variants"]) == {f"{j}|{k}" for j in range(2) for k in range(3)}
    assert [one["options"] for one in where["choices"]] == [
        ["left", "right"],
        ["Model as it is", "Completed model"],
    ]
    titles = [chart["title"] for chart in where["variants"]["0|1"]["charts"]]
    for wanted in (
        "velocity",
        "position",
        "acceleration",
        "time",
        "payload",
        "Spectrum",
        "Autocorrelation",
        "Histogram",
    ):
        assert any(wanted in title for title in titles), wanted


def test_currents_on_the_page_are_those_of_the_model(text):
    (one,) = figures(text)["currents-0"]["variants"]["0|0"]["charts"]
    series = {line["name"]: line for panel in one["spec"]["panels"] for line in panel["series"]}
    recording = diagnosis().after.recordings[0]
    moving = recording.moving[:, 0]
    drawn = np.array([np.nan if v is None else v for v in series["measured"]["y"]])
    np.testing.assert_allclose(drawn, recording.measured[moving, 0], atol=2e-4)
    band = series["± noise of the current"]
    assert band["high"] == -band["low"] > 0


def test_the_policy_allows_what_is_in_the_file_and_nothing_else(text, read):
    (policy,) = [
        tag["content"] for name, tag in read.tags if tag.get("http-equiv") == "Content-Security-Policy"
    ]
    rules = dict(rule.strip().split(" ", 1) for rule in policy.split(";"))
    assert rules["default-src"] == "'none'"
    assert rules["img-src"] == "data:"
    assert "unsafe" not in policy
    for kind, pattern in (("script-src", r"<script>(.*?)</script>"), ("style-src", r"<style>(.*?)</style>")):
        hashes = [
            f"'sha256-{base64.b64encode(hashlib.sha256(one.encode()).digest()).decode()}'"
            for one in re.findall(pattern, text, flags=re.DOTALL)
        ]
        assert hashes
        assert rules[kind].split() == hashes


def test_the_file_asks_for_nothing(text, read):
    addresses = [
        tag[key] for _, tag in read.tags for key in ("src", "href", "action", "data", "srcset") if key in tag
    ]
    assert [one for one in addresses if not one.startswith(("#", "data:"))] == []
    assert not any("style" in tag or any(key.startswith("on") for key in tag) for _, tag in read.tags)
    without = text.replace("http://www.w3.org/2000/svg", "")  # the name of a language, not an address
    assert re.findall(r"https?://|//[a-z]+\.[a-z]", without) == []
    for word in (
        "@import",
        "url(http",
        "eval(",
        "new Function",
        "innerHTML",
        "document.write",
        "fetch(",
        "XMLHttp",
    ):
        assert word not in text, word


def test_names_in_the_data_cannot_become_tags(page):
    bad = "</script><img src=x onerror=alert(1)>"
    (currents,) = (section for section in page.sections if section.id == "currents")
    figure = currents.parts[0]
    variants = {key: replace(one, notes=(bad,)) for key, one in figure.variants.items()}
    sections = (
        Section("currents", bad, bad, (Text(bad, (bad,)), replace(figure, variants=variants))),
        *(section for section in page.sections[1:] if section is not currents),
    )
    read = Tags(render_page(replace(page, title=bad, sections=sections)))
    assert not [name for name, _ in read.tags if name == "img"]
    assert bad in read.words


def test_a_usual_page_is_small(text):
    assert len(text.encode()) < 600_000  # two motors; 3 MB is the limit for large runs


def test_the_content_is_plain_data(page):
    again = json.loads(json.dumps(asdict(page)))
    assert again["verdict"] == list(page.verdict)


def test_a_workbench_stands_below_the_ranking_and_under_the_same_policy(page):
    tool = Workbench({"name": "</script>"}, "window.Workbench = {start() {}};", "#workbench { color: red; }")
    text = render_page(page, tool)
    read = Tags(text)
    ids = [tag["id"] for name, tag in read.tags if name == "section"]
    assert ids.index("workbench") == ids.index("ranking") + 1
    (policy,) = [tag["content"] for _, tag in read.tags if tag.get("http-equiv")]
    assert base64.b64encode(hashlib.sha256(tool.script.encode()).digest()).decode() in policy
    assert '{"name":"\\u003c/script>"}' in text
    assert 'id="workbench' not in render_page(page)


def test_a_script_that_would_end_itself_is_refused(page):
    with pytest.raises(ValueError, match="</"):
        render_page(page, Workbench({}, "const end = '</script>';"))


def test_what_is_to_be_typed_is_set_so():
    text = render_page(Page("A page", (), ("First `bench diagnose <x>`.",), (), (), ""))
    assert "<p>First <code>bench diagnose &lt;x&gt;</code>.</p>" in text


def test_nominal_gains_are_said_to_be_nominal():
    page = identified_page(gains_fitted=False)
    (gains,) = [section for section in page.sections if section.id == "gains"]
    assert "stay at their nominal values" in gains.lead
    assert any("nominal" in sentence for sentence in page.verdict)
    assert not [part for part in gains.parts if isinstance(part, Figure)]


def test_what_was_not_done_is_said():
    page = identified_page()
    words = Tags(render_page(page)).words
    assert "which effects it lacks was not looked for" in words
    assert "ladder" not in [section.id for section in page.sections]


def test_something_left_is_among_the_limits():
    found = diagnosis()
    left = Unexplained(Remainder.PATTERN, 0.05, 0.01, ("velocity",))
    page = diagnosis_page(replace(found, unexplained=left), problem_of(dataset()), AGAIN)
    (limits,) = [section for section in page.sections if section.id == "limits"]
    assert any("depends on velocity" in item for item in limits.parts[0].items)
    assert page.verdict[2].startswith("The remaining error is 5\u00a0% of the current")


def test_extremes_lose_no_outlier():
    random = np.random.default_rng(4)
    values = random.standard_normal(10_007)
    values[[17, 5000, 10_006]] = 50.0, -60.0, 70.0
    values[200:260] = np.nan
    kept = extremes(values, 25)
    assert len(kept) == 2 * -(-len(values) // 25)
    for stretch in range(len(kept) // 2):
        part = values[25 * stretch : 25 * stretch + 25]
        pair = kept[2 * stretch : 2 * stretch + 2]
        if np.isnan(part).all():
            assert np.isnan(pair).all()
        else:
            assert {pair.min(), pair.max()} == {np.nanmin(part), np.nanmax(part)}
    assert {50.0, -60.0, 70.0} <= set(kept.tolist())


def test_short_curves_are_drawn_whole_with_their_gaps():
    row = np.array([2, 3, 4, 8, 9])
    x, curves, width = thinned(row, 0.1, {"a": np.arange(5.0)}, 100)
    assert width == 1
    assert (x["start"], x["step"]) == (pytest.approx(0.2), pytest.approx(0.1))
    assert curves["a"] == [0.0, 1.0, 2.0, None, None, None, 3.0, 4.0]


def test_long_curves_keep_their_place_in_time():
    row = np.arange(100_000)
    values = np.zeros(100_000)
    values[77_777] = 9.0
    x, curves, width = thinned(row, 0.001, {"a": values}, 1000)
    assert width == 200
    assert len(curves["a"]) == 1000
    at = x["start"] + x["step"] * curves["a"].index(9.0)
    assert at == pytest.approx(77.777, abs=0.1)


def test_rounding_is_finer_than_a_pixel():
    values = np.array([0.0, 1.23456789e-7, np.nan, 9.87654321e-7])
    short = rounded(values)
    assert short[2] is None
    np.testing.assert_allclose([short[0], short[1], short[3]], values[[0, 1, 3]], atol=1e-6 / 2000)
    assert rounded(np.array([12345.678, 99999.9]))[0] == pytest.approx(12345.678, abs=50)
    assert rounded(np.array([5.0])) == [5.0]


def test_numbers_are_set_as_in_print():
    assert typeset("moves by -6.8 % to 1.2e-05, 30% of coulomb_friction") == (
        "moves by −6.8\u00a0% to 1.2·10⁻⁵, 30\u00a0% of coulomb_friction"
    )
    assert effect_name("coulomb_friction") == "Coulomb friction"
    assert effect_name("stribeck_friction") == "Stribeck friction"
    assert typeset("run-2.csv") == "run-2.csv"
    assert share(-0.0679, signed=True) == "−6.79\u00a0%"


def test_the_command_is_given_back_as_it_was_given():
    run = CommandRun(
        "diagnose",
        "my data",
        ("coulomb_friction:left",),
        ("own.py",),
        {"decimation": 10, "border": (49, 0), "keep_standstill": True, "essential": False},
        "out",
    )
    assert run.line() == (
        "bench diagnose 'my data' --with coulomb_friction:left --effect-file own.py --decimation 10 "
        "--border 49,0 --keep-standstill -o out"
    )
