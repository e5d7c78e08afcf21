"""What limits an answer, in words that say what to do: for each code a template, or a function of the finding."""

from collections.abc import Callable, Mapping

from bench.basics.sentence import and_list, in_percent, say
from bench.dataset.dataset import HeavyPayload
from bench.effects.display_names import begun, spoken
from bench.effects.select import ROBOT, TAG
from bench.identification.finding import UNBELIEVABLE, Code, Finding, Unknown
from bench.identification.scale_words import CODES, scale_sentence
from bench.identification.wording import with_error


def note(finding: Finding) -> str:
    """A finding as one of the notes on an answer."""
    said = sentence(finding)
    return f"Do not use this answer. {said}" if finding.code in UNBELIEVABLE else said


def sentence(finding: Finding) -> str:
    """A finding by itself."""
    words = WORDS[finding.code]
    return words(finding) if callable(words) else _filled(words, finding)


def _filled(template: str, finding: Finding) -> str:
    """A template filled with a finding's numbers by name, its `names`, `unit` and `symbol`, and of the unknowns in
    `of`: `places`, the spoken name of the first `effect`, and `values` of effects.
    """
    values = {
        "names": finding.names,
        "of": finding.of,
        "places": [unknown.place for unknown in finding.of],
        "effect": spoken(finding.of[0].effect) if finding.of else "",
        "values": [_of_effect(unknown) for unknown in finding.of],
        "unit": finding.unit,
        "symbol": finding.unit.replace("*", "·").replace("^2", "²"),
    }
    return say(template, **(values | dict(finding.numbers)))


def _of_effect(unknown: Unknown) -> str:
    return f"{unknown.name} of {unknown.effect}" + ("" if unknown.place == ROBOT else f" at {unknown.place}")


def _locked(finding: Finding) -> str:
    values = ", ".join(f"{name} = {finding.numbers[name]:g} {finding.unit}" for name in finding.names)
    return f"Locked in robot.toml: {values}."


def _not_determined(finding: Finding) -> str:
    said = _filled(
        "These data do not determine the drive gain{places:?|s} of {places:and}: the standard error is larger than the "
        "value.",
        finding,
    )
    if "times" in finding.numbers:
        return (
            f"{said} The error is at least {finding.numbers['times']:.3g} times that of noise, so the model lacks an "
            "effect: `bench diagnose` first."
        )
    return f"{said} Declare more of the payload, or record one that loads the motor more."


def _swapped(finding: Finding) -> str:
    first, second, *recording = finding.names
    where = f" in {recording[0]}" if recording else ""
    return (
        f"The columns of {first} and {second}{where} are probably swapped: with current.{first} and current.{second} "
        f"exchanged (or their positions, on a symmetric robot), and with friction in the model, the error falls to "
        f"{in_percent(finding.numbers['error'])}. Swap the names in the header, or import the logs again with `--map` "
        "exchanged and `--replace`."
    )


def _unlike_units(finding: Finding) -> str:
    small, *large = finding.names
    unit = finding.unit if finding.unit in ("A", "V") else ""
    where = f"in m{unit} and {small} in {unit}" if unit else "in thousandths"
    scale = f"current=m{unit}" if unit else "current=1e-3"
    they_are, them = ("they are", "them") if len(large) > 1 else ("it is", "it")
    return (
        f"The currents of {', '.join(large)} are about {finding.numbers['times']:.0f} times those of {small}, at every "
        f"motor: probably {they_are} {where}. Import {them} again with `--scale {scale}`."
    )


def _other_load(finding: Finding) -> str:
    name, joint, declared, other = finding.names
    was, load = (f"the payload {payload}" if payload else "no payload" for payload in (declared, other))
    before, after = (in_percent(finding.numbers[key]) for key in ("before", "after"))
    return (
        f"{name} is declared to carry {was} but probably carries {load}: with {load}, the error of {joint} over all "
        f"recordings falls from {before} to {after}. Correct its `payload` in dataset.toml."
    )


def _loads_exchanged(finding: Finding) -> str:
    payload, other = finding.names
    pair = (
        f"the payloads {payload} and {other}"
        if other
        else f"the recordings with and without the payload {payload}"
    )
    return (
        f"All drive gains come out negative although the currents supply power: {pair} are probably exchanged. Correct "
        "the `payload` of each recording in dataset.toml."
    )


def _heavy(finding: Finding) -> str:
    asked = HeavyPayload(finding.names[0], finding.numbers["mass"], finding.numbers["own"]).words
    meant = 'if it is right, write `accept = ["mass"]` under the file of each recording with this payload'
    return f"{asked[0].upper()}{asked[1:]} Correct it in dataset.toml; {meant}."


def _physical(finding: Finding) -> str:
    if not finding.numbers["distance"]:
        return "The estimated parameters are physically possible."
    return _filled(
        "These are the physically possible parameters nearest to the estimate: {distance:.1f} standard errors away; "
        "noise explains {expected:.1f}. Standard errors are those of the unconstrained fit; with the constraint they "
        "are no larger.",
        finding,
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
    others = f"{n['count'] - 1:.0f} other{'s' * (n['count'] != 2.0)}"
    more = f", and neither {'is' if n['count'] == 2.0 else 'are'} {others}" if n["count"] > 1.0 else ""
    if finding.unit:
        return (
            f"velocity.{joint} of {recording} seems to be in {finding.unit}: it is {n['scale']:.4g} times the "
            f"derivative of position.{joint}. It is not used{more}. Import it with `--scale "
            f"velocity.{joint}={finding.unit}`."
        )
    delay = f"{1e3 * n['delay']:.2f}"
    late = "" if delay.lstrip("-") == "0.00" else f" and {delay} ms late"
    return (
        f"velocity.{joint} of {recording} is not the derivative of position.{joint}: it is {in_percent(n['off'])} off, "
        f"{n['scale']:.4g} times as large{late}. It is not used{more}."
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


def _not_whole(finding: Finding) -> str:
    effect, place = finding.names
    periods = with_error(finding.numbers["periods"], finding.numbers["std"])
    return (
        f"{begun(effect)} at {place} repeats {periods} times per turn. Poles and teeth of a motor that turns with its "
        "joint would give a whole number, so the cause may be a gear, a belt's teeth or an eccentric part between "
        "motor and joint."
    )


def _matters(finding: Finding) -> str:
    return (
        f"With half of the band of {finding.numbers['band']:.3g} Hz the parameters differ by more than their standard "
        "errors, or these are clearly smaller; the stated ones include the difference. Either the accelerations hold "
        f"noise, or the model lacks an effect: try `--decimation {2 * finding.numbers['decimation']:.0f}`."
    )


def _unlike(finding: Finding) -> str:
    _, *payload = finding.names
    load = f"the payload {payload[0]}" if payload else "no payload"
    return (
        f"{_filled(FAR_WORSE, finding)}: it is declared to carry {load}. Check that and its columns, or extend the "
        "fitted motions to the same range."
    )


def _other_values(finding: Finding) -> str:
    effects = finding.names[1:]
    ask = " ".join(f"--with {effect}{TAG}" for effect in effects)
    return (
        f"{_filled(FAR_WORSE, finding)}: {', '.join(effects)} differs in it, which hides missing effects; `{ask}` "
        "estimates one value per recording."
    )


def _gains_alike(finding: Finding) -> str:
    n, many = finding.numbers, len(finding.names) > 1
    factors = f"{n['least']:.2f} to {n['most']:.2f} times nominal"
    if many:
        mass = f"The declared masses of {and_list(finding.names)} are probably wrong"
    else:
        mass = f"The declared mass of {finding.names[0]}, {n['mass']:.3g} kg, is probably wrong"
    likely = "" if many else f": with {n['likely']:.2g} kg they would be nominal"
    weigh = "them and correct them" if many else "it and correct it"
    return (
        f"All drive gains are off by like factors, {factors}. {mass}{likely}. Weigh {weigh} in dataset.toml."
    )


def _current_reversed(finding: Finding) -> str:
    joint, *recordings = finding.names
    where = f" in {recordings[0]}" if recordings else ""
    again = "that log" if recordings else "the logs"
    return (
        f"The sign of current.{joint}{where} is probably reversed: with the other sign {_falls(finding)}. "
        f"Import {again} again with `--scale current.{joint}=-1 --replace`."
    )


def _position_reversed(finding: Finding) -> str:
    joint = finding.names[0]
    also = f" and of current.{joint}" if finding.numbers["current"] else ""
    option = f" --scale current.{joint}=-1" if finding.numbers["current"] else ""
    return (
        f"The sign of position.{joint}{also} is probably reversed: with the other sign {_falls(finding)}. Import the "
        f"logs again with `--scale position.{joint}=-1{option} --replace`."
    )


def _positions_swapped(finding: Finding) -> str:
    first, second = finding.names
    return (
        f"The columns of position.{first} and position.{second} are probably swapped: exchanged, {_falls(finding)}. "
        "Import the logs again with each under its joint."
    )


def _falls(finding: Finding) -> str:
    before, after = (in_percent(finding.numbers[key]) for key in ("before", "after"))
    return f"the error falls from {before} to {after} (nominal gains, friction in the model)"


FAR_WORSE = (
    "The error of recordings that were not fitted ({checked:%}) is far larger than that of fitted ones ({fitted:%}), "
    "{names[0]} worst"
)
GAIN = "The estimated drive gain of {names[0]} is {value:.3g} {symbol}"
IMPOSSIBLE_INERTIA = (
    "The estimated inertia of the payload {names[0]} is physically impossible: one second moment of mass is "
    "{least:.2g} ± {std:.1g} {symbol}. It absorbs modelling errors, or the declared centre of mass is wrong."
)
NEGATIVE = "The estimated drive gain of {names[0]} is negative, which is impossible: "
NOISE = (
    "The filters pass encoder noise: within the band of the fit it has {share:%} of an acceleration's power. With "
    "instrumental variables, which it does not bias, the drive gain of {names[0]} is {other:.4g} {symbol} instead of "
    "{value:.4g}. Let the program choose the filters, or use `--method iv`."
)

WORDS: Mapping[Code, str | Callable[[Finding], str]] = {
    Code.GAIN_NOT_DETERMINED: _not_determined,
    Code.GAIN_RUNAWAY: f"{GAIN}; its nominal value is {{nominal:.3g}}. No drive differs that much from its data "
    "sheet: a physical effect is missing in the model, or the payload is not as declared.",
    Code.PARAMETER_WITHOUT_DEVIATION: "{of[0].name} is estimated as {value:.3g} {unit} without a known standard "
    "error: the data do not determine it.",
    Code.ROUNDING_DECIDES: "The scaled observation matrix has a condition number of {condition:.0e}: rounding errors "
    "determine some parameters.",
    Code.UNITS_UNLIKE: _unlike_units,
    Code.TIME_BASE: "The time of {names:and} contradicts the logged velocities: at all joints they are those of a log "
    "that took {factor:.3g} times as long, with samples {true:.3g} ms apart where the time says {step:.3g} ms. "
    "Accelerations and inertias are wrong by the square of that. Import {names:?it|them} again with "
    "`--scale time={factor:.4g}`.",
    Code.COLUMNS_SWAPPED: _swapped,
    Code.OTHER_LOAD: _other_load,
    Code.LOADS_EXCHANGED: _loads_exchanged,
    Code.LOAD_UNDECLARED: "{names[0]} probably carries a load that is not declared: with a payload of about {mass:.2g} "
    "kg in it the error falls from {before:%} to {after:%} (nominal gains, friction in the model). Weigh the load, and "
    "declare it as `payload` of that recording in dataset.toml.",
    Code.PAYLOAD_HEAVY: _heavy,
    Code.NOT_REAL: "The estimated parameters are physically impossible: the nearest possible set, used in this "
    "answer, is {distance:.1f} standard errors away; noise explains {expected:.1f}. {names[0]} would need the most "
    "negative mass or inertia. The model may lack an effect.",
    Code.NOT_FROM_GAIN: "These data cannot distinguish {effect} at {places} from the drive gain of that joint: the "
    "model omits the effect, and the gain is the one without it. Record a payload that loads the joint more.",
    Code.NOISE_DECIDES: NOISE,
    Code.NOISE_LET_THROUGH: NOISE,
    Code.PAYLOAD_NOT_DECLARED: "Excluded: {names}. {names:?Its|Their} payload is not declared completely, and no "
    "fitted recording carries it.",
    Code.REDUNDANT: "The robot has more motors than degrees of freedom: the currents of {names} are used as measured, "
    "and errors are those of the other motors.",
    Code.LOCKED: _locked,
    **dict.fromkeys(CODES.values(), scale_sentence),
    Code.PERIODS_NOT_WHOLE: _not_whole,
    Code.GAINS_ALIKE: _gains_alike,
    Code.CURRENT_REVERSED: _current_reversed,
    Code.POSITION_REVERSED: _position_reversed,
    Code.POSITIONS_SWAPPED: _positions_swapped,
    Code.ROWS_REPEATED: "Of {names:and} up to {share:%} of the rows repeat the row before, while the robot moves: the "
    "logger ran faster than the controller. They are not used; check the time base, too.",
    Code.BAND_NARROWED: "The fit uses frequencies up to {band:.3g} Hz. The spectra suggest {rejected:.3g} Hz, but "
    "there parameters of rigid bodies and friction move by more than their standard errors when the band is halved: "
    "the accelerations hold noise. Standard errors include the difference that remains.",
    Code.BAND_MATTERS: _matters,
    Code.BAND_UNCHECKED: "The band of {band:.3g} Hz is not checked by its result: half of it would leave too few "
    "samples. Noise of the positions that is not white would bias the answer by more than its standard errors; longer "
    "recordings allow the check.",
    Code.EXTRAPOLATED: "{share:%} of the held-out samples are not judged: the fitted motions do not determine what "
    "the model gives there. Motions that reach further would.",
    Code.JUDGED_BEYOND: "In most of the held-out samples of {names:and} the fitted motions do not determine what the "
    "model gives, so that their error says little about effects. Extend the fitted motions to the same range.",
    Code.CHECKED_UNLIKE_FITTED: _unlike,
    Code.CHECKED_HAS_OTHER_VALUES: _other_values,
    Code.RANK_DEFICIENT: "The data determine only {rank:.0f} of {unknowns:.0f} unknowns: move all joints together, "
    "with larger and faster motions, or record an unloaded and a loaded trajectory.",
    Code.ILL_CONDITIONED: "The scaled observation matrix has a condition number of {condition:.0f}: some parameters "
    "are strongly correlated. `bench excite` plans motions that separate them better.",
    Code.TAKEN_UP: "These data cannot show {values}: other parameters of the model have the same effect and absorb it.",
    Code.HARDLY_APART: "These data determine {values:and} only in combination: each is {wider:.0f} times less certain "
    "than their joint effect. Omit one, or measure it another way.",
    Code.NOT_SETTLED: "The search for {values} did not converge: ignore their values. They probably have the same "
    "effect on these data: omit one, or measure it another way.",
    Code.GAINS_A_THOUSAND: "The estimated drive gains are about a thousand times the nominal ones: is the payload's "
    "mass in grams? It must be in kg.",
    Code.GAINS_A_THOUSANDTH: "The estimated drive gains are about a thousandth of the nominal ones: is the payload's "
    "mass in tonnes, or are the currents in mA?",
    Code.NO_MODEL_IS_BETTER: "The error is {error:%} of the current, more than without a model: columns may be "
    "swapped, a sign wrong, or the robot a different one.",
    Code.SIGN_REVERSED: f"{NEGATIVE}the sign of current.{{names[0]}}, or of position.{{names[0]}}, is probably "
    "reversed (`bench import ... --scale current.{names[0]}=-1`), or its column belongs to another motor.",
    Code.GAIN_NEGATIVE: f"{NEGATIVE}reversing the sign of current.{{names[0]}} does not explain the current either. "
    "The payload probably differs from its declaration or is mounted differently, an effect is missing, or the column "
    "belongs to another motor.",
    Code.GAIN_FAR: f"{GAIN}, far from its nominal {{nominal:.3g}}: a physical effect is missing in the model, or the "
    "payload is not as declared.",
    Code.GAINS_NEGATIVE: "All estimated drive gains are negative, which is impossible. If no other note gives the "
    "cause, the recordings with and without payload are swapped in dataset.toml, or currents have the wrong sign.",
    Code.GAINS_ASSUMED_EQUAL: "The gain of each drive is assumed to be the same with and without payload. A gain "
    "{drift:%} lower with payload, as of magnets 1 K warmer, would move the estimate for {names[0]} by {move:%}, which "
    "is more than its standard error. Record both in turn, at the same temperature.",
    Code.CLOSURE_CONTRADICTED: "The position of {names[0]} from the loop closures differs from its encoder by "
    "{difference:.2g} {unit} RMS in {names[1]}, {mean:+.2g} {unit} on average, for a travel of {travel:.2g} {unit}. "
    "The zero or the sign of an encoder, a column or a length is wrong.",
    Code.VELOCITY_UNLIKE: _velocity_unlike,
    Code.VELOCITY_TAKEN: _velocity_taken,
    Code.PHYSICAL: _physical,
    Code.BAD_STRETCH: "The current of {names[0]} in {names[1]} has little weight from {start:.4g} to {end:.4g} s, "
    "where it is far from the model. Check that interval, or `exclude` it.",
    Code.STANDS_STILL: "Joint {names[0]} stands still in all fitted recordings: they do not determine its drive gain, "
    "which stays nominal, or its effects. Record motions that move it.",
    Code.NEVER_REVERSES: "Joint {names[0]} never reverses: move it through zero velocity to identify friction.",
    Code.POORLY_DETERMINED: "{count:.0f} of {of:.0f} parameters {count:?is|are} poorly determined (standard error "
    "above {limit:%} of the value); `bench identify --essential` omits parameters that the data do not need.",
    Code.SHORT: _short,
    Code.NO_VALUE_OF_ITS_OWN: "{names} {names:?has|have} no estimated {effect}, unlike the fitted recordings "
    "({places}): {names:?its|their} best-fitting value among theirs is used.",
    Code.PAYLOAD_IMPOSSIBLE: IMPOSSIBLE_INERTIA,
    Code.PAYLOAD_TAKEN_AS_POINT: f"{IMPOSSIBLE_INERTIA} The program uses a point mass at the declared centre, which "
    "fits as well, and widens the gains' standard errors to include the other answer. Declare the inertia in "
    "dataset.toml.",
    Code.MOUNTED_OTHERWISE: "The payload {names[0]} is not mounted the same way in all recordings: "
    "{names[1]}({names[0]}), estimated separately, is {first:.3g} ± {first_std:.1g} {symbol} in {names[2]} and "
    "{second:.3g} ± {second_std:.1g} {symbol} in {names[3]}. Use a second payload name in dataset.toml for the other "
    "mounting.",
    Code.TOLD: "{names[0]}",
}
