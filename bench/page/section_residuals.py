"""The section on where a model fails: each motor's error against everything that it may depend on."""

from collections.abc import Sequence

from bench.document.charts.motor import motor_charts
from bench.document.typeset import effect_name, typeset
from bench.effects import CATALOGUE
from bench.page.chart_spec import page_chart
from bench.page.model_errors import ShownModel
from bench.page.parts import Choice, Figure, Linked, PageColumn, PageTable, Section, Variant, row
from bench.page.section_errors import CURRENTS, MOTOR
from bench.residuals.error_breakdown import error_breakdown
from bench.residuals.words import MOST_LOOKS, overlapping, whole_alike, whole_sentences

ON_PAPER = 6  # motors that are printed
LAWS = "laws-alike"  # the id of the table with them


def where_section(models: Sequence[ShownModel]) -> Section:
    """Words and charts for every motor and every model, at first of the last one that leaves more than noise."""
    joints = models[-1].joints
    options = tuple(model.label for model in models)
    laws = _laws(models)
    variants = {}
    for m, model in enumerate(models):
        by_joint = {motor_errors.joint: motor_errors for motor_errors in model.where.motors}
        for j, joint in enumerate(joints):
            motor = by_joint[joint]
            sentences = (typeset(sentence) for sentence in whole_sentences(motor))
            alike = (
                Linked(typeset(sentence), "Laws, and what shows them", LAWS if laws else "")
                for sentence in whole_alike(motor)
            )
            charts = tuple(map(page_chart, motor_charts(error_breakdown(model.what, joint)).values()))
            key = f"{j}|{m}" if len(models) > 1 else f"{j}"
            curves = Linked("Over time:", f"curves of {joint}", CURRENTS, {MOTOR: joint})
            variants[key] = Variant(charts, (*sentences, *alike, curves))
    loud = [
        m
        for m, model in enumerate(models)
        if any(motor_errors.above_noise for motor_errors in model.where.motors)
    ]
    first = loud[-1] if loud else len(models) - 1
    motors = models[first].where.motors
    worst = max(
        motors, key=lambda motor_errors: motor_errors.error / max(motor_errors.noise, 1e-12), default=None
    )
    choices = [Choice("Motor", joints, joints.index(worst.joint) if worst is not None else 0)]
    if len(models) > 1:
        choices.append(Choice("Model", options, first))
    paper = f"|{first}" if len(models) > 1 else ""
    figure = Figure(
        "Error of one motor, all recordings together",
        "Line and dots: means of bins with equally many rows. Shade: their standard deviation. Thin lines: the "
        "smallest and the largest error in each bin, none left out. Grey: ± noise of the current.",
        False,
        tuple(choices),
        variants,
        tuple(f"{j}{paper}" for j in range(len(joints)))[:ON_PAPER],
    )
    introduction = "What chance could do as well is not mentioned; what is mentioned is far beyond it."
    shares = next((words for model in models if (words := overlapping(model.where))), "")
    lead = f"{introduction} {shares}".rstrip()
    return Section("where", "Where it fails", lead, (figure, *laws))


def _laws(models: Sequence[ShownModel]) -> tuple[PageTable, ...]:
    """The effects that leave errors like those identified, each once, with what they are and how they show."""
    alike = (rival for model in models for motor in model.where.motors for rival in motor.alike[:MOST_LOOKS])
    questions: dict[str, int] = {}
    for rival in alike:
        for name in rival.effects:
            questions.setdefault(name, rival.question)
    rows = tuple(
        row(effect_name(name), typeset(CATALOGUE[name].law), CATALOGUE[name].shown_by, f"question {question}")
        for name, question in questions.items()
        if name in CATALOGUE
    )
    if not rows:
        return ()
    columns = (
        PageColumn("effect", "keep"),
        PageColumn("law", "words"),
        PageColumn("shown by", "words"),
        PageColumn("atlas of effects", "keep"),
    )
    aid = "Candidates, the plainest first, from the key of the handbook's atlas; bench diagnose decides between them."
    return (PageTable("Effects that would leave such errors", aid, columns, rows, folded=True, id=LAWS),)
