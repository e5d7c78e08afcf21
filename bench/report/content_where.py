"""The section on where a model fails: each motor's error against everything that it may depend on."""

from collections.abc import Sequence

from bench.compare.words import finding_sentences, level_sentence
from bench.report.chart_motor import error_charts
from bench.report.parts import Choice, Figure, Section, Variant
from bench.report.shown import Shown
from bench.report.words import typeset

ON_PAPER = 6  # motors that are printed


def where_section(models: Sequence[Shown]) -> Section:
    """Words and charts for every motor and every model, the last model's first."""
    joints = models[-1].joints
    options = tuple(one.name.capitalize() for one in models)
    variants = {}
    for m, model in enumerate(models):
        by_joint = {one.joint: one for one in model.where.motors}
        for j, joint in enumerate(joints):
            motor = by_joint[joint]
            notes = tuple(
                typeset(f"{one[:1].upper()}{one[1:]}.")
                for one in (level_sentence(motor), *finding_sentences(motor))
            )
            charts = error_charts(model.what.of(joint), model.what.units[joint])
            key = f"{j}|{m}" if len(models) > 1 else f"{j}"
            variants[key] = Variant(charts, notes)
    choices = [Choice("Motor", joints)]
    if len(models) > 1:
        choices.append(Choice("Model", options, len(models) - 1))
    last = f"|{len(models) - 1}" if len(models) > 1 else ""
    figure = Figure(
        "Error of one motor, all recordings together",
        "Line and dots: means of bins with equally many rows. Shade: their standard deviation. Thin lines: the "
        "smallest and the largest error in each bin, none left out. Grey: ± noise of the current.",
        False,
        tuple(choices),
        variants,
        tuple(f"{j}{last}" for j in range(len(joints)))[:ON_PAPER],
    )
    lead = "What chance could do as well is not mentioned; what is mentioned is far beyond it."
    return Section("where", "Where it fails", lead, (figure,))
