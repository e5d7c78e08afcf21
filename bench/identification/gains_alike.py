"""Drive gains that are all off by a like factor: the declared mass of the payload is wrong, not the motors' gains."""

from collections.abc import Mapping
from math import exp, log

import numpy as np

from bench.dataset.payload import Payload
from bench.identification.finding import Code, Finding, Unknown
from bench.identification.result import Identification
from bench.identification.tolerances import TOLERANCES


def gains_alike(result: Identification, payloads: Mapping[str, Payload]) -> list[Finding]:
    """The payloads whose declared mass moves all drive gains; none where gains differ, or are near nominal.

    Every gain is proportional to that mass. Where the model leaves much of the current, a missing effect may move the
    gains as well, and nothing is said of the mass. numbers: least and greatest gain over the nominal one, the declared
    mass of the first payload, and the one with which the gains are nominal on average.
    """
    bounds = TOLERANCES.findings
    gains = {joint: gain for joint, gain in result.drive_gains.items() if gain.fitted and gain.determined}
    ratios = [gain.value / gain.nominal for gain in gains.values()]
    carried = {series.payload for series in result.recordings if series.use == "identify"}
    weighed = [name for name, payload in payloads.items() if name in carried and payload.mass is not None]
    error = result.error.identify
    if not result.gains_fitted or len(ratios) < 2 or min(ratios) <= 0.0 or not weighed:
        return []
    if error is None or error > bounds.large_error or max(ratios) > bounds.alike_gains * min(ratios):
        return []
    common = exp(float(np.mean(np.log(ratios))))
    if abs(log(common)) <= log(bounds.common_gain):
        return []
    mass = payloads[weighed[0]].mass or 0.0
    numbers = {"least": min(ratios), "most": max(ratios), "mass": mass, "likely": mass / common}
    return [
        Finding(
            Code.GAINS_ALIKE,
            tuple(weighed),
            tuple(Unknown("gain", "gain", joint) for joint in gains),
            numbers,
            "kg",
        )
    ]
