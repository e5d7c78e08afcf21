"""What all drive gains, or signs of columns, say of the declarations, in words."""

from collections.abc import Callable, Mapping

from bench.basics.sentence import and_list, in_percent
from bench.identification.finding import Code, Finding


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
    Code.GAINS_ALIKE: _gains_alike,
    Code.CURRENT_REVERSED: _current_reversed,
    Code.POSITION_REVERSED: _position_reversed,
    Code.POSITIONS_SWAPPED: _positions_swapped,
}
