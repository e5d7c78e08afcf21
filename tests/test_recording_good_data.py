"""Data that are right but not tidy must come in without complaint."""

from pathlib import Path

import numpy as np
import pytest

from bench.dataset.dataset import load_dataset
from bench.dataset.joint_facts import JointFacts
from bench.dataset.recording import write_recording
from bench.dataset.recording_checks import Channel, find
from tests.broken_kit import CSV, edit, edit_lines
from tests.good_data import COUNT, JOINTS, RATE, movement, time_stamps, write_good_dataset

WHEEL = JointFacts("wheel", "hinge", None, None, 0.0, in_loop=True)
MOTIONS = ("trapezoid", "bang_bang", "quintic", "fourier")


def profile(motion: str, time: np.ndarray, move: float, rest: float, amplitude: float) -> np.ndarray:
    """A position that goes there and back again, with rests in between."""
    if motion == "fourier":
        return amplitude * movement(time, 3)[0][:, 0]

    def travel(u: np.ndarray) -> np.ndarray:
        u = np.clip(u, 0.0, 1.0)
        if motion == "trapezoid":
            edges = np.minimum(u, 1 / 3) ** 2 - np.maximum(u - 2 / 3, 0.0) ** 2
            return 2.25 * edges + 1.5 * np.clip(u - 1 / 3, 0.0, None)
        if motion == "bang_bang":
            return np.where(u < 0.5, 2 * u**2, 1 - 2 * (1 - u) ** 2)
        return 10 * u**3 - 15 * u**4 + 6 * u**5

    phase = time % (2 * (move + rest))
    return amplitude * (travel(phase / move) - travel((phase - move - rest) / move))


@pytest.mark.parametrize("rate", [50.0, 200.0, 1000.0, 8000.0])
@pytest.mark.parametrize("motion", MOTIONS)
@pytest.mark.parametrize("bits", [None, 12, 17, 23])
@pytest.mark.parametrize("noise", [0.0, 1e-5])
def test_positions_of_any_encoder_and_motion_are_accepted(
    rate: float, motion: str, bits: int | None, noise: float
) -> None:
    time = np.arange(0.0, 10.0, 1 / rate)
    for move, rest, amplitude in ((0.3, 0.0, 0.5), (1.0, 0.5, 2.0), (4.0, 0.0, 0.01), (2.0, 3.0, 1.0)):
        position = profile(motion, time, move, rest, amplitude)
        position += noise * np.random.default_rng(0).standard_normal(time.size)
        if bits is not None:
            position = np.round(position * 2**bits / (2 * np.pi)) * 2 * np.pi / 2**bits
        assert find(Channel(position, 1 / rate, WHEEL)) == []


@pytest.mark.parametrize("noise", [0.0, 0.01, 0.1])
@pytest.mark.parametrize("quantum", [0.0, 0.001, 0.01])
@pytest.mark.parametrize("hold", [1, 4])
def test_currents_noisy_quantised_and_held_are_accepted(noise: float, quantum: float, hold: int) -> None:
    time = np.arange(0.0, 20.0, 1e-3)
    for seed in range(5):
        current = 5.0 * movement(time, seed)[1][:, 0]
        current += noise * np.random.default_rng(seed).standard_normal(time.size)
        current = np.repeat(current[::hold], hold)  # a log faster than the controller
        if quantum:
            current = np.round(current / quantum) * quantum
        assert find(Channel(current, 1e-3)) == []


def test_slow_movement_with_a_coarse_encoder_is_accepted() -> None:
    time = np.arange(0.0, 60.0, 1e-3)
    position = np.round(0.05 * np.sin(0.3 * time) / 1.5e-3) * 1.5e-3
    current = np.round((0.5 * np.sin(0.3 * time) + 2.0 * np.sign(np.cos(0.3 * time))) / 0.005) * 0.005
    assert find(Channel(position, 1e-3, WHEEL)) == []
    assert find(Channel(current, 1e-3)) == []


def test_a_controllers_kicks_are_no_spikes() -> None:
    # the derivative action of a controller on encoder counts
    rng = np.random.default_rng(0)
    current = movement(time_stamps(), 0)[1][:, 0] + 3.0 * (rng.random(COUNT) < 0.02)
    assert find(Channel(current, 1 / RATE)) == []


def test_a_joint_may_turn_many_times_where_its_range_says_so_or_it_turns_alone() -> None:
    time = np.arange(0.0, 10.0, 1e-3)
    turning = 8.0 * time + 0.3 * np.sin(3 * time)
    assert find(Channel(turning, 1e-3, JointFacts("w", "hinge", None, None, 0.0, in_loop=False))) == []
    fast = 80.0 * np.sin(time)
    assert find(Channel(fast, 1e-3, JointFacts("w", "hinge", -100.0, 100.0, 0.0, in_loop=False))) == []


@pytest.mark.parametrize("jitter", [1e-6, 1e-3, 0.02, 0.12])
def test_jitter_of_the_sampling_is_accepted_and_undone(jitter: float, tmp_path: Path) -> None:
    folder = write_good_dataset(tmp_path)
    ideal = time_stamps()
    stamps = ideal + jitter / RATE * np.random.default_rng(0).uniform(-1, 1, COUNT)
    position, current = movement(stamps)
    noise = 1e-3 * np.random.default_rng(1).standard_normal((COUNT, 3))
    write_recording(folder / CSV, stamps, position, current + noise, JOINTS)
    recording = load_dataset(folder).recordings[0]
    steps = np.diff(recording.time)
    assert np.abs(steps * RATE - 1).max() < 3e-3
    # what is read agrees with the movement at the instants that are read, far better than the jitter moves it
    inner = slice(20, -20)
    wrong = np.abs(recording.position - movement(recording.time)[0])[inner].max()
    assert wrong < 1e-2 * np.abs(np.gradient(position, ideal, axis=0)).max() / RATE * max(jitter, 1e-3)


@pytest.mark.parametrize("encoder", [0.0, 2 * np.pi / 2**20])
def test_stamps_that_were_written_down_late_do_not_move_the_samples(encoder: float, tmp_path: Path) -> None:
    folder = write_good_dataset(tmp_path)
    position, current = movement(time_stamps())
    if encoder:
        position = np.round(position / encoder) * encoder
    stamps = time_stamps() + 0.1 / RATE * np.random.default_rng(0).uniform(-1, 1, COUNT)
    write_recording(folder / CSV, stamps, position, current, JOINTS)
    recording = load_dataset(folder).recordings[0]
    assert np.array_equal(recording.position, position)
    assert np.array_equal(recording.current, current)
    assert np.ptp(np.diff(recording.time)) < 1e-12


def test_a_clock_that_drifts_is_believed(tmp_path: Path) -> None:
    folder = write_good_dataset(tmp_path)
    stamps = time_stamps() * (1 + 0.01 * time_stamps() / time_stamps()[-1])
    position, current = movement(stamps)
    write_recording(folder / CSV, stamps, position, current, JOINTS)
    recording = load_dataset(folder).recordings[0]
    assert np.abs(recording.position - movement(recording.time)[0])[20:-20].max() < 1e-6


def test_a_late_sample_is_no_gap(tmp_path: Path) -> None:
    folder = write_good_dataset(tmp_path)
    stamps = time_stamps()
    stamps[700] += 0.7 / RATE
    position, current = movement(stamps)
    write_recording(folder / CSV, stamps, position, current, JOINTS)
    recording = load_dataset(folder).recordings[0]
    assert np.abs(recording.position - movement(recording.time)[0])[20:-20].max() < 1e-6


def test_csv_of_other_countries_and_editors(tmp_path: Path) -> None:
    folder = write_good_dataset(tmp_path)
    expected = load_dataset(folder).recordings[0]
    original = (folder / CSV).read_text()
    header, _, body = original.partition("\n")
    variants = {
        "semicolons and decimal commas": header.replace(",", ";")
        + "\n"
        + body.replace(",", ";").replace(".", ","),
        "byte order mark": "\ufeff" + original,
        "semicolons": original.replace(",", ";"),
        "tabs": original.replace(",", "\t"),
        "line ends of Windows": original.replace("\n", "\r\n"),
        "line ends of old": original.replace("\n", "\r"),
        "spaces": original.replace(",", " , "),
        "no line end": original.rstrip("\n"),
        "blank lines": "\n" + original.replace("\n", "\n\n"),
        "quoted header": original.replace("position.arm", '"position.arm"'),
    }
    for name, text in variants.items():
        (folder / CSV).write_bytes(text.encode())
        recording = load_dataset(folder).recordings[0]
        assert np.array_equal(recording.position, expected.position), name
        assert np.array_equal(recording.current, expected.current), name


def test_a_plus_sign_and_a_time_that_starts_late_are_fine(tmp_path: Path) -> None:
    folder = write_good_dataset(tmp_path)
    write_recording(folder / CSV, time_stamps() + 1.7e9, *movement(time_stamps()), JOINTS)

    def sign(lines: list[str]) -> None:
        lines[1:] = [
            ",".join(c if c.startswith("-") else "+" + c for c in line.split(",")) for line in lines[1:]
        ]

    edit_lines(folder / CSV, sign)
    recording = load_dataset(folder).recordings[0]
    assert recording.time[0] == 1.7e9
    assert np.array_equal(recording.position, movement(time_stamps())[0])


def test_what_the_user_has_looked_at_is_accepted(tmp_path: Path) -> None:
    folder = write_good_dataset(tmp_path)
    position, current = movement(time_stamps())
    current[:, 0] = np.clip(current[:, 0], -0.5, 0.5)
    write_recording(folder / CSV, time_stamps(), position, current, JOINTS)
    edit(folder / "dataset.toml", 'use = "identify"', 'use = "identify"\naccept = ["saturated"]')
    assert np.array_equal(load_dataset(folder).recordings[0].current, current)


def test_radians_that_were_taken_for_degrees_are_seen_by_the_home_position():
    bent = JointFacts("hip", "hinge", None, None, 2.2, in_loop=True)
    motion = bent.home + profile("quintic", np.arange(0.0, 4.0, 1e-3), 1.0, 0.2, 0.4)
    assert find(Channel(motion, 1e-3, bent)) == []
    assert find(Channel(0.05 * motion / motion.max() + 1.0, 1e-3, bent)) == []
    (fault,) = find(Channel(np.deg2rad(motion), 1e-3, bent))
    assert fault.check == "units"
    assert "looks 57.3 times too small for radians: at most 0.0454, home is 2.2" in fault.what
