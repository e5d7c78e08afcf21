"""Encoder noise that passes the filters: if it moves the answer, the answer says so.

Differentiated twice, the noise power of a position grows with the fourth power of the frequency. In the observation
matrix it biases every estimate that takes this matrix as exact. Hausman's test ("Specification tests in econometrics",
1978) shows the bias: the distance to an estimate that is consistent with errors in the variables, though less precise
without them: instrumental variables, see `bench.identification.instrumental`.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from bench.identification.finding import Code, Finding
from bench.identification.model_averaged import all_model_averaged
from bench.identification.prepare import Prepared
from bench.identification.result import Identification
from bench.identification.tolerances import TOLERANCES
from bench.signals.bounds import BANDS
from bench.signals.settings import signal_bands

CONSISTENT = ("iv", "oe")  # these do not take the observation matrix of the measured motion as exact

Fit = Callable[[Prepared, str], Identification]


def noise_share(prepared: Prepared) -> float:
    """Power of the encoder noise in the fit's band, as a share of the acceleration's; the largest of all joints and
    recordings.
    """
    recordings = [
        measurement.recording for measurement in prepared.measured if measurement.recording.use == "identify"
    ]
    rate, settings = recordings[0].rate, prepared.settings
    bands = prepared.bands or signal_bands(
        [recording.position for recording in recordings],
        [recording.current for recording in recordings],
        rate,
    )
    band = min(settings.band(rate), settings.position_cutoff)
    return float(BANDS.fit_noise * (band / bands.fit_limit) ** 5)


def with_errors_in_variables_checked(
    prepared: Prepared, result: Identification, fitted: Fit
) -> Identification:
    """The answer, whose standard errors cover that of instrumental variables from the same equations if noise passes
    the filters; with a finding if the two differ in a drive gain. fitted: makes an answer by a method.
    """
    if result.method in CONSISTENT or not result.gains_fitted:
        return result
    share = noise_share(prepared)
    bounds = TOLERANCES.findings
    if share < bounds.noise_power:
        return result
    other = fitted(prepared, "iv")
    gains, others = result.drive_gains, other.drive_gains
    moved = {joint: abs(others[joint].value - gain.value) for joint, gain in gains.items()}
    seen = any(
        moved[joint] > bounds.noise_moves * np.hypot(gain.std, others[joint].std)
        for joint, gain in gains.items()
    )
    answer = all_model_averaged(result, other, "instruments")
    if not seen and share < bounds.loud_noise:
        return answer
    worst = max(gains, key=lambda joint: moved[joint] / abs(others[joint].value))
    gain = gains[worst]
    numbers = {"share": share, "value": gain.value, "other": others[worst].value}
    decides = moved[worst] > bounds.noise_decides * min(abs(gain.value), abs(numbers["other"]))
    code = Code.NOISE_DECIDES if decides else Code.NOISE_LET_THROUGH
    return replace(answer, findings=(Finding(code, (worst,), (), numbers, gain.unit), *answer.findings))
