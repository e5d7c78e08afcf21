"""Velocities that a controller logged: taken where they are the positions' rate with less noise, and told otherwise."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from bench.dataset.dataset import Dataset
from bench.dataset.recording import Recording, velocity_column
from bench.identification.finding import Code
from bench.identification.finding_words import note
from bench.identification.identify import identify
from bench.identification.prepare import prepare
from bench.identification.problem import problem_of
from bench.identification.result import Identification
from bench.signals.processing import compared_velocity, estimate_motion
from bench.signals.settings import FilterSettings
from bench.truth.dataset import as_dataset
from bench.truth.resense import sense_again
from bench.truth.simulate import Simulation

RATE = 500.0
SETTINGS = FilterSettings(40.0, 5, border=(50, 50))
WAVES = ((1.0, 0.7, 0.2), (0.3, 2.9, 1.1), (0.1, 5.3, 2.0))  # rad, Hz, rad


def wave(time: np.ndarray, order: int) -> np.ndarray:
    """A motion, its velocity or its acceleration."""
    parts = (
        a * (2 * np.pi * f) ** order * np.sin(2 * np.pi * f * time + p + order * np.pi / 2)
        for a, f, p in WAVES
    )
    return np.asarray(sum(parts))


TIME = np.arange(6000) / RATE
STEP = 2 * np.pi / 2**12
ROUNDED = np.round(wave(TIME, 0) / STEP) * STEP
NOISE = 1e-3 * np.random.default_rng(7).normal(size=TIME.size)


def test_a_velocity_with_less_noise_is_taken_and_gives_the_better_acceleration() -> None:
    velocity = wave(TIME, 1) + NOISE
    found = compared_velocity(ROUNDED, velocity, RATE, SETTINGS)
    assert found.taken
    assert found.scale == pytest.approx(1.0, abs=1e-4)
    assert found.delay == pytest.approx(0.0, abs=1e-5)
    true = wave(TIME, 2)[50:-50]
    errors = [
        np.sqrt(
            np.mean(
                (estimate_motion(ROUNDED[:, None], RATE, SETTINGS, logged).acceleration[:, 0] - true) ** 2
            )
        )
        for logged in (None, velocity[:, None])
    ]
    assert found.louder == pytest.approx((errors[1] / errors[0]) ** 2, rel=1.0)  # noise, read off spectra
    assert errors[1] < 0.2 * errors[0]


@pytest.mark.parametrize(
    ("velocity", "scale", "delay"),
    [
        (wave(TIME - 4e-3, 1) + NOISE, 1.0, 4e-3),
        (np.degrees(wave(TIME, 1) + NOISE), np.degrees(1.0), 0.0),
        (1.01 * wave(TIME, 1) + NOISE, 1.01, 0.0),
        (-wave(TIME, 1) + NOISE, -1.0, 0.0),
    ],
    ids=["4 ms late", "in degrees", "1 % too large", "of the other sign"],
)
def test_a_velocity_that_is_not_the_rate_of_the_position_is_not_taken(
    velocity: np.ndarray, scale: float, delay: float
) -> None:
    found = compared_velocity(ROUNDED, velocity, RATE, SETTINGS)
    assert not found.agrees
    assert not found.taken
    assert found.scale == pytest.approx(scale, rel=2e-2)
    assert found.delay == pytest.approx(delay, abs=2e-4)


def test_a_velocity_with_more_noise_is_right_but_not_taken() -> None:
    found = compared_velocity(wave(TIME, 0), wave(TIME, 1) + NOISE, RATE, SETTINGS)
    assert found.agrees
    assert not found.taken


@pytest.fixture(scope="module")
def coarse(five_bar_simulation: Simulation) -> Dataset:
    """A five-bar with encoders of 11 bits, and its true velocities with little noise."""
    scenario, noise = five_bar_simulation.scenario, np.random.default_rng(3)
    sensors = scenario.settings.sensors.model_copy(update={"encoder_bits": 11})
    again = replace(scenario, settings=scenario.settings.model_copy(update={"sensors": sensors}))
    dataset = as_dataset(sense_again(five_bar_simulation, again))

    def logged(recording: Recording, true: np.ndarray) -> Recording:
        rate = np.gradient(true, recording.time, axis=0, edge_order=2)
        rate += 1e-4 * noise.normal(size=rate.shape)
        names = map(velocity_column, dataset.robot.joints)
        return replace(recording, extra=dict(zip(names, rate.T, strict=True)))

    true = [recording.position for recording in five_bar_simulation.recordings]
    return replace(dataset, recordings=tuple(map(logged, dataset.recordings, true)))


def changed(dataset: Dataset, change: Callable[[np.ndarray], np.ndarray] | None) -> Dataset:
    """The same with other velocities, or without."""
    return replace(
        dataset,
        recordings=tuple(
            replace(
                recording,
                extra={name: change(values) for name, values in recording.extra.items()} if change else {},
            )
            for recording in dataset.recordings
        ),
    )


def answer(dataset: Dataset) -> Identification:
    return identify(prepare(problem_of(dataset)))


def codes(result: Identification) -> set[Code]:
    return {finding.code for finding in result.findings}


def test_gains_are_better_where_better_velocities_were_logged(coarse: Dataset) -> None:
    plain, logged = answer(changed(coarse, None)), answer(coarse)
    late = answer(changed(coarse, lambda velocity: np.roll(velocity, 20)))
    assert Code.VELOCITY_TAKEN in codes(logged)
    assert logged.settings.band(1000.0) > plain.settings.band(1000.0)
    for joint, gain in plain.drive_gains.items():
        assert logged.drive_gains[joint].std < 0.9 * gain.std
    assert Code.VELOCITY_UNLIKE in codes(late)
    assert late.drive_gains == plain.drive_gains


@pytest.mark.parametrize(
    ("scale", "found"),
    [
        (0.625, {Code.TIME_BASE}),
        (np.degrees(1.0), {Code.VELOCITY_UNLIKE}),
        (1.0, set()),
    ],
    ids=["time base", "deg/s", "as it is"],
)
def test_velocities_of_all_joints_that_are_off_alike_contradict_the_time(
    coarse: Dataset, scale: float, found: set[Code]
) -> None:
    result = answer(changed(coarse, lambda velocity: scale * velocity))
    findings = {finding.code: finding for finding in result.findings}
    assert {Code.TIME_BASE, Code.VELOCITY_UNLIKE} & set(findings) == found
    if Code.TIME_BASE in found:
        numbers = findings[Code.TIME_BASE].numbers
        assert findings[Code.TIME_BASE].names == tuple(log.name for log in coarse.recordings)
        assert numbers["factor"] == pytest.approx(1.6, rel=1e-3)
        assert numbers["true"] == pytest.approx(numbers["factor"] * numbers["step"])
        assert numbers["step"] == pytest.approx(1e3 / coarse.recordings[0].rate)
    elif found:
        assert findings[Code.VELOCITY_UNLIKE].unit == "deg/s"
        assert "--scale velocity." in note(findings[Code.VELOCITY_UNLIKE])


def test_a_velocity_of_one_joint_says_nothing_of_the_time(coarse: Dataset) -> None:
    first = velocity_column(coarse.robot.joints[0])
    logs = tuple(
        replace(log, extra={**log.extra, first: 0.625 * log.extra[first]}) for log in coarse.recordings
    )
    alone = tuple(replace(log, extra={first: log.extra[first]}) for log in logs)
    for recordings in (logs, alone):
        result = answer(replace(coarse, recordings=recordings))
        assert Code.TIME_BASE not in codes(result)
        (finding,) = [finding for finding in result.findings if finding.code is Code.VELOCITY_UNLIKE]
        assert finding.unit == ""
