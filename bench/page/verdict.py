"""The verdict of a page, in about three sentences, and its key numbers."""

from collections.abc import Collection, Mapping

from bench.basics.chi_squared import WITHIN_95
from bench.basics.sentence import and_list, or_list
from bench.diagnosis.reason_words import less_probable
from bench.diagnosis.result import Diagnosis
from bench.diagnosis.summary import moved_gain, named_effects, summary_of
from bench.document.numbers import gain_change, pretty_unit
from bench.document.typeset import effect_name, share, short, typeset
from bench.export.replay.replay import Replay
from bench.identification.finding import Code
from bench.identification.finding_words import note, sentence
from bench.identification.findings import runaway
from bench.identification.result import DriveGain, ErrorSummary, Identification, relative_error
from bench.identification.scale_words import in_short, scale_sentence, why_nominal
from bench.identification.wording import motor_words, with_error
from bench.page.parts import Tile
from bench.residuals.residuals import WhereItFails

MOST_GAINS = 7  # listed in a sentence


def diagnosis_verdict(diagnosis: Diagnosis) -> tuple[str, ...]:
    """What is missing, what was not examined, each law, the gains, usual effects, and the remaining error."""
    said = summary_of(diagnosis)
    doubt = runaway(diagnosis.after)
    middle = sentence(doubt) if doubt else said.nominal or said.moved or gains_sentence(diagnosis.after)
    middle = middle.rstrip(".")
    doubtful = [
        f"instead of {effect_name(verdict.effect)} it could as well be "
        f"{or_list(list(map(effect_name, verdict.alternatives)))}{f', which is {less}' if less else ''}"
        for verdict in named_effects(diagnosis)
        if verdict.alternatives
        for less in [less_probable(verdict)]
    ]
    if not doubt and not said.nominal and said.moved and 1 < len(diagnosis.after.drive_gains) <= MOST_GAINS:
        others = diagnosis.after.drive_gains.keys() - {moved_gain(diagnosis)}
        middle += (
            f"; the other drive gains, with the change from nominal: {gains_listed(diagnosis.after, others)}"
        )
    if doubtful:
        middle += f"; {and_list(doubtful)}: these recordings cannot tell"
    sentences = (said.verdict, said.unfinished, *said.laws, f"{middle}.", said.usual, said.residual)
    return tuple(typeset(name) for name in sentences if name)


def identification_verdict(result: Identification, where: WhereItFails, noise: float) -> tuple[str, ...]:
    """Three sentences on an identified model."""
    doubt = runaway(result)
    gains = gains_sentence(result) if doubt is None else typeset(note(doubt))
    level = _level(result.error, noise, "The model")
    return (level, gains, _failing(where)) if doubt is None else (gains, level, _failing(where))


def comparison_verdict(error: ErrorSummary, model: str, where: WhereItFails, noise: float) -> tuple[str, ...]:
    """Three sentences on a saved model applied to other recordings."""
    return (
        _level(error, noise, "Applied as it is, the saved model"),
        f"Nothing was fitted here: the model comes from {model}.",
        _failing(where),
    )


def gains_sentence(result: Identification) -> str:
    """The identified drive gains, or why they are nominal."""
    why = why_nominal(result)
    nominal = "" if why is None else scale_sentence(why)
    if not result.gains_fitted:
        return nominal
    return f"{_known_gains(result, _fitted_gains(result))} {nominal}".rstrip()


def _fitted_gains(result: Identification) -> Mapping[str, DriveGain]:
    """The fitted gains; all gains if none was fitted."""
    return {joint: gain for joint, gain in result.drive_gains.items() if gain.fitted} or result.drive_gains


def _known_gains(result: Identification, gains: Mapping[str, DriveGain]) -> str:
    if 1 < len(gains) <= MOST_GAINS:
        loosest = max(gain.relative_std for gain in gains.values())
        return (
            f"Drive gains, with their change from the nominal value: {gains_listed(result, gains)}; all are "
            f"known to ±{share(WITHIN_95 * loosest)} or better (95 %){_assumed(result)}."
        )
    far = max(gains, key=lambda name: abs(gain_change(gains[name])))
    loose = max(gains, key=lambda name: gains[name].relative_std)
    gain = gains[far]
    change = share(gain_change(gain), signed=True)
    much = f"The drive gain of {far} is {short(gain.value)} {pretty_unit(gain.unit)}, {change} from its nominal value"
    if len(gains) > 1:
        much += ", farther than any other"
    known = share(WITHIN_95 * gains[loose].relative_std)
    return f"{much}; {'all are' if len(gains) > 1 else 'it is'} known to ±{known} or better (95 %){_assumed(result)}."


def _assumed(result: Identification) -> str:
    """The assumption on which gains depend by more than their standard errors, if they do."""
    assumed = any(finding.code is Code.GAINS_ASSUMED_EQUAL for finding in result.findings)
    return ", if they are the same with and without payload" if assumed else ""


def gains_listed(result: Identification, joints: Collection[str]) -> str:
    """Drive gains with their standard errors and changes, as in "left 3.301 ± 0.002 N·m/A (+10 %)"."""
    return and_list(
        [
            f"{joint} {typeset(with_error(gain.value, gain.std))} {pretty_unit(gain.unit)} "
            f"({share(gain_change(gain), signed=True)})"
            for joint, gain in result.drive_gains.items()
            if joint in joints
        ]
    )


def diagnosis_tiles(diagnosis: Diagnosis) -> tuple[Tile, ...]:
    """The key numbers of a diagnosis."""
    first, last = diagnosis.ladder[0], diagnosis.ladder[-1]
    kind = "not fitted" if last.validate is not None else "fitted"
    before = f"from {share(first.reported)} without" if diagnosis.added else "nothing to add"
    missing = [name for name in diagnosis.added if name not in diagnosis.usual]
    count = str(len(missing)) if missing else "none"
    names = ", ".join(effect_name(name) for name in missing) or "that the catalogue knows"
    return (
        Tile(f"Error, {kind}", share(last.reported), before),
        _noise_tile(diagnosis.unexplained.noise_floor),
        Tile("Missing effects", count, names),
        _gain_tile(diagnosis.after),
    )


def identification_tiles(result: Identification, noise: float) -> tuple[Tile, ...]:
    """The key numbers of an identification."""
    validation = result.error.validate
    fitted = share(result.error.identify)
    note = f"fitted {fitted}" if validation is not None else "no recording kept for validation"
    use = "not fitted" if validation is not None else "fitted"
    return (
        Tile(f"Error, {use}", share(result.error.reported), note),
        _noise_tile(noise),
        _gain_tile(result),
        Tile("Condition number", short(result.scaled_condition, 3), "columns of unit length"),
    )


def comparison_tiles(error: ErrorSummary, where: WhereItFails, noise: float) -> tuple[Tile, ...]:
    """The key numbers of a comparison."""
    values = [value for value in (error.identify, error.validate) if value is not None]
    use = "that were not fitted" if values and max(values) == error.validate else "for identification"
    return (
        Tile("Error", share(max(values, default=None)), f"of the current, on recordings {use}"),
        _noise_tile(noise),
        *_worst_tile(where, ", all recordings"),
    )


def replay_tiles(result: Replay, where: WhereItFails, noise: float) -> tuple[Tile, ...]:
    """The key numbers of a replay."""
    twins, models = (relative_error(comparison.recordings) for comparison in (result.twin, result.model))
    return (
        Tile("Error of the twin", share(twins), "of the current, all recordings"),
        Tile("Error of the model", share(models), "from which the twin was exported"),
        _noise_tile(noise),
        *_worst_tile(where, ""),
    )


def _worst_tile(where: WhereItFails, of: str) -> list[Tile]:
    worst = sorted(where.motors, key=lambda motor: -motor.error)[:1]
    return [Tile("Worst motor", motor.joint, f"error {share(motor.error)}{of}") for motor in worst]


def _noise_tile(noise: float) -> Tile:
    return Tile("Noise floor", share(noise), "of the currents, as an error")


def _gain_tile(result: Identification) -> Tile:
    why = why_nominal(result)
    if not result.gains_fitted:
        return Tile("Drive gains", "nominal", "" if why is None else in_short(why))
    gains = _fitted_gains(result)
    open_ = [joint for joint, gain in gains.items() if not gain.determined]
    if open_:
        return Tile("Drive gains", "not determined", ", ".join(open_))
    joint = max(gains, key=lambda name: abs(gain_change(gains[name])))
    change = share(gain_change(gains[joint]), signed=True)
    return Tile("Largest gain change", change, f"{joint}, from nominal")


def _level(error: ErrorSummary, noise: float, subject: str) -> str:
    uses = ((error.validate, "recordings that were not fitted"), (error.identify, "fitted recordings"))
    parts = [f"{share(value)} on {words}" for value, words in uses if value is not None]
    size = " and ".join(parts) or "no error: no recording"
    return f"{subject} is off by {size}, in percent of the current, where noise leaves {share(noise)}."


def _failing(where: WhereItFails) -> str:
    loud = [motor for motor in where.motors if motor.above_noise]
    if not loud:
        return "At no motor is more left than the noise of its current: there is nothing to find."
    worst = max(loud, key=lambda motor: motor.error / motor.noise if motor.noise else motor.error)
    times = f", {short(worst.error / worst.noise, 3)} times its noise" if worst.noise > 0 else ""
    most = f", most at {worst.joint}" if len(loud) > 1 else ""
    more = f"More than noise remains at {and_list([motor_words(motor.joint) for motor in loud])}{most}"
    return f"{more} ({share(worst.error)}{times}); bench diagnose tells which physical effect that may be."
