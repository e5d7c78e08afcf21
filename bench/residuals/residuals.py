"""All findings on where a model fails, motor by motor."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from bench.effects import Effect
from bench.identification.decision import RULE
from bench.residuals.autocorrelation import autocorrelation
from bench.residuals.look_alikes import LookAlike, look_alikes
from bench.residuals.motor import Compared, relative_error_of, relative_noise
from bench.residuals.opposing_motion import Change, Opposing, by_load, changes, over_warm_up
from bench.residuals.periods import SpectralLine, lines
from bench.residuals.profile import Dependence, dependences
from bench.residuals.regions import Concentration, concentrations, regions


@dataclass(frozen=True)
class MotorErrors:
    """Findings on one motor's error.

    units: of current and position, as in ("A", "rad"). error, noise: relative to the measured current, all recordings
    together; by_recording: both of each, by name. autocorrelation_time: s over which errors correlate. above_noise:
    whether there is more than noise; else concentrations, dependences, lines and changes are empty. alike: effects with
    such errors.
    """

    joint: str
    units: tuple[str, str]
    error: float
    noise: float
    by_recording: dict[str, tuple[float, float]]
    autocorrelation_time: float
    above_noise: bool
    concentrations: tuple[Concentration, ...]
    dependences: tuple[Dependence, ...]
    lines: tuple[SpectralLine, ...]
    changes: tuple[Change, ...]
    warm_up: tuple[Opposing, Opposing]
    by_load: tuple[Opposing, ...]
    alike: tuple[LookAlike, ...] = ()


@dataclass(frozen=True)
class WhereItFails:
    """The errors of every motor that moves, and of the whole robot."""

    robot: str
    motors: tuple[MotorErrors, ...]


def errors_by_motor(
    what: Compared, possible: Mapping[str, Effect] | None = None, has: Sequence[str] = ()
) -> WhereItFails:
    """Examine where the errors of every motor are concentrated, and on what they depend.

    possible: effects that have a place in the robot, named if they leave such errors. has: those of the model.
    """
    motors = [_of_motor(what, joint, possible or {}, has) for joint in what.joints if what.of(joint)]
    return WhereItFails(what.robot, tuple(motors))


def _of_motor(what: Compared, joint: str, possible: Mapping[str, Effect], has: Sequence[str]) -> MotorErrors:
    series = what.of(joint)
    current, unit = what.units[joint]
    error, noise = relative_error_of(series) or 0.0, relative_noise(series)
    above = error > RULE.beyond_noise * noise
    patterns = (
        tuple(concentrations(series, regions(series, unit, current))) if above else (),
        tuple(dependences(series)) if above else (),
        tuple(lines(series)) if above else (),
        tuple(changes(series)) if above else (),
    )
    return MotorErrors(
        joint=joint,
        units=what.units[joint],
        error=error,
        noise=noise,
        by_recording={
            trace.recording: (relative_error_of([trace]) or 0.0, relative_noise([trace])) for trace in series
        },
        autocorrelation_time=autocorrelation(series).integrated_time / (series[0].rate or 1.0),
        above_noise=above,
        concentrations=patterns[0],
        dependences=patterns[1],
        lines=patterns[2],
        changes=patterns[3],
        warm_up=over_warm_up(series),
        by_load=tuple(by_load(series)),
        alike=look_alikes(joint, patterns, possible, has),
    )
