"""What a page shows of a model: its errors by motor, and where it comes from."""

from collections.abc import Sequence
from dataclasses import dataclass

from bench.dataset.dataset import Dataset
from bench.diagnosis.split import with_judged_parts
from bench.effects import catalogue_for
from bench.identification.model_file import Comparison
from bench.identification.result import Identification
from bench.model.geometry import read_geometry
from bench.residuals.look_alikes import possible_effects
from bench.residuals.motor import Compared, MotorSeries, compared
from bench.residuals.residuals import WhereItFails, errors_by_motor
from bench.signals.settings import FilterSettings


@dataclass(frozen=True, eq=False)
class Shown:
    """A model beside the recordings. name: as in "error ... "; role: the colour of its errors."""

    name: str
    role: str
    what: Compared
    where: WhereItFails

    @property
    def joints(self) -> tuple[str, ...]:
        """The motors that move, at least in one recording."""
        return tuple(joint for joint in self.what.joints if self.what.of(joint))

    def one(self, joint: str, recording: str) -> MotorSeries | None:
        """One motor in one recording; None where it hardly moves."""
        found = [one for one in self.what.of(joint) if one.recording == recording]
        return found[0] if found else None


def shown(
    name: str,
    role: str,
    dataset: Dataset,
    model: Identification | Comparison,
    settings: FilterSettings,
    has: Sequence[str] | None = None,
) -> Shown:
    """Look for where the errors of a model are. dataset: with the recordings that the model's series are of.

    has: the effects of the model; given, others that leave such errors are named.
    """
    if any(one.name not in {r.name for r in dataset.recordings} for one in model.recordings):
        dataset, _ = with_judged_parts(dataset)
    what = compared(dataset.robot, dataset.recordings, model.recordings, settings)
    if has is None:
        return Shown(name, role, what, errors_by_motor(what))
    weighed = [payload for payload, one in dataset.payloads.items() if one.mass is not None]
    possible = possible_effects(read_geometry(dataset.robot), weighed, catalogue_for(dataset.effect_files))
    return Shown(name, role, what, errors_by_motor(what, possible, has))
