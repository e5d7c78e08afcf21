"""Why drive gains stay nominal, and what would fix them, in the same words for every medium."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING

from bench.basics.sentence import and_list, or_list
from bench.identification.finding import Code, Finding, Unknown
from bench.identification.scale import Scale, ScaleCase, ScaleRemedy

if TYPE_CHECKING:
    from bench.identification.result import Identification

CODES: Mapping[ScaleCase, Code] = {
    ScaleCase.NOT_WANTED: Code.GAINS_NOT_WANTED,
    ScaleCase.NO_PAYLOAD: Code.GAINS_NOMINAL,
    ScaleCase.MASS_UNKNOWN: Code.PAYLOAD_NOT_WEIGHED,
    ScaleCase.NOT_FIXED: Code.GAINS_NOT_FIXED,
    ScaleCase.FIXED_FOR_SOME: Code.GAINS_FIXED_FOR_SOME,
}
DECLARED = {
    ScaleRemedy.MASS: "mass",
    ScaleRemedy.CENTER_OF_MASS: "centre of mass",
    ScaleRemedy.INERTIA: "inertia",
}
DONE = {
    ScaleRemedy.ELSEWHERE: "fix {it} farther from the axes about which the tool turns",
    ScaleRemedy.UNLOADED: "also record a motion without {it}",
    ScaleRemedy.MOTION: "move all joints together with {it}, farther and faster",
}


def scale_findings(scale: Scale) -> list[Finding]:
    """What keeps drive gains nominal, with payloads `names` and gains `of`; none if all are fixed.

    numbers: how many of these gains each remedy would fix, remedies that go together joined by "+".
    """
    if scale.case not in CODES:
        return []
    numbers = {"+".join(remedies): float(count) for remedies, count in scale.remedies.items()}
    of = tuple(Unknown("gain", "gain", joint) for joint in scale.open)
    return [Finding(CODES[scale.case], scale.payloads, of, numbers)]


def why_nominal(result: Identification) -> Finding | None:
    """The finding that tells why some or all drive gains of an answer stay nominal; None where none does."""
    why = next((finding for finding in result.findings if finding.code in CODES.values()), None)
    return why or (None if result.gains_fitted else Finding(Code.GAINS_NOMINAL))


def nominal_gains(finding: Finding) -> str:
    """The gains that stay nominal, with an article."""
    if finding.code is not Code.GAINS_FIXED_FOR_SOME:
        return "the drive gains"
    return f"the drive gain{'s' * (len(finding.of) > 1)} of {and_list([unknown.place for unknown in finding.of])}"


def is_one_gain(finding: Finding) -> bool:
    """Whether a single gain of several stays nominal."""
    return finding.code is Code.GAINS_FIXED_FOR_SOME and len(finding.of) == 1


def reason(finding: Finding) -> str:
    """Why, as a clause that follows "since"."""
    return REASONS[finding.code](finding)


def cure(finding: Finding) -> str:
    """What would fix them, as sentences; "" if nothing needs a remedy."""
    if finding.code is Code.GAINS_NOT_WANTED:
        return ""
    if finding.code is Code.GAINS_NOMINAL:
        return "Also record a motion with a weighed payload."
    ways = [_way(name.split("+"), finding.names) for name in finding.numbers]
    if not ways:
        return "Declaring more about a payload at this tool does not change that."
    said = or_list(ways)
    reached = max(finding.numbers.values())
    some = "" if reached == len(finding.of) else f" That fixes {reached:.0f} of {len(finding.of)}."
    return f"{said[0].upper()}{said[1:]}.{some}"


def in_short(finding: Finding) -> str:
    """Why, in few words."""
    return SHORT[finding.code]


def scale_sentence(finding: Finding) -> str:
    """The finding by itself: which gains stay nominal, why, and what would fix them."""
    gains = nominal_gains(finding)
    single = is_one_gain(finding)
    stay, their, they = ("stays", "its", "it is") if single else ("stay", "their", "they are")
    wrong = (
        f"parameters that {'it' if single else 'they'} alone scale{'s' * single} are as wrong as {they}"
        if finding.code is Code.GAINS_FIXED_FOR_SOME
        else "every parameter has the same relative error as the gain that scales it"
    )
    said = f"T{gains[1:]} {stay} at {their} nominal value{'s' * (not single)}, because {reason(finding)}: {wrong}."
    return f"{said} {cure(finding)}".rstrip()


def refusal(scale: Scale) -> str:
    """Why not all drive gains can be fitted, in one line."""
    (finding,) = scale_findings(scale)
    return f"{nominal_gains(finding)} cannot be fitted, because {reason(finding)}. {cure(finding)}".rstrip()


def _payloads(names: Sequence[str]) -> str:
    return f"the payload{'s' * (len(names) > 1)} {and_list(names)}"


def _not_fixed(finding: Finding) -> str:
    single = len(finding.names) == 1
    return (
        f"{_payloads(finding.names)}, as {'it is' if single else 'they are'} declared and moved, "
        f"{'does' if single else 'do'} not fix {'it' if is_one_gain(finding) else 'them'}"
    )


def _way(remedies: Sequence[str], payloads: Sequence[str]) -> str:
    """Remedies that go together, as in "declare its centre of mass"."""
    its, it = ("its", "it") if len(payloads) == 1 else ("their", "them")
    declared = [DECLARED[ScaleRemedy(remedy)] for remedy in remedies if ScaleRemedy(remedy) in DECLARED]
    steps = [f"declare {and_list([f'{its} {what}' for what in declared])}"] if declared else []
    steps += [DONE[ScaleRemedy(remedy)].format(it=it) for remedy in remedies if ScaleRemedy(remedy) in DONE]
    return " and ".join(steps)


REASONS: Mapping[Code, Callable[[Finding], str]] = {
    Code.GAINS_NOT_WANTED: lambda _: "they are excluded from the fit",
    Code.GAINS_NOMINAL: lambda _: "no fitted recording carries a payload of known mass",
    Code.PAYLOAD_NOT_WEIGHED: lambda finding: f"the mass of {_payloads(finding.names)} is not declared",
    Code.GAINS_NOT_FIXED: _not_fixed,
    Code.GAINS_FIXED_FOR_SOME: _not_fixed,
}
SHORT: Mapping[Code, str] = {
    Code.GAINS_NOT_WANTED: "not fitted, as requested",
    Code.GAINS_NOMINAL: "no payload",
    Code.PAYLOAD_NOT_WEIGHED: "payload of unknown mass",
    Code.GAINS_NOT_FIXED: "the payload does not fix them",
    Code.GAINS_FIXED_FOR_SOME: "the payload does not fix all",
}
