"""What limits an answer, in words that say what to do: one sentence or two for each code."""

from collections.abc import Callable, Mapping

from bench.dataset.heavy_payload import HeavyPayload
from bench.effects.display_names import begun, spoken
from bench.effects.select import ROBOT
from bench.identification.band_words import BAND_WORDS
from bench.identification.finding import UNBELIEVABLE, Code, Finding, Unknown
from bench.identification.gain_words import GAIN_WORDS
from bench.identification.held_out_words import HELD_OUT_WORDS
from bench.identification.scale_words import CODES, scale_sentence
from bench.identification.wording import in_percent, with_error


def note(finding: Finding) -> str:
    """A finding as one of the notes on an answer."""
    said = sentence(finding)
    return f"Do not use this answer. {said}" if finding.code in UNBELIEVABLE else said


def sentence(finding: Finding) -> str:
    """A finding by itself."""
    return WORDS[finding.code](finding)


def _without_std(finding: Finding) -> str:
    return (
        f"{finding.of[0].name} is estimated as {finding.numbers['value']:.3g} {finding.unit} without a known standard "
        "error: the data do not determine it."
    )


def _rounding(finding: Finding) -> str:
    return (
        f"The scaled observation matrix has a condition number of {finding.numbers['condition']:.0e}: rounding errors "
        "determine some parameters."
    )


def _locked(finding: Finding) -> str:
    values = ", ".join(f"{name} = {finding.numbers[name]:g} {finding.unit}" for name in finding.names)
    return f"Locked in robot.toml: {values}."


def _ill_conditioned(finding: Finding) -> str:
    return (
        f"The scaled observation matrix has a condition number of {finding.numbers['condition']:.0f}: some "
        "parameters are strongly correlated; a more exciting trajectory helps."
    )


def _swapped(finding: Finding) -> str:
    first, second, *recording = finding.names
    where = f" in {recording[0]}" if recording else ""
    return (
        f"The columns of {first} and {second}{where} are probably swapped: with current.{first} and current.{second} "
        f"exchanged (or their positions, on a symmetric robot), and with friction in the model, the error falls to "
        f"{in_percent(finding.numbers['error'])}. Swap the names in the header."
    )


def _unlike_units(finding: Finding) -> str:
    small, *large = finding.names
    unit = finding.unit if finding.unit in ("A", "V") else ""
    many = len(large) > 1
    where = f"in m{unit} and {small} in {unit}" if unit else "in thousandths"
    scale = f"current=m{unit}" if unit else "current=1e-3"
    they_are, them = ("they are", "them") if many else ("it is", "it")
    return (
        f"The currents of {', '.join(large)} are about {finding.numbers['times']:.0f} times those of {small}, at every "
        f"motor: probably {they_are} {where}. Import {them} again with `--scale {scale}`."
    )


def _other_load(finding: Finding) -> str:
    name, joint, declared, other = finding.names
    was = f"the payload {declared}" if declared else "no payload"
    load = f"the payload {other}" if other else "no payload"
    before, after = (in_percent(finding.numbers[key]) for key in ("before", "after"))
    return (
        f"{name} is declared to carry {was} but probably carries {load}: with {load}, the error of {joint} over all "
        f"recordings falls from {before} to {after}. Correct its `payload` in dataset.toml."
    )


def _undeclared(finding: Finding) -> str:
    before, after, mass = (finding.numbers[key] for key in ("before", "after", "mass"))
    return (
        f"{finding.names[0]} probably carries a load that is not declared: with a payload of about {mass:.2g} kg in it "
        f"the error falls from {in_percent(before)} to {in_percent(after)} (nominal gains, friction in the model). "
        "Weigh the load, and declare it as `payload` of that recording in dataset.toml."
    )


def _heavy(finding: Finding) -> str:
    asked = HeavyPayload(finding.names[0], finding.numbers["mass"], finding.numbers["own"]).words
    meant = 'if it is right, write `accept = ["mass"]` under the file of each recording with this payload'
    return f"{asked[0].upper()}{asked[1:]} Correct it in dataset.toml; {meant}."


def _physical(finding: Finding) -> str:
    if not finding.numbers["distance"]:
        return "The estimated parameters are physically possible."
    return (
        "These are the physically possible parameters nearest to the estimate: "
        f"{finding.numbers['distance']:.1f} standard errors away; noise explains "
        f"{finding.numbers['expected']:.1f}. "
        "Standard errors are those of the unconstrained fit; with the constraint they are no larger."
    )


def _not_from_gain(finding: Finding) -> str:
    return (
        f"These data cannot distinguish {spoken(finding.of[0].effect)} at "
        f"{', '.join(at.place for at in finding.of)} from the drive "
        "gain of that joint: the model omits the effect, and the gain is the one without it. Record a payload that "
        "loads the joint more."
    )


def _rank(finding: Finding) -> str:
    return (
        f"The data determine only {finding.numbers['rank']:.0f} of {finding.numbers['unknowns']:.0f} "
        "unknowns: move all "
        "joints together, with larger and faster motions, or record an unloaded and a loaded trajectory."
    )


def _taken_up(finding: Finding) -> str:
    names = ", ".join(map(_of_effect, finding.of))
    return (
        f"These data cannot show {names}: other parameters of the model have the same effect and absorb it."
    )


def _collinear(finding: Finding) -> str:
    *others, last = map(_of_effect, finding.of)
    return (
        f"These data determine {', '.join(others)} and {last} only in combination: each is "
        f"{finding.numbers['wider']:.0f} "
        "times less certain than their joint effect. Omit one, or measure it another way."
    )


def _of_effect(unknown: Unknown) -> str:
    return f"{unknown.name} of {unknown.effect}" + ("" if unknown.place == ROBOT else f" at {unknown.place}")


def _contradicted(finding: Finding) -> str:
    joint, recording = finding.names
    n, unit = finding.numbers, finding.unit
    return (
        f"The position of {joint} from the loop closures differs from its encoder by {n['difference']:.2g} {unit} RMS "
        f"in {recording}, {n['mean']:+.2g} {unit} on average, for a travel of {n['travel']:.2g} {unit}. The zero or "
        "the sign of an encoder, a column or a length is wrong."
    )


def _velocity_taken(finding: Finding) -> str:
    times = finding.numbers["quieter"]
    less = f"{times:.2g} times" if times < 1000.0 else "a thousand times and more"
    return (
        f"The logged velocities of {', '.join(finding.names)} replace differentiated positions: they add "
        f"{less} less noise to the accelerations."
    )


def _velocity_unlike(finding: Finding) -> str:
    joint, recording = finding.names
    n = finding.numbers
    more = f", and neither are {n['count'] - 1:.0f} others" if n["count"] > 1.0 else ""
    return (
        f"velocity.{joint} of {recording} is not the derivative of position.{joint}: it is {in_percent(n['off'])} off, "
        f"{n['scale']:.4g} times as large and {1e3 * n['delay']:.2g} ms late. It is not used{more}."
    )


def _poorly(finding: Finding) -> str:
    verb = "is" if finding.numbers["count"] == 1 else "are"
    return (
        f"{finding.numbers['count']:.0f} of {finding.numbers['of']:.0f} parameters {verb} poorly "
        "determined (standard error "
        f"above {in_percent(finding.numbers['limit'])} of the value); `bench identify --essential` omits parameters "
        "that the data do not need."
    )


def _short(finding: Finding) -> str:
    shortest, cutoff, settling = (finding.numbers[name] for name in ("shortest", "cutoff", "settling"))
    many = len(finding.names) > 1
    return (
        f"{', '.join(finding.names)} {'last' if many else 'lasts'} {shortest:.2g} s{' and more' if many else ''}, "
        f"{shortest * cutoff:.0f} periods of the position filter ({cutoff:.3g} Hz), which needs {settling:g} to "
        "settle at either end: at least a tenth of the rows is disturbed. Record at least "
        f"{finding.numbers['needed']:.2g} s."
    )


def _no_value(finding: Finding) -> str:
    has, its = ("has", "its") if len(finding.names) == 1 else ("have", "their")
    return (
        f"{', '.join(finding.names)} {has} no estimated {spoken(finding.of[0].effect)}, unlike the fitted recordings "
        f"({', '.join(log.place for log in finding.of)}): {its} best-fitting value among theirs is used."
    )


def _mounted_otherwise(finding: Finding) -> str:
    payload, parameter, first, second = finding.names
    unit, n = finding.unit.replace("*", "·").replace("^2", "²"), finding.numbers
    return (
        f"The payload {payload} is not mounted the same way in all recordings: {parameter}({payload}), estimated "
        f"separately, is {n['first']:.3g} ± {n['first_std']:.1g} {unit} in {first} and {n['second']:.3g} ± "
        f"{n['second_std']:.1g} {unit} in {second}. Use a second payload name in dataset.toml for the other mounting."
    )


def _impossible_inertia(finding: Finding) -> str:
    unit, n = finding.unit.replace("*", "·").replace("^2", "²"), finding.numbers
    return (
        f"The estimated inertia of the payload {finding.names[0]} is physically impossible: one second moment of mass "
        f"is {n['least']:.2g} ± {n['std']:.1g} {unit}. It absorbs modelling errors, or the declared centre of mass is "
        "wrong."
    )


def _taken_as_point(finding: Finding) -> str:
    return (
        f"{_impossible_inertia(finding)} The program uses a point mass at the declared centre, which fits as well, and "
        "widens the gains' standard errors to include the other answer. Declare the inertia in dataset.toml."
    )


def _not_whole(finding: Finding) -> str:
    effect, place = finding.names
    periods = with_error(finding.numbers["periods"], finding.numbers["std"])
    return (
        f"{begun(effect)} at {place} repeats {periods} times per turn. Poles and teeth of a motor that turns with its "
        "joint would give a whole number, so the cause may be a gear, a belt's teeth or an eccentric part between "
        "motor and joint."
    )


def _noise_through(finding: Finding) -> str:
    unit, n = finding.unit.replace("*", "·"), finding.numbers
    return (
        "The filters pass encoder noise: within the band of the fit it has "
        f"{in_percent(n['share'])} of an acceleration's power. With instrumental variables, which it does not bias, "
        f"the drive gain of {finding.names[0]} is {n['other']:.4g} {unit} instead of {n['value']:.4g}. Let "
        "the program choose the filters, or use `--method iv`."
    )


WORDS: Mapping[Code, Callable[[Finding], str]] = {
    Code.PARAMETER_WITHOUT_DEVIATION: _without_std,
    Code.ROUNDING_DECIDES: _rounding,
    Code.UNITS_UNLIKE: _unlike_units,
    Code.COLUMNS_SWAPPED: _swapped,
    Code.OTHER_LOAD: _other_load,
    Code.LOAD_UNDECLARED: _undeclared,
    Code.PAYLOAD_HEAVY: _heavy,
    Code.NOT_REAL: lambda finding: (
        "The estimated parameters are physically impossible: the nearest possible set, used in this answer, is "
        f"{finding.numbers['distance']:.1f} "
        f"standard errors away; noise explains {finding.numbers['expected']:.1f}. "
        f"{finding.names[0]} would need the most "
        "negative mass or inertia. The model may lack an effect."
    ),
    Code.NOT_FROM_GAIN: _not_from_gain,
    Code.NOISE_DECIDES: _noise_through,
    Code.NOISE_LET_THROUGH: _noise_through,
    Code.PAYLOAD_NOT_DECLARED: lambda finding: (
        f"Excluded: {', '.join(finding.names)}. "
        f"{'Their payload' if len(finding.names) > 1 else 'Its payload'} is not "
        "declared completely, and no fitted recording carries it."
    ),
    Code.REDUNDANT: lambda finding: (
        f"The robot has more motors than degrees of freedom: the currents of {', '.join(finding.names)} "
        "are used as measured, and errors are those of the other motors."
    ),
    Code.LOCKED: _locked,
    **dict.fromkeys(CODES.values(), scale_sentence),
    Code.PERIODS_NOT_WHOLE: _not_whole,
    **BAND_WORDS,
    **GAIN_WORDS,
    **HELD_OUT_WORDS,
    Code.RANK_DEFICIENT: _rank,
    Code.ILL_CONDITIONED: _ill_conditioned,
    Code.TAKEN_UP: _taken_up,
    Code.HARDLY_APART: _collinear,
    Code.NOT_SETTLED: lambda finding: (
        f"The search for {', '.join(map(_of_effect, finding.of))} did not converge: ignore their values. "
        "They probably have the same effect on these data: omit one, or measure it another way."
    ),
    Code.NO_MODEL_IS_BETTER: lambda finding: (
        f"The error is {in_percent(finding.numbers['error'])} of the current, more than without a "
        "model: columns may be swapped, a sign wrong, or the robot a different one."
    ),
    Code.CLOSURE_CONTRADICTED: _contradicted,
    Code.VELOCITY_UNLIKE: _velocity_unlike,
    Code.VELOCITY_TAKEN: _velocity_taken,
    Code.PHYSICAL: _physical,
    Code.BAD_STRETCH: lambda finding: (
        f"The current of {finding.names[0]} in {finding.names[1]} has little weight from "
        f"{finding.numbers['start']:.4g} to {finding.numbers['end']:.4g} s, where it is far from the model. "
        "Check that interval, or `exclude` it."
    ),
    Code.STANDS_STILL: lambda finding: (
        f"Joint {finding.names[0]} stands still in all fitted recordings: they do not determine its drive gain, which "
        "stays nominal, or its effects. Record motions that move it."
    ),
    Code.NEVER_REVERSES: lambda finding: (
        f"Joint {finding.names[0]} never reverses: move it through zero velocity to identify friction."
    ),
    Code.POORLY_DETERMINED: _poorly,
    Code.SHORT: _short,
    Code.NO_VALUE_OF_ITS_OWN: _no_value,
    Code.PAYLOAD_IMPOSSIBLE: _impossible_inertia,
    Code.PAYLOAD_TAKEN_AS_POINT: _taken_as_point,
    Code.MOUNTED_OTHERWISE: _mounted_otherwise,
    Code.TOLD: lambda finding: finding.names[0],
}
