"""Axes and settings of a sweep: what a user may write, and what is refused."""

import numpy as np
import pytest

from bench.basics.errors import BenchError
from bench.studies.sweep.axes import DrawnAxis, GridAxis, read_axes
from bench.studies.sweep.plan import flat_settings, with_setting


def values_of(axis):
    assert isinstance(axis, GridAxis)
    return [point.label for point in axis.points]


def one(value, name="sensors.current_noise_ratio"):
    (axis,) = read_axes({name: value}, "sweep.toml")
    return axis


@pytest.mark.parametrize(
    ("value", "expected"),
    [
        ([0.1, 0.2], [0.1, 0.2]),
        ({"values": ["ls", "wls"]}, ["ls", "wls"]),
        ({"from": 0, "to": 1, "count": 5}, [0, 0.25, 0.5, 0.75, 1.0]),
        ({"from": 12, "to": 20, "step": 4}, [12, 16, 20]),
        ({"from": 0.1, "to": 0.35, "step": 0.1}, [0.1, 0.2, 0.3]),
        ({"from": 1, "to": 0, "count": 3}, [1.0, 0.5, 0.0]),
        ({"from": 1e-3, "to": 10, "count": 5, "spacing": "log"}, [1e-3, 1e-2, 0.1, 1.0, 10.0]),
    ],
)
def test_values(value, expected):
    assert values_of(one(value)) == expected


def test_whole_numbers_stay_whole():
    assert [type(value) for value in values_of(one({"from": 12, "to": 14, "step": 1}))] == [int] * 3


def test_dotted_and_nested_names_are_the_same():
    nested = read_axes({"sensors": {"encoder_bits": [14, 16]}, "method": ["ls"]}, "")
    dotted = read_axes({"sensors.encoder_bits": [14, 16], "method": ["ls"]}, "")
    assert nested == dotted


def test_cases_are_settings_that_go_together():
    axis = one(
        {"cases": {"good": {"sensors": {"encoder_bits": 20}, "seed": 1}, "bad": {"sensors.encoder_bits": 10}}}
    )
    assert values_of(axis) == ["good", "bad"]
    assert axis.points[0].settings == {"sensors.encoder_bits": 20, "seed": 1}
    assert axis.paths == {"sensors.encoder_bits", "seed"}


@pytest.mark.parametrize(
    ("value", "told"),
    [
        (3.0, "should be a list"),
        ([], "at least one value"),
        ([1, 2, 1], "given twice"),
        ({"from": 0, "to": 1}, "either count or step"),
        ({"from": 0, "to": 1, "count": 3, "step": 0.5}, "either count or step"),
        ({"from": 0, "to": 1, "count": 3, "spacing": "log"}, "above 0"),
        ({"from": 1, "to": 0, "step": 0.5}, "end before it begins"),
        ({"from": 0, "to": float("inf"), "count": 3}, "finite"),
        ({"from": 0, "to": 1, "count": 1}, "count"),
        ({"from": 0, "to": 1, "cuont": 3}, "cuont"),
        ({"draw": "unifrom", "from": 0, "to": 1}, "unifrom"),
        ({"draw": "uniform", "from": 1, "to": 1}, "end above"),
        ({"draw": "log_uniform", "from": 0, "to": 1}, "above 0"),
        ({"draw": "normal", "mean": 0, "std": 0}, "std"),
        ({"draw": "choice", "values": []}, "values"),
        ({"cases": {}}, "cases"),
    ],
)
def test_mistakes_are_told_in_one_line_with_the_axis(value, told):
    with pytest.raises(BenchError) as caught:
        one(value)
    message = str(caught.value)
    assert "\n" not in message
    assert "sweep.toml: axes.sensors.current_noise_ratio: " in message
    assert told in message


@pytest.mark.parametrize(
    ("draw", "low", "high", "median"),
    [
        ({"draw": "uniform", "from": -1, "to": 3}, -1, 3, 1.0),
        ({"draw": "log_uniform", "from": 0.01, "to": 1}, 0.01, 1, 0.1),
        ({"draw": "normal", "mean": 2, "std": 0.1}, 1.5, 2.5, 2.0),
        ({"draw": "choice", "values": [1, 2, 3]}, 1, 3, 2.0),
    ],
)
def test_draws_follow_their_law_and_depend_on_seed_and_name_alone(draw, low, high, median):
    axis = one(draw)
    assert isinstance(axis, DrawnAxis)
    values = [axis.value(seed) for seed in range(800)]
    assert low <= min(values) <= max(values) <= high
    assert np.median(values) == pytest.approx(median, rel=0.15)
    assert [one(draw).value(seed) for seed in reversed(range(800))] == values[::-1]
    other = one(draw, "gains.error")
    assert [other.value(seed) for seed in range(800)] != values


CONTENT = {
    "gains": {"error": 0.1},
    "recordings": [{"name": "unloaded", "design": {"seed": 1}}, {"name": "loaded", "design": {"seed": 2}}],
    "hidden": [
        {"effect": "viscous_friction", "Fv": 0.1},
        {"effect": "coulomb_friction", "joint": "left"},
        {"effect": "coulomb_friction", "joint": "right"},
    ],
}


@pytest.mark.parametrize(
    ("path", "at"),
    [
        ("sensors.encoder_bits", lambda c: c["sensors"]["encoder_bits"]),
        ("recordings.loaded.design.seed", lambda c: c["recordings"][1]["design"]["seed"]),
        ("recordings.0.design.seed", lambda c: c["recordings"][0]["design"]["seed"]),
        ("hidden.viscous_friction.Fv", lambda c: c["hidden"][0]["Fv"]),
        ("hidden.2.Fc", lambda c: c["hidden"][2]["Fc"]),
        ("gains.error.left", lambda c: c["gains"]["error"]["left"]),
        ("gains.error", lambda c: c["gains"]["error"]),
    ],
)
def test_a_setting_is_changed_by_its_path_and_nothing_else(path, at):
    before = repr(CONTENT)
    changed = with_setting(CONTENT, path, 7)
    assert at(changed) == 7
    assert repr(CONTENT) == before
    assert dict(flat_settings(changed)).get(path.replace("recordings.0", "recordings.unloaded")) == 7


@pytest.mark.parametrize(
    "path", ["recordings.laoded.design.seed", "hidden.coulomb_friction.Fc", "hidden.3.Fc"]
)
def test_a_path_that_leads_nowhere_is_named(path):
    with pytest.raises(BenchError, match=rf"{path}: the list has no"):
        with_setting(CONTENT, path, 7)


def test_every_setting_has_one_cell():
    flat = dict(flat_settings({**CONTENT, "inertia": [1, 2], "effects": ["a", "b"], "none": []}))
    assert flat["inertia"] == "[1, 2]"
    assert flat["effects"] == "a + b"
    assert flat["none"] == "none"
    assert flat["hidden.1.joint"] == "left"
    assert all(value is None or isinstance(value, bool | int | float | str) for value in flat.values())
