"""What limits an answer, in words that say what to do."""

from dataclasses import replace

import numpy as np

from bench.estimate.result import Identification

LOOSE = 0.3  # relative deviation above which a parameter says little
ILL_CONDITIONED = 1e3
UNLIKE = 3.0  # times the fitted error: recordings that were not fitted are another machine, load or unit
SUSPICIOUS_GAIN = 0.5  # of the nominal gain: makers are wrong by a tenth


def notes_on(result: Identification, left_aside: tuple[str, ...]) -> Identification:
    """The result with its notes; `left_aside`: recordings that could not be used."""
    notes = []
    if left_aside:
        notes.append(
            f"Left aside: {', '.join(left_aside)}. Their payload is not declared in full, and no fitted recording "
            "carries it."
        )
    if not result.gains_fitted:
        notes.append(
            "No fitted recording carries a payload of known mass: the drive gains stay at their nominal "
            "values, and every parameter is wrong by the same share as the gain that scales it."
        )
    if result.rank < result.unknowns:
        notes.append(
            f"The data determine only {result.rank} of {result.unknowns} unknowns: move all joints together, "
            "with larger and faster movements, or record an unloaded and a loaded trajectory."
        )
    if result.scaled_condition > ILL_CONDITIONED:
        notes.append(
            f"The scaled observation matrix has a condition number of {result.scaled_condition:.0f}: some "
            "parameters cannot be told apart well; a more exciting trajectory helps."
        )
    absorbed = [
        f"{name} of {effect}" + ("" if place == "robot" else f" at {place}")
        for effect, places in result.effect_parameters.items()
        for place, values in places.items()
        for name, one in values.items()
        if not np.isfinite(one.std)
    ]
    if absorbed:
        notes.append(
            f"These data cannot show {', '.join(absorbed)}: other parameters of the model do the same, and take "
            "up the effect."
        )
    notes += _implausible(result)
    for j, joint in enumerate(result.drive_gains):
        reverses = any(np.ptp(np.sign(one.velocity[:, j])) > 0 for one in result.recordings)
        if not reverses:
            notes.append(
                f"Joint {joint} never reverses: move it through zero velocity to tell friction apart."
            )
    loose = sum(parameter.relative_std > LOOSE for parameter in result.parameters)
    if loose:
        notes.append(
            f"{loose} of {len(result.parameters)} parameters are poorly determined (deviation above {LOOSE:.0%} of the "
            "value); essential parameters (--essential) leave out what does not matter."
        )
    return replace(result, notes=tuple(notes))


def _implausible(result: Identification) -> list[str]:
    """What cannot be so: gains far off, all negative, or recordings unlike each other."""
    notes = []
    for joint, gain in result.drive_gains.items():
        if result.gains_fitted and abs(gain.value / gain.nominal - 1.0) > SUSPICIOUS_GAIN:
            notes.append(
                f"The drive gain of {joint} came out at {gain.value:.3g} {gain.unit}, far from its nominal "
                f"{gain.nominal:.3g}: a physical effect is missing in the model, or the payload is not as "
                "declared."
            )
    if result.gains_fitted and all(gain.value < 0 for gain in result.drive_gains.values()):
        notes.append(
            "All drive gains came out negative, which cannot be: the recordings with and without payload are "
            "probably swapped in dataset.toml, or the currents' sign is."
        )
    fitted, checked = result.error.identify, result.error.validate
    if fitted is not None and checked is not None and checked > UNLIKE * fitted:
        worst = max(
            (name for name in result.error.by_recording), key=lambda name: result.error.by_recording[name]
        )
        notes.append(
            f"Recordings that were not fitted are modelled far worse ({checked:.2%}) than those that were "
            f"({fitted:.2%}), {worst} worst: check its payload and its columns, or move the fitted recordings "
            "over the same range."
        )
    return notes
