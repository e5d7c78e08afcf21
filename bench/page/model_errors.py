"""What a page shows of a model: its errors by motor, and where it comes from."""

from collections.abc import Sequence
from dataclasses import dataclass

from bench.diagnosis.split import dataset_of
from bench.document.charts.chart import Role
from bench.identification.model_file import Comparison
from bench.identification.problem import Problem
from bench.identification.result import Identification
from bench.residuals.look_alikes import possible_effects
from bench.residuals.motor import Compared, MotorSeries, compared
from bench.residuals.residuals import WhereItFails, errors_by_motor
from bench.signals.settings import FilterSettings


@dataclass(frozen=True, eq=False)
class ShownModel:
    """A model's errors in the recordings. name: as in "error ... ", label: as a choice; role: its errors' colour."""

    name: str
    role: Role
    what: Compared
    where: WhereItFails
    label: str = ""

    @property
    def joints(self) -> tuple[str, ...]:
        """The motors that move, at least in one recording."""
        return tuple(joint for joint in self.what.joints if self.what.of(joint))

    def one(self, joint: str, recording: str) -> MotorSeries | None:
        """One motor in one recording; None where it hardly moves."""
        traces = [trace for trace in self.what.of(joint) if trace.recording == recording]
        return traces[0] if traces else None


def shown_model(
    name: str,
    role: Role,
    problem: Problem,
    model: Identification | Comparison,
    settings: FilterSettings,
    has: Sequence[str] | None = None,
    label: str = "",
) -> ShownModel:
    """Look for where the errors of a model are. problem: with the dataset that the model's series are of.

    has: the effects of the model; given, others that leave such errors are named. name, label: see `ShownModel`.
    """
    dataset = dataset_of(problem.dataset, model.recordings)
    what = compared(dataset.robot, dataset.recordings, model.recordings, settings)
    if has is None:
        return ShownModel(name, role, what, errors_by_motor(what), label)
    return ShownModel(name, role, what, errors_by_motor(what, possible_effects(problem), has), label)
