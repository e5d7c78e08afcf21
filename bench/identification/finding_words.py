"""What limits an answer, in words that say what to do: one sentence or two for each code."""

from collections.abc import Callable, Mapping

from bench.dataset.heavy_payload import HeavyPayload
from bench.effects.display_names import begun, spoken
from bench.effects.select import ROBOT, TAG
from bench.identification.band_words import BAND_WORDS
from bench.identification.finding import UNBELIEVABLE, Code, Finding, Unknown
from bench.identification.scale_words import CODES, scale_sentence
from bench.identification.wording import and_list, in_percent, with_error


def note(finding: Finding) -> str:
    """A finding as it stands among the notes on an answer."""
    said = sentence(finding)
    return f"This answer is not to be believed. {said}" if finding.code in UNBELIEVABLE else said


def sentence(finding: Finding) -> str:
    """A finding by itself."""
    return WORDS[finding.code](finding)


def _gain_not_determined(finding: Finding) -> str:
    gains = and_list([unknown.place for unknown in finding.of])
    return (
        f"These data do not determine the drive gain{'s' * (len(finding.of) > 1)} of {gains}: the standard error is "
        "larger than the value. Declare more of the payload, or record one that loads the motor more."
    )


def _gain_runaway(finding: Finding) -> str:
    return (
        f"{_gain_came_out(finding)}, where {finding.numbers['nominal']:.3g} is nominal: no drive is that "
        "far from its sheet, if that is right."
    )


def _gain_far(finding: Finding) -> str:
    return (
        f"{_gain_came_out(finding)}, far from its nominal {finding.numbers['nominal']:.3g}: a physical "
        "effect is missing in the model, or the payload is not as declared."
    )


def _gain_came_out(finding: Finding) -> str:
    unit = finding.unit.replace("*", "·")
    return f"The drive gain of {finding.names[0]} came out at {finding.numbers['value']:.3g} {unit}"


def _without_std(finding: Finding) -> str:
    return (
        f"{finding.of[0].name} came out at {finding.numbers['value']:.3g} {finding.unit} with no standard "
        "error that is known: the data do not tell it."
    )


def _rounding(finding: Finding) -> str:
    return (
        f"The scaled observation matrix has a condition number of {finding.numbers['condition']:.0e}: rounding decides "
        "what some parameters are."
    )


def _locked(finding: Finding) -> str:
    values = ", ".join(f"{name} = {finding.numbers[name]:g} {finding.unit}" for name in finding.names)
    return f"Locked in robot.toml: {values}."


def _ill_conditioned(finding: Finding) -> str:
    return (
        f"The scaled observation matrix has a condition number of {finding.numbers['condition']:.0f}: some "
        "parameters cannot be told apart well; a more exciting trajectory helps."
    )


def _swapped(finding: Finding) -> str:
    first, second, *recording = finding.names
    where = f" in {recording[0]}" if recording else ""
    return (
        f"The columns of {first} and {second}{where} are probably swapped: with current.{first} and current.{second} "
        f"exchanged (or their positions, on a symmetric robot), and with friction, the error falls to "
        f"{in_percent(finding.numbers['error'])}. Exchange the names in the header."
    )


def _unlike_units(told: Finding) -> str:
    small, *large = told.names
    unit = told.unit if told.unit in ("A", "V") else ""
    many = len(large) > 1
    where = f"in m{unit}, where {small} is in {unit}" if unit else "in thousandths"
    scale = f"current=m{unit}" if unit else "current=1e-3"
    they_are, them = ("they are", "them") if many else ("it is", "it")
    return (
        f"The currents of {', '.join(large)} are about {told.numbers['times']:.0f} times those of {small}, at every "
        f"motor: probably {they_are} {where}. Import {them} anew with `--scale {scale}`."
    )


def _other_load(finding: Finding) -> str:
    name, joint, declared, other = finding.names
    was = f"the payload {declared}" if declared else "no payload"
    load = f"the payload {other}" if other else "no payload"
    before, after = (in_percent(finding.numbers[key]) for key in ("before", "after"))
    return (
        f"{name} is declared to carry {was}, and probably carries {load}: with that, the error of {joint} over all "
        f"recordings falls from {before} to {after}. Correct its `payload` in dataset.toml."
    )


def _heavy(finding: Finding) -> str:
    asked = HeavyPayload(finding.names[0], finding.numbers["mass"], finding.numbers["own"]).words
    meant = 'if it is meant, write `accept = ["mass"]` beside the file that carries it'
    return f"{asked[0].upper()}{asked[1:]} Correct it in dataset.toml; {meant}."


def _physical(finding: Finding) -> str:
    if not finding.numbers["distance"]:
        return "Real bodies can have these parameters as the data say them."
    return (
        "Of the parameters that real bodies can have, these are the nearest to what the data say: "
        f"{finding.numbers['distance']:.1f} standard errors away, where noise explains "
        f"{finding.numbers['expected']:.1f}. "
        "Standard errors are those without that condition; with it they are no larger."
    )


def _not_from_gain(finding: Finding) -> str:
    return (
        f"These data cannot tell {spoken(finding.of[0].effect)} at "
        f"{', '.join(at.place for at in finding.of)} from the drive "
        "gain there: it is left out, and the gain is what it would be without it. Record a payload that loads that "
        "joint more."
    )


def _rank(finding: Finding) -> str:
    return (
        f"The data determine only {finding.numbers['rank']:.0f} of {finding.numbers['unknowns']:.0f} "
        "unknowns: move all "
        "joints together, with larger and faster movements, or record an unloaded and a loaded trajectory."
    )


def _taken_up(finding: Finding) -> str:
    names = ", ".join(map(_of_effect, finding.of))
    return (
        f"These data cannot show {names}: other parameters of the model do the same, and take up the effect."
    )


def _hardly_apart(finding: Finding) -> str:
    *others, last = map(_of_effect, finding.of)
    return (
        f"These data tell {', '.join(others)} and {last} only together: each by itself is "
        f"{finding.numbers['wider']:.0f} "
        "times less certain than what they do together. Leave one out, or measure it another way."
    )


def _of_effect(unknown: Unknown) -> str:
    return f"{unknown.name} of {unknown.effect}" + ("" if unknown.place == ROBOT else f" at {unknown.place}")


def _sign(finding: Finding) -> str:
    joint = finding.names[0]
    return (
        f"The drive gain of {joint} came out negative, which cannot be: the sign of current.{joint}, or of "
        f"position.{joint}, is probably reversed (`bench import ... --scale current.{joint}=-1`), or its column is "
        "that of another motor."
    )


def _negative(finding: Finding) -> str:
    joint = finding.names[0]
    return (
        f"The drive gain of {joint} came out negative, which cannot be: with the sign of current.{joint} reversed its "
        "current is not explained either. The payload is probably not as declared or mounted another way, an effect "
        "is missing, or its column is that of another motor."
    )


def _contradicted(finding: Finding) -> str:
    joint, recording = finding.names
    n, unit = finding.numbers, finding.unit
    return (
        f"The loop closures put {joint} elsewhere than its own encoder says: by {n['difference']:.2g} {unit} RMS in "
        f"{recording}, {n['mean']:+.2g} {unit} in the mean, where it travels {n['travel']:.2g} {unit}. The zero or the "
        "sign of an encoder, a column or a length is wrong."
    )


def _velocity_taken(finding: Finding) -> str:
    times = finding.numbers["quieter"]
    less = f"{times:.2g} times" if times < 1000.0 else "a thousand times and more"
    return (
        f"The logged velocities of {', '.join(finding.names)} are taken in place of differentiated positions: they put "
        f"{less} less noise into the accelerations."
    )


def _velocity_unlike(finding: Finding) -> str:
    joint, recording = finding.names
    n = finding.numbers
    more = f", nor are {n['count'] - 1:.0f} others" if n["count"] > 1.0 else ""
    return (
        f"velocity.{joint} of {recording} is not the rate of position.{joint}: {in_percent(n['off'])} off, "
        f"{n['scale']:.4g} times as large and {1e3 * n['delay']:.2g} ms late. It is not used{more}."
    )


def _unlike(finding: Finding) -> str:
    worst, *payload = finding.names
    load = f"the payload {payload[0]}" if payload else "no payload"
    return (
        f"{_far_worse(finding)}, {worst} worst: it is declared to carry {load}; check that and its "
        "columns, or move the fitted recordings over the same range."
    )


def _other_values(finding: Finding) -> str:
    worst, *effects = finding.names
    ask = " ".join(f"--with {effect}{TAG}" for effect in effects)
    return (
        f"{_far_worse(finding)}, {worst} worst: {', '.join(effects)} differs there, which hides what the model lacks; "
        f"`{ask}` takes a value from each recording."
    )


def _far_worse(finding: Finding) -> str:
    checked, fitted = (in_percent(finding.numbers[name]) for name in ("checked", "fitted"))
    return (
        f"Recordings that were not fitted are modelled far worse ({checked}) than those that were ({fitted})"
    )


def _poorly(finding: Finding) -> str:
    verb = "is" if finding.numbers["count"] == 1 else "are"
    return (
        f"{finding.numbers['count']:.0f} of {finding.numbers['of']:.0f} parameters {verb} poorly "
        "determined (standard error "
        f"above {in_percent(finding.numbers['limit'])} of the value); `bench identify --essential` leaves out what "
        "does not matter."
    )


def _short(finding: Finding) -> str:
    shortest, cutoff, settling = (finding.numbers[name] for name in ("shortest", "cutoff", "settling"))
    many = len(finding.names) > 1
    return (
        f"{', '.join(finding.names)} {'last' if many else 'lasts'} {shortest:.2g} s{' and more' if many else ''}, "
        f"{shortest * cutoff:.0f} periods of the filter on positions ({cutoff:.3g} Hz), which needs {settling:g} to "
        "settle at either end: a tenth of the rows and more are disturbed. Record "
        f"{finding.numbers['needed']:.2g} s at least."
    )


def _no_value(finding: Finding) -> str:
    has, its = ("has", "its") if len(finding.names) == 1 else ("have", "their")
    return (
        f"{', '.join(finding.names)} {has} no {spoken(finding.of[0].effect)} of {its} own, as the fitted recordings "
        f"have ({', '.join(log.place for log in finding.of)}): the value that suits each best is taken."
    )


def _mounted_otherwise(finding: Finding) -> str:
    payload, parameter, first, second = finding.names
    unit, n = finding.unit.replace("*", "·").replace("^2", "²"), finding.numbers
    return (
        f"The payload {payload} is not mounted the same way in all recordings: {parameter}({payload}), estimated for "
        f"each by itself, is {n['first']:.3g} ± {n['first_std']:.1g} {unit} in {first} and {n['second']:.3g} ± "
        f"{n['second_std']:.1g} {unit} in {second}. Give it another name in dataset.toml where it is mounted otherwise."
    )


def _impossible_inertia(finding: Finding) -> str:
    unit, n = finding.unit.replace("*", "·").replace("^2", "²"), finding.numbers
    return (
        f"The inertia of the payload {finding.names[0]} came out such as no body has: a second moment of its mass of "
        f"{n['least']:.2g} ± {n['std']:.1g} {unit}. What the model lacks is in it, or its centre is not as declared."
    )


def _taken_as_point(finding: Finding) -> str:
    return (
        f"{_impossible_inertia(finding)} The payload is taken as a point there, with which the error is as small; the "
        "gains' standard errors hold the answer without that. Declare its inertia in dataset.toml."
    )


def _not_whole(told: Finding) -> str:
    effect, place = told.names
    periods = with_error(told.numbers["periods"], told.numbers["std"])
    return (
        f"{begun(effect)} at {place} repeats {periods} times a turn: no whole number, as poles and teeth of a motor "
        "that turns with its joint would have, so perhaps a gear, a belt's teeth or an eccentric part between motor "
        "and joint."
    )


def _noise_through(finding: Finding) -> str:
    unit, n = finding.unit.replace("*", "·"), finding.numbers
    return (
        "The filters let the encoders' noise through: within the band of the fit it has "
        f"{in_percent(n['share'])} of an acceleration's power. By instrumental variables, which it does not bias, the "
        f"drive gain of {finding.names[0]} is {n['other']:.4g} {unit} instead of {n['value']:.4g}. Leave "
        "the filters to be chosen, or take `--method iv`."
    )


WORDS: Mapping[Code, Callable[[Finding], str]] = {
    Code.GAIN_NOT_DETERMINED: _gain_not_determined,
    Code.GAIN_RUNAWAY: _gain_runaway,
    Code.PARAMETER_WITHOUT_DEVIATION: _without_std,
    Code.ROUNDING_DECIDES: _rounding,
    Code.UNITS_UNLIKE: _unlike_units,
    Code.COLUMNS_SWAPPED: _swapped,
    Code.OTHER_LOAD: _other_load,
    Code.PAYLOAD_HEAVY: _heavy,
    Code.NOT_REAL: lambda finding: (
        "Real bodies cannot have what the data say: the nearest, which stand here, are "
        f"{finding.numbers['distance']:.1f} "
        f"standard errors away, where noise explains {finding.numbers['expected']:.1f}; "
        f"{finding.names[0]} would need a "
        "negative mass or inertia most of all. An effect may be missing from the model."
    ),
    Code.NOT_FROM_GAIN: _not_from_gain,
    Code.NOISE_DECIDES: _noise_through,
    Code.NOISE_LET_THROUGH: _noise_through,
    Code.PAYLOAD_NOT_DECLARED: lambda finding: (
        f"Excluded: {', '.join(finding.names)}. What "
        f"{'they carry' if len(finding.names) > 1 else 'it carries'} is not "
        "declared in full, and no fitted recording carries it."
    ),
    Code.REDUNDANT: lambda finding: (
        f"The robot has more motors than degrees of freedom: the currents of {', '.join(finding.names)} "
        "are taken as they were logged, and errors are those of the other motors."
    ),
    Code.LOCKED: _locked,
    **dict.fromkeys(CODES.values(), scale_sentence),
    Code.PERIODS_NOT_WHOLE: _not_whole,
    **BAND_WORDS,
    Code.RANK_DEFICIENT: _rank,
    Code.ILL_CONDITIONED: _ill_conditioned,
    Code.TAKEN_UP: _taken_up,
    Code.HARDLY_APART: _hardly_apart,
    Code.NOT_SETTLED: lambda finding: (
        f"The search for {', '.join(map(_of_effect, finding.of))} did not come to an end: their values "
        "say nothing. They probably do the same to these data: leave one out, or measure it another way."
    ),
    Code.GAINS_A_THOUSAND: lambda _: (
        "The drive gains came out at about a thousand times the nominal ones: is the payload's mass in grams? It must "
        "be in kg."
    ),
    Code.GAINS_A_THOUSANDTH: lambda _: (
        "The drive gains came out at about a thousandth of the nominal ones: is the payload's mass in tonnes, or are "
        "the currents in mA?"
    ),
    Code.NO_MODEL_IS_BETTER: lambda finding: (
        f"The error is {in_percent(finding.numbers['error'])} of the current, more than with no model at "
        "all: columns may be swapped, a sign wrong, or the robot another one."
    ),
    Code.SIGN_REVERSED: _sign,
    Code.GAIN_NEGATIVE: _negative,
    Code.GAIN_FAR: _gain_far,
    Code.GAINS_NEGATIVE: lambda _: (
        "All drive gains came out negative, which cannot be: the recordings with and without payload are probably "
        "swapped in dataset.toml, or the currents' sign is."
    ),
    Code.CLOSURE_CONTRADICTED: _contradicted,
    Code.VELOCITY_UNLIKE: _velocity_unlike,
    Code.VELOCITY_TAKEN: _velocity_taken,
    Code.CHECKED_UNLIKE_FITTED: _unlike,
    Code.CHECKED_HAS_OTHER_VALUES: _other_values,
    Code.PHYSICAL: _physical,
    Code.BAD_STRETCH: lambda finding: (
        f"The current of {finding.names[0]} in {finding.names[1]} counts little from {finding.numbers['start']:.4g} to "
        f"{finding.numbers['end']:.4g} s: it is far from the model there. Look at it, or `exclude` it."
    ),
    Code.STANDS_STILL: lambda finding: (
        f"Joint {finding.names[0]} stands still in all fitted recordings: they tell nothing of its drive gain, which "
        "stays nominal, nor of effects there. Record motions that move it."
    ),
    Code.NEVER_REVERSES: lambda finding: (
        f"Joint {finding.names[0]} never reverses: move it through zero velocity to tell friction apart."
    ),
    Code.POORLY_DETERMINED: _poorly,
    Code.SHORT: _short,
    Code.NO_VALUE_OF_ITS_OWN: _no_value,
    Code.PAYLOAD_IMPOSSIBLE: _impossible_inertia,
    Code.PAYLOAD_TAKEN_AS_POINT: _taken_as_point,
    Code.MOUNTED_OTHERWISE: _mounted_otherwise,
    Code.TOLD: lambda finding: finding.names[0],
}
