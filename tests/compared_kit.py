"""Errors made to order: a robot of one or two motors that moves in sines, and a model that fails as wished."""

from pathlib import Path

import numpy as np

from bench.dataset.recording import Recording
from bench.dataset.robot import Actuator, Robot
from bench.identification.result import CurrentSeries
from bench.residuals.motor import compared
from bench.signals.decimation import decimate, noise_bandwidth
from bench.signals.settings import FilterSettings

RATE, EVERY, ROWS = 1000.0, 25, 800  # logged samples per second, one row in so many, rows
SETTINGS = FilterSettings(position_cutoff=40.0, decimation=EVERY)
NOISE = 0.01  # A, of the logged current
TONES = ((0.31, 0.6), (0.83, 0.35), (1.37, 0.2))  # Hz and rad


def robot(joints=("left",)):
    actuators = tuple(Actuator(joint, 3.0, "N*m/A") for joint in joints)
    return Robot("made", Path("made"), Path("made.xml"), actuators, None)


def one_recording(error, name="a.csv", use="identify", payload=None, seed=0, joints=("left",), moving=None):
    """A recording and its series; error: a function of the row's motion (a dictionary) and a generator, A."""
    random = np.random.default_rng(seed)
    phases = random.uniform(0.0, 2.0 * np.pi, len(TONES))
    time = np.arange(ROWS * EVERY) / RATE

    def motion(order, at):
        return sum(
            size * (2 * np.pi * tone) ** order * np.sin(2 * np.pi * tone * at + phase + order * np.pi / 2)
            for (tone, size), phase in zip(TONES, phases, strict=True)
        )

    rows = time[::EVERY]
    row = {"time": rows, "payload": payload}
    row |= {name: motion(i, rows) for i, name in enumerate(("position", "velocity", "acceleration"))}
    modelled = 1.0 + 0.3 * np.sin(2 * np.pi * 0.53 * rows + phases[0])  # has nothing to do with the motion
    logged = np.interp(time, rows, modelled) + NOISE * random.standard_normal(len(time))
    wide = np.ones((1, len(joints)))
    series = CurrentSeries(
        name=name,
        use=use,
        payload=payload,
        time=rows + 3.0,
        measured=modelled[:, None] * wide + np.column_stack([error(row, random) for _ in joints]),
        modelled=modelled[:, None] * wide,
        position=row["position"][:, None] * wide,
        velocity=row["velocity"][:, None] * wide,
        acceleration=row["acceleration"][:, None] * wide,
        moving=np.ones((len(rows), len(joints)), dtype=bool) if moving is None else moving,
    )
    recording = Recording(name, use, payload, time, motion(0, time)[:, None] * wide, logged[:, None] * wide)
    return recording, series


def made(error, count=2, payloads=(None, None), joints=("left",)):
    """Several recordings whose errors follow the same function."""
    pairs = [
        one_recording(error, f"{k}.csv", payload=payloads[k % len(payloads)], seed=k, joints=joints)
        for k in range(count)
    ]
    recordings, series = zip(*pairs, strict=True)
    return compared(robot(joints), recordings, series, SETTINGS)


def white(random, size=0.02, rows=ROWS):
    return size * random.standard_normal(rows)


def filtered(random, size):
    """What the filter of the fit leaves of white noise, of this RMS."""
    noise = decimate(random.standard_normal(ROWS * EVERY), EVERY)[:ROWS]
    return size * noise / np.sqrt(noise_bandwidth(EVERY))


def coloured(random, alike=0.7, size=0.02, rows=ROWS):
    """Errors of which each is correlated by `alike` with the one before."""
    fresh = random.standard_normal(rows) * np.sqrt(1.0 - alike**2)
    found = np.empty(rows)
    found[0] = random.standard_normal()
    for i in range(1, rows):
        found[i] = alike * found[i - 1] + fresh[i]
    return size * found
