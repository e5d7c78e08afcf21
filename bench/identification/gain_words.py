"""What is wrong with drive gains, in words: not determined, far from nominal, negative."""

from collections.abc import Callable, Mapping

from bench.identification.finding import Code, Finding
from bench.identification.wording import and_list, in_percent


def _gain_not_determined(finding: Finding) -> str:
    gains = and_list([unknown.place for unknown in finding.of])
    return (
        f"These data do not determine the drive gain{'s' * (len(finding.of) > 1)} of {gains}: the standard error is "
        "larger than the value. Declare more of the payload, or record one that loads the motor more."
    )


def _gain_runaway(finding: Finding) -> str:
    return (
        f"{_gain_came_out(finding)}; its nominal value is {finding.numbers['nominal']:.3g}. No drive "
        "differs that much from its data sheet: a physical effect is missing in the model, or the payload is not as "
        "declared."
    )


def _gain_far(finding: Finding) -> str:
    return (
        f"{_gain_came_out(finding)}, far from its nominal {finding.numbers['nominal']:.3g}: a physical "
        "effect is missing in the model, or the payload is not as declared."
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


def _gain_came_out(finding: Finding) -> str:
    unit = finding.unit.replace("*", "·")
    return f"The estimated drive gain of {finding.names[0]} is {finding.numbers['value']:.3g} {unit}"


def _sign(finding: Finding) -> str:
    joint = finding.names[0]
    return (
        f"The estimated drive gain of {joint} is negative, which is impossible: the sign of current.{joint}, or of "
        f"position.{joint}, is probably reversed (`bench import ... --scale current.{joint}=-1`), or its column "
        "belongs to another motor."
    )


def _negative(finding: Finding) -> str:
    joint = finding.names[0]
    return (
        f"The estimated drive gain of {joint} is negative, which is impossible: reversing the sign of current.{joint} "
        "does not explain the current either. The payload probably differs from its declaration or is mounted "
        "differently, an effect is missing, or the column belongs to another motor."
    )


def _current_reversed(finding: Finding) -> str:
    joint, *recordings = finding.names
    where = f" in {recordings[0]}" if recordings else ""
    again = "that log" if recordings else "the logs"
    return (
        f"The sign of current.{joint}{where} is probably reversed: with the other sign {_falls(finding)}. "
        f"Import {again} again with `--scale current.{joint}=-1`."
    )


def _position_reversed(finding: Finding) -> str:
    joint = finding.names[0]
    also = f" and of current.{joint}" if finding.numbers["current"] else ""
    option = f" --scale current.{joint}=-1" if finding.numbers["current"] else ""
    return (
        f"The sign of position.{joint}{also} is probably reversed: with the other sign {_falls(finding)}. Import the "
        f"logs again with `--scale position.{joint}=-1{option}`."
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


GAIN_WORDS: Mapping[Code, Callable[[Finding], str]] = {
    Code.GAIN_NOT_DETERMINED: _gain_not_determined,
    Code.GAIN_RUNAWAY: _gain_runaway,
    Code.GAIN_FAR: _gain_far,
    Code.GAINS_ALIKE: _gains_alike,
    Code.CURRENT_REVERSED: _current_reversed,
    Code.POSITION_REVERSED: _position_reversed,
    Code.POSITIONS_SWAPPED: _positions_swapped,
    Code.SIGN_REVERSED: _sign,
    Code.GAIN_NEGATIVE: _negative,
    Code.GAINS_A_THOUSAND: lambda _: (
        "The estimated drive gains are about a thousand times the nominal ones: is the payload's mass in grams? It "
        "must be in kg."
    ),
    Code.GAINS_A_THOUSANDTH: lambda _: (
        "The estimated drive gains are about a thousandth of the nominal ones: is the payload's mass in tonnes, or are "
        "the currents in mA?"
    ),
    Code.GAINS_NEGATIVE: lambda _: (
        "All estimated drive gains are negative, which is impossible: the recordings with and without payload are "
        "probably swapped in dataset.toml, or the sign of the currents is reversed."
    ),
}
