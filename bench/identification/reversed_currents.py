"""Whether a motor's current has the wrong sign, in all recordings or in one: tried where the model explains little."""

from collections.abc import Iterator

from bench.basics.deadline import NEVER, Deadline
from bench.basics.threads import on_one_thread
from bench.identification.finding import Code, Finding
from bench.identification.result import Identification
from bench.identification.swapped_columns import ColumnsTrial
from bench.identification.tolerances import TOLERANCES

_Reversal = tuple[tuple[str, ...], tuple[int, ...]]
"""Names of recordings, and the motors whose currents have the other sign in them."""


@on_one_thread
def reversed_currents(
    result: Identification, trial: ColumnsTrial, deadline: Deadline = NEVER
) -> list[Finding]:
    """The currents whose sign, changed, brings the error far down; none where none do.

    Tried with the nominal gains, since fitted ones would only change their own sign, and with dry and viscous friction
    in addition to the rigid bodies: one motor in all fitted recordings or in one, or all motors. trial: equations
    with the filters of the result. Raises TimeUpError after the deadline.
    """
    bounds = TOLERANCES.findings

    def error_with(change: _Reversal) -> float:
        deadline.check()
        return trial.error(trial.reversed_in(*change), nominal=True)

    before = error_with(((), ()))
    if before < bounds.large_error:
        return []
    names, motors = min(_changes(tuple(trial.parts), len(result.joints)), key=error_with)
    after = error_with((names, motors))
    if not after < min(bounds.swapped_error * before, bounds.explained):
        return []
    where = () if len(names) == len(trial.parts) else names
    numbers = {"before": before, "after": after}
    return [
        Finding(Code.CURRENT_REVERSED, (result.joints[motor], *where), numbers=numbers) for motor in motors
    ]


def _changes(names: tuple[str, ...], motors: int) -> Iterator[_Reversal]:
    each = [(motor,) for motor in range(motors)]
    for chosen in dict.fromkeys([names, *((name,) for name in names)]):
        for some in dict.fromkeys([*each, tuple(range(motors))]):
            yield chosen, some
