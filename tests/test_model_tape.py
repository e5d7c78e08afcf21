"""Arithmetic replayed from a tape: the values that it has when it is worked out as it stands."""

import numpy as np
import pytest

from bench.model.bounds import MEMORY
from bench.model.closing import Direct, Replayed, closing_of, closing_tape
from bench.model.closure import closures_of
from bench.model.geometry import read_geometry
from bench.model.motion import rates_at
from bench.model.regressor import body_columns, projected_regressor, rotor_columns
from bench.model.scalars import Reused, Tape, dense, dot, minus_product, plus, times
from bench.model.states import random_motion
from tests.mechanisms import NAMES, robot_named

ROUNDING = {"rtol": 1e-11, "atol": 1e-13}  # sines may be rounded otherwise in other places of an array


@pytest.fixture(params=NAMES)
def geometry(request, tmp_path):
    return read_geometry(robot_named(request.param, tmp_path))


def test_stages_are_replayed_bit_by_bit_and_again_with_other_inputs():
    def first(x, y):
        return [minus_product(times(x, y), 3.0, y), plus(times(x, 0.1), 0.2), 1.0 / y, times(x, 0.0)]

    def second(x, y, z):
        return [dot([x, y, z], [z, 2.0, y]), -0.0 * x, np.copysign(np.sqrt(z * z), y)]

    tape = Tape()
    x, y = tape.inputs(2)
    kept = first(x, y)
    tape.end_stage(kept)
    (z,) = tape.inputs(1)
    tape.end_stage(second(kept[0], y, z))
    replay = tape.program().replay(5)
    random = np.random.default_rng(0)
    for _ in range(2):
        a, b, c = random.normal(size=(3, 5))
        direct = first(a, b)
        np.testing.assert_array_equal(replay.run(0, [a, b]), dense(direct, 5))
        np.testing.assert_array_equal(replay.run(1, [c]), dense(second(direct[0], b, c), 5))


def test_minus_zero_is_told_from_zero():
    tape = Tape()
    (x,) = tape.inputs(1)
    tape.end_stage([np.copysign(x, 0.0), np.copysign(x, -0.0)])
    found = tape.program().replay(2).run(0, [np.array([2.0, -3.0])])
    np.testing.assert_array_equal(found, [[2.0, 3.0], [-2.0, -3.0]])


def test_what_is_decided_by_values_cannot_be_recorded():
    (x,) = Tape().inputs(1)
    with pytest.raises(TypeError):
        np.maximum(x, 0.0)
    with pytest.raises(TypeError):
        bool(x > 0.0)
    with pytest.raises(TypeError):
        bool(x)


def test_inputs_are_as_many_as_were_recorded():
    tape = Tape()
    tape.end_stage(tape.inputs(2))
    with pytest.raises(ValueError, match="zip"):
        tape.program().replay(3).run(0, np.zeros((1, 3)))


def test_closing_replayed_is_closing_worked_out(geometry):
    motion = random_motion(geometry, 9, seed=5)
    q = motion.q.T + 1e-4 * np.random.default_rng(1).normal(size=motion.q.T.shape)
    velocity, acceleration = motion.v[:, geometry.active], motion.a[:, geometry.active]
    found = []
    for closing in (Direct(closures_of(geometry)), Replayed(closing_tape(geometry), 9)):
        closing.correct(motion.q.T)
        residual, correction = closing.correct(q)
        amplification = closing.amplify()
        v, a = closing.rates(velocity, acceleration)
        found.append(
            (
                dense(residual, 9),
                *(dense([column[k] for k in sorted(column)], 9) for column in (correction, *amplification)),
                dense(v, 9),
                dense(a, 9),
                [sorted(column) for column in (correction, *amplification)],
            )
        )
    *direct, columns = found[0]
    *replayed, again = found[1]
    assert columns == again
    for ours, theirs in zip(replayed, direct, strict=True):
        np.testing.assert_allclose(ours, theirs, **ROUNDING)


def test_motion_and_regressor_stay_what_they_are_once_they_are_replayed(geometry):
    motion = random_motion(geometry, 7, seed=2)
    columns = np.concatenate((body_columns(geometry)[3::4], rotor_columns(geometry)))
    again = motion
    for _ in range(MEMORY.tape_uses + 2):
        again = rates_at(
            geometry, motion.time, motion.q, motion.v[:, geometry.active], motion.a[:, geometry.active]
        )
        found = projected_regressor(geometry, again, columns)
    assert isinstance(closing_of(geometry, 7), Replayed)
    assert isinstance(closing_of(geometry, MEMORY.tape_samples + 1), Direct)
    for name in ("q", "v", "a", "jacobian"):
        np.testing.assert_allclose(getattr(again, name), getattr(motion, name), rtol=1e-9, atol=1e-10)
    pieces = [projected_regressor(geometry, again.at(slice(k, k + 1)), columns) for k in range(7)]
    np.testing.assert_allclose(found, np.concatenate(pieces), **ROUNDING)


def test_a_tape_is_recorded_once_and_only_for_what_comes_again():
    made = []
    reused = Reused()
    assert reused.get(1, lambda: made.append(1)) is None
    assert reused.get(MEMORY.tape_samples + 1, lambda: made.append(1)) is None
    got = [reused.get(50, lambda: made.append(1) or "tape") for _ in range(MEMORY.tape_uses + 3)]
    assert got == [None] * MEMORY.tape_uses + ["tape"] * 3
    assert made == [1]
