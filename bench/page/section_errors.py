"""Sections on the errors: the ladder, errors by recording and motor, the currents, and where each motor fails."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

from bench.basics.plural import plural
from bench.diagnosis.reason_words import validated_on
from bench.diagnosis.result import Diagnosis
from bench.diagnosis.split import dataset_of
from bench.document import identification as document
from bench.document.charts.chart import Role
from bench.document.charts.currents import Curve, currents_chart, ladder_chart
from bench.document.charts.motor import motor_charts
from bench.document.diagnosis import ladder_table
from bench.document.numbers import USES
from bench.document.typeset import effect_name, share, typeset
from bench.effects import CATALOGUE
from bench.identification.model_file import Comparison
from bench.identification.problem import Problem
from bench.identification.result import CurrentSeries, Identification
from bench.page.chart_spec import chart_figure, page_chart, rows_a_pair, spec_of
from bench.page.parts import (
    Choice,
    Figure,
    Kind,
    Linked,
    Mechanism,
    PageChart,
    PageTable,
    Section,
    Text,
    Variant,
    on_page,
    page_table,
)
from bench.residuals.error_breakdown import error_breakdown
from bench.residuals.look_alikes import possible_effects
from bench.residuals.motor import Compared, MotorSeries, compared, relative_error_of, relative_noise
from bench.residuals.residuals import MotorErrors, WhereItFails, errors_by_motor
from bench.residuals.words import MOST_LOOKS, overlapping, whole_alike, whole_sentences
from bench.signals.settings import FilterSettings

MOST_NUMBERS = 45_000  # of all curves of the currents together: about 0.4 MB
MOST_POINTS, FEWEST_POINTS = 1200, 120  # of one curve
MOST_FIGURES = 240  # motors times recordings
CURRENTS, MOTOR = "currents", "Motor"  # the section of the curves, and its choice
ON_PAPER = 8  # variants of the currents that are printed
ERROR_AID = "Error: RMS(measured − modelled current) over RMS(measured current), where the joint moves."
MOTORS_ON_PAPER = 6  # motors that are printed
LAWS, ATLAS = "laws-alike", "atlas of effects"  # the table of laws with similar errors, and a column of it


@dataclass(frozen=True, eq=False)
class ShownModel:
    """A model's errors in the recordings. name: used as in "error ..."; label: its option; role: its errors' colour."""

    name: str
    role: Role
    what: Compared
    where: WhereItFails
    label: str = ""

    @property
    def joints(self) -> tuple[str, ...]:
        """The motors that move in at least one recording."""
        return tuple(joint for joint in self.what.joints if self.what.of(joint))

    def one(self, joint: str, recording: str) -> MotorSeries | None:
        """The series of one motor in one recording; None if it hardly moves."""
        return next((trace for trace in self.what.of(joint) if trace.recording == recording), None)


def shown_model(
    name: str,
    role: Role,
    problem: Problem,
    model: Identification | Comparison,
    settings: FilterSettings,
    has: Sequence[str] | None = None,
    label: str = "",
) -> ShownModel:
    """Find where a model's errors are. problem: with the dataset of the model's series.

    has: the model's effects; if given, others that would leave such errors are named. name, label: see `ShownModel`.
    """
    dataset = dataset_of(problem.dataset, model.recordings)
    what = compared(dataset.robot, dataset.recordings, model.recordings, settings)
    possible = {} if has is None else possible_effects(problem)
    return ShownModel(name, role, what, errors_by_motor(what, possible, has or ()), label)


def ladder_section(diagnosis: Diagnosis, errors: PageTable) -> Section:
    """The error after each added effect. errors: those of the last model."""
    steps, floor = diagnosis.ladder, diagnosis.unexplained.noise_floor
    judged = f"judged on {validated_on(diagnosis)}."
    lead = f"How the error falls as effects are added, the one that helps most first; {judged}"
    figure: Figure | Text = chart_figure(ladder_chart(diagnosis), 300)
    if len(steps) == 1:
        lead = f"No effect helps beyond chance; {judged}"
        leaves = (
            f"the model as it is leaves an error of {share(steps[0].reported)}, noise alone {share(floor)}."
        )
        figure = Text("", (typeset(f"No effect was added: {leaves}"),))
    title = "The same in numbers" if len(steps) > 1 else "In numbers"
    table = on_page(ladder_table(diagnosis), title, ERROR_AID)
    return Section("ladder", "The ladder", typeset(lead), (figure, table, errors), "Ladder")


def errors_section(shown: ShownModel, recordings: Sequence[CurrentSeries], noise: float) -> Section:
    """The errors of one model, by recording and motor."""
    title, lead = "Errors", "How far the modelled currents are from the measured ones, beside their noise."
    return Section("errors", title, lead, (errors_table(shown, recordings, noise),))


def errors_table(shown: ShownModel, recordings: Sequence[CurrentSeries], noise: float) -> PageTable:
    """Errors by recording and motor, fitted and not fitted, with totals. noise: relative, of all motors together."""
    joints = list(shown.what.joints)
    many = len(joints) > 1
    by_motor = [motor.noise for motor in shown.where.motors]
    noises = (by_motor, noise) if many and len(by_motor) == len(joints) else None
    title = "Error by recording and motor" if many else "Error by recording"
    if shown.name:
        title += f", {shown.name}"
    return on_page(document.errors_table(recordings, joints, noises), title, ERROR_AID)


def currents_section(
    models: Sequence[ShownModel], moving: Callable[[str, str], Mechanism | Text] | None = None
) -> Section:
    """Measured and modelled current of every motor in every recording, with the errors below.

    moving: gives the moving robot from a recording's name and option; called for the recording shown first.
    """
    last = models[-1]
    joints = last.joints
    names = list(dict.fromkeys(trace.recording for trace in last.what.series if trace.joint in joints))
    dropped = max(0, len(joints) * len(names) - MOST_FIGURES)
    if dropped:
        names = names[: max(1, MOST_FIGURES // len(joints))]
    curves = 2 + len(models) + (len(models) > 1)
    most = MOST_NUMBERS // max(1, curves * len(joints) * len(names))
    most = min(max(most, FEWEST_POINTS), MOST_POINTS)
    variants, widths = {}, set()
    for j, joint in enumerate(joints):
        for k, name in enumerate(names):
            of_models = [
                (model.role, model.name, series) for model in models if (series := model.one(joint, name))
            ]
            if len(of_models) < len(models):
                variants[f"{j}|{k}"] = Variant((), (f"{joint} hardly moves in {name}: nothing to show.",))
                continue
            chart = currents_chart(of_models, last.what.units[joint][0], f"Current of {joint} in {name}")
            widths.add(rows_a_pair(chart, most))
            spec = spec_of(chart, 150 + 115 * len(chart.panels), most=most)
            heading, facts = _facts(joint, of_models)
            shown = PageChart("", "", {**spec, "facts": facts})
            variants[f"{j}|{k}"] = Variant((shown,), (f"{heading}: {facts}",))
    worst = [_worst(last, joint, names) for joint in joints]
    first = worst[_loudest(last)] if worst else 0
    loads = {trace.recording: trace for trace in last.what.series}
    options = tuple(
        f"{name} ({USES[loads[name].use]}{', ' + str(loads[name].payload) if loads[name].payload else ''})"
        for name in names
    )
    aid = "Modelled should lie on measured; an error inside the grey band is noise."
    if any(len(trace.row) and trace.row[-1] - trace.row[0] >= len(trace.row) for trace in last.what.series):
        aid += " Gaps: the joint stands still or reverses, which is neither fitted nor judged."
    if widths and max(widths) > 1:
        aid += f" Of every {max(widths)} rows the smallest and the largest value are drawn: no outlier is left out."
    if dropped:
        aid += f" The first {len(names)} recordings are shown; the tables count all."
    figure = Figure(
        "Current and error over time",
        aid,
        True,
        (
            Choice(MOTOR, joints, _loudest(last), "all side by side" if len(joints) > 1 else ""),
            Choice("Recording", options, first),
        ),
        variants,
        tuple(f"{j}|{k}" for j, k in enumerate(worst))[:ON_PAPER],
    )
    lead = "Every motor in every recording, at the rate and bandwidth of the fit."
    robot = () if moving is None else (moving(names[first], options[first]),)
    return Section(CURRENTS, "Measured against modelled", lead, (figure, *robot), "Measured, modelled")


def _facts(joint: str, curves: Sequence[Curve]) -> tuple[str, str]:
    """What is shown, a motor in a recording, and its errors."""
    errors = [f"{share(relative_error_of([trace]))} {name}".rstrip() for _, name, trace in curves]
    trace = curves[-1][2]
    noise = relative_noise([trace]) if trace.measured.any() else None
    said_of = f"with payload {trace.payload}" if trace.payload else "without payload"
    rows = plural(len(trace.time), "row")
    heading = f"{joint} in {trace.recording}, {said_of}"
    return heading, f"error {', '.join(errors)}; noise {share(noise)}; {rows} that move."


def _loudest(shown: ShownModel) -> int:
    """Index of the motor with the largest error relative to its noise, the one most worth looking at."""
    beyond = {motor.joint: _beyond(motor) for motor in shown.where.motors if motor.above_noise}
    return max(range(len(shown.joints)), key=lambda j: beyond.get(shown.joints[j], 0.0), default=0)


def _beyond(motor: MotorErrors) -> float:
    """A motor's error relative to its noise."""
    return motor.error / max(motor.noise, 1e-12)


def _worst(shown: ShownModel, joint: str, names: Sequence[str]) -> int:
    """Index of the recording with the largest error, among those not fitted if there are any."""
    by_name = {trace.recording: trace for trace in shown.what.of(joint) if trace.recording in names}
    unseen = [trace for trace in by_name.values() if trace.use == "validate"] or list(by_name.values())
    errors = next(motor.by_recording for motor in shown.where.motors if motor.joint == joint)
    worst = max(unseen, key=lambda trace: errors[trace.recording][0])
    return names.index(worst.recording)


def where_section(models: Sequence[ShownModel]) -> Section:
    """Sentences and charts for every motor and model; initially of the last model that leaves more than noise."""
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
    loud = [m for m, model in enumerate(models) if any(motor.above_noise for motor in model.where.motors)]
    first = loud[-1] if loud else len(models) - 1
    worst = max(models[first].where.motors, key=_beyond, default=None)
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
        tuple(f"{j}{paper}" for j in range(len(joints)))[:MOTORS_ON_PAPER],
    )
    introduction = "What chance could do as well is not mentioned; what is mentioned is far beyond it."
    shares = next((words for model in models if (words := overlapping(model.where))), "")
    return Section("where", "Where it fails", f"{introduction} {shares}".rstrip(), (figure, *laws))


def _laws(models: Sequence[ShownModel]) -> tuple[PageTable, ...]:
    """A table of effects that would leave errors like the models', each once, with its law and how to excite it."""
    alike = (rival for model in models for motor in model.where.motors for rival in motor.alike[:MOST_LOOKS])
    questions: dict[str, int] = {}
    for rival in alike:
        for name in rival.effects:
            questions.setdefault(name, rival.question)
    rows = [
        (effect_name(name), typeset(CATALOGUE[name].law), CATALOGUE[name].shown_by, f"question {question}")
        for name, question in questions.items()
        if name in CATALOGUE
    ]
    if not rows:
        return ()
    heads: Mapping[str, Kind] = {"effect": "keep", "law": "words", "shown by": "words", ATLAS: "keep"}
    aid = "Candidates, the plainest first, from the key of the handbook's atlas; bench diagnose decides between them."
    title = "Effects that would leave such errors"
    return (replace(page_table(title, aid, heads, rows, folded=True), id=LAWS),)
