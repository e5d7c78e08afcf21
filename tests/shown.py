"""An identification written by hand, of recordings that move a robot gently; nothing is fitted."""

from pathlib import Path

import numpy as np

from bench.dataset.dataset import Dataset
from bench.dataset.payload import Payload
from bench.dataset.recording import Recording
from bench.dataset.robot import Robot
from bench.identification.finding import Code, Finding, Unknown
from bench.identification.result import (
    CurrentSeries,
    DriveGain,
    Identification,
    Parameter,
    Quantity,
    error_summary,
)
from bench.model.geometry import Geometry, read_geometry
from bench.signals.settings import FilterSettings

RATE = 1000.0
SETTINGS = FilterSettings(position_cutoff=40.0, decimation=25, border=(50, 50))
RECORDINGS = (
    ("unloaded.csv", "identify", None),
    ("loaded.csv", "identify", "disc"),
    ("check.csv", "validate", None),
)
DISC = Payload("disc", 0.5, np.array([0.0, 0.0, 0.02]), None)
LONG = "m(left_rod) + 0.25 m(right_rod) - 3.33333 Iyy(right_rod) + 0.123457 mx(left_crank)"
PARAMETERS = (
    Parameter(
        0.35535, 0.0007, "kg*m", "mx(left_crank)", "mx(left_crank) + 0.2 m(left_rod) - 0.666667 mx(left_rod)"
    ),
    Parameter(-0.0358, 0.0215, "kg*m", "mz(left_rod)", "mz(left_rod)"),
    Parameter(0.065514, 0.000049, "kg*m^2", "m(left_rod)", LONG),
)

NOTE = "A note that says what limits the answer, at some length, so that it does not fit into one line."


def dataset_of(robot: Robot, duration: float = 2.0, start: float = 0.0, recordings=RECORDINGS) -> Dataset:
    """Recordings around home, `start` being the logged time of their first sample."""
    geometry = read_geometry(robot)
    made = []
    for number, (name, use, payload) in enumerate(recordings):
        time = start + np.arange(round(duration * RATE)) / RATE
        position = _around_home(geometry, time - start, number)
        noise = np.random.default_rng(number).normal(size=position.shape)
        current = (
            1.0 + 0.3 * np.sin(3.0 * (time - start)[:, None] + np.arange(position.shape[1])) + 0.01 * noise
        )
        made.append(Recording(name, use, payload, time, position, current))
    return Dataset(Path("gentle"), robot, {"disc": DISC}, tuple(made), ())


def _around_home(geometry: Geometry, time: np.ndarray, number: int) -> np.ndarray:
    slides = [joint.v.start for joint in geometry.joints if joint.kind == "slide"]
    home = geometry.home[geometry.active_configuration] + geometry.active_offset
    size = np.where(np.isin(geometry.active, slides), 0.04, 0.12)
    rate = 2.0 * np.pi * (0.5 + 0.2 * np.arange(len(home)) + 0.1 * number)
    return home + size * np.sin(rate * time[:, None])


def identification_of(
    dataset: Dataset, *, gains_fitted: bool = True, effects: bool = False, left_out: tuple[str, ...] = ()
) -> Identification:
    """An answer with an error of about one percent, of which every number is made up."""
    series = []
    for recording in dataset.recordings:
        border = SETTINGS.border[0]
        chosen = slice(border, len(recording.time) - border, SETTINGS.decimation)
        measured = recording.current[chosen]
        wobble = (
            0.01 * np.sin(40.0 * recording.time[chosen])[:, None] * np.linspace(0.5, 1.0, measured.shape[1])
        )
        position = recording.position[chosen]
        series.append(
            CurrentSeries(
                name=recording.name,
                use=recording.use,
                payload=recording.payload,
                time=recording.time[chosen],
                measured=measured,
                modelled=measured - wobble,
                position=position,
                velocity=np.gradient(position, axis=0),
                acceleration=np.zeros_like(position),
                moving=np.arange(len(measured))[:, None] >= np.full(measured.shape[1], 3),
            )
        )
    gains = {
        actuator.joint: DriveGain(
            actuator.gain * (1.1 if gains_fitted else 1.0),
            0.0015 if gains_fitted else 0.0,
            actuator.gain_unit,
            actuator.gain,
        )
        for actuator in dataset.robot.actuators
    }
    first = dataset.robot.joints[0]
    friction = {"viscous_friction": {first: {"Fv": Quantity(0.12, 0.003, "N*m*s/rad")}}}
    size = len(PARAMETERS) + len(gains)
    return Identification(
        robot=dataset.robot.name,
        robot_folder=str(dataset.robot.folder),
        method="wtls",
        effects=("viscous_friction",) if effects else (),
        drive_gains=gains,
        gains_fitted=gains_fitted,
        parameters=PARAMETERS,
        effect_parameters=friction if effects else {},
        covariance=np.eye(size),
        covariance_rows=tuple(
            [Unknown("parameter", one.name) for one in PARAMETERS]
            + [Unknown("gain", "gain", joint) for joint in gains]
        ),
        rank=size,
        unknowns=size,
        condition=312.4,
        scaled_condition=41.5,
        error=error_summary(series, dataset.robot.joints),
        settings=SETTINGS,
        deviations="autocorrelated",
        recordings=tuple(series),
        left_out=left_out,
        findings=(Finding(Code.TOLD, (NOTE,)),),
    )
