"""What logs hold besides the motion, and what the parameters do in half of the band, in words."""

from collections.abc import Callable, Mapping

from bench.identification.finding import Code, Finding
from bench.identification.wording import and_list, in_percent


def _narrowed(finding: Finding) -> str:
    band, rejected = finding.numbers["band"], finding.numbers["rejected"]
    return (
        f"The fit uses frequencies up to {band:.3g} Hz. The spectra suggest {rejected:.3g} Hz, but there parameters "
        "of rigid bodies and friction move by more than their standard errors when the band is halved: the "
        "accelerations hold noise. Standard errors include the difference that remains."
    )


def _matters(finding: Finding) -> str:
    return (
        f"With half of the band of {finding.numbers['band']:.3g} Hz the parameters differ by more than their standard "
        "errors, or these are clearly smaller; the stated ones include the difference. Either the accelerations hold "
        f"noise, or the model lacks an effect: try `--decimation {2 * finding.numbers['decimation']:.0f}`."
    )


def _unchecked(finding: Finding) -> str:
    return (
        f"The band of {finding.numbers['band']:.3g} Hz is not checked by its result: half of it would leave too few "
        "samples. Noise of the positions that is not white would bias the answer by more than its standard errors; "
        "longer recordings allow the check."
    )


def _repeated(finding: Finding) -> str:
    return (
        f"Of {and_list(finding.names)} up to {in_percent(finding.numbers['share'])} of the rows repeat the row before, "
        "while the robot moves: the logger ran faster than the controller. They are not used; check the time base, too."
    )


BAND_WORDS: Mapping[Code, Callable[[Finding], str]] = {
    Code.ROWS_REPEATED: _repeated,
    Code.BAND_NARROWED: _narrowed,
    Code.BAND_MATTERS: _matters,
    Code.BAND_UNCHECKED: _unchecked,
}
