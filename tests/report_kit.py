"""A diagnosis written by hand, and what a page says of it; nothing is fitted or searched."""

import html.parser
import re
from dataclasses import replace
from pathlib import Path

from bench.dataset.robot import load_robot
from bench.diagnosis.reason import Because, Reason
from bench.diagnosis.result import Diagnosis, EffectVerdict, LadderStep, Remainder, Unexplained
from bench.identification.problem import problem_of
from bench.page.pages import diagnosis_page, identification_page
from bench.page.render import render_page
from bench.page.section_run import Made
from tests.shown import dataset_of, identification_of

MISSING = EffectVerdict(
    "viscous_friction", "missing", 0.12, 0.01, 812.4, ("left",), (), {"left": 0.33}, Reason(Because.EXPLAINS)
)
DOUBTFUL = replace(
    MISSING,
    effect="current_delay",
    verdict="indistinguishable",
    evidence=2.0,
    actuators=(),
    alternatives=("viscous_friction",),
    size={},
    why=Reason(Because.AS_GOOD),
)
UNSUPPORTED = replace(
    DOUBTFUL, effect="backlash", verdict="not supported", alternatives=(), why=Reason(Because.GAINS_NOTHING)
)
ABSORBED = replace(
    DOUBTFUL, effect="rotor_inertia", verdict="absorbed", alternatives=(), why=Reason(Because.TAKEN_UP)
)
AGAIN = Made(("bench diagnose data -o results", "bench report results -o report.html"))


def dataset():
    return dataset_of(load_robot("five_bar"))


def diagnosis(data=None, name="five_bar"):
    data = data or dataset()
    before, after = identification_of(data), identification_of(data, effects=True)
    moved = {**after.drive_gains, "left": replace(after.drive_gains["left"], value=3.63)}
    return Diagnosis(
        robot=name,
        held_out=0.0,
        missing=("viscous_friction",),
        ladder=(LadderStep((), 0.11, 0.12), LadderStep(("viscous_friction",), 0.0099, 0.01)),
        ranking=(MISSING, DOUBTFUL, UNSUPPORTED, ABSORBED),
        unexplained=Unexplained(Remainder.NOISE, 0.01, 0.0098, ()),
        before=before,
        after=replace(after, drive_gains=moved),
    )


def diagnosed_page():
    data = dataset()
    return diagnosis_page(diagnosis(data), problem_of(data), AGAIN)


def identified_page(**changes):
    data = dataset()
    return identification_page(replace(identification_of(data), **changes), problem_of(data), AGAIN)


def write(path: Path, page) -> Path:
    path.write_text(render_page(page), encoding="utf-8")
    return path


class Tags(html.parser.HTMLParser):
    """Every tag with its attributes, and the words that are shown."""

    def __init__(self, text):
        super().__init__()
        self.tags, self.said, self._inside = [], [], None
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        self.tags.append((tag, dict(attributes)))
        self._inside = tag if tag in ("script", "style") else None

    def handle_endtag(self, tag):
        self._inside = None

    def handle_data(self, data):
        if self._inside is None:
            self.said.append(data)

    @property
    def words(self):
        return re.sub(r"\s+", " ", " ".join(self.said))
