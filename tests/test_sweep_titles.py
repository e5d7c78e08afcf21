"""Metrics and axes of sweeps in words."""

from types import SimpleNamespace

import pytest

from bench.studies.sweep import accuracy, work
from bench.studies.sweep.charts import metric_axis
from bench.studies.sweep.metrics import (
    METRICS,
    Metric,
    axis_title,
    axis_words,
    is_relative,
    is_share,
    metric_title,
    what_is_measured,
)


def test_a_metric_is_told_from_its_one_line():
    for name, metric in METRICS.items():
        assert what_is_measured(f"{name}.anything") == metric.measures
        assert not metric.share or metric.relative
    assert is_share("gain_within.left")
    assert is_relative("error.validate")
    assert what_is_measured("seed") == "seed"
    assert not is_share("seed")


def test_a_metric_has_one_place(monkeypatch):
    """One more line in the table, and it is measured, titled and told with its unit."""
    line = Metric(
        "unknowns of the fit", title="number of unknowns", unit="1", value=lambda run: run.result.unknowns
    )
    monkeypatch.setitem(METRICS, "unknowns", line)
    monkeypatch.setattr(accuracy, "accuracy", lambda *_: {"gain_within.arm": 1.0, "gain_error.arm": 0.0})
    settings = SimpleNamespace(position_cutoff=100.0, decimation=4)
    result = SimpleNamespace(drive_gains={"arm": None}, settings=settings, unknowns=7)
    found = work.measure(None, None, result, ("accuracy",))
    assert (found["unknowns"], found["decimation"], found["position_cutoff"]) == (7, 4.0, 100.0)
    assert metric_axis("unknowns").title == "Number of unknowns [1]"
    assert what_is_measured("unknowns") == "unknowns of the fit"


@pytest.mark.parametrize(
    ("axis", "title", "words"),
    [
        ("payloads.disc.mass", "mass of payload disc [kg]", "mass of payload disc"),
        ("hidden.coulomb_friction.Fc", "Fc of hidden Coulomb friction", "Fc of hidden Coulomb friction"),
        ("sensors.encoder_bits", "encoder bits", "encoder bits"),
        ("my_own", "my own", "my own"),
    ],
)
def test_an_axis_is_said_by_what_it_is(axis, title, words):
    assert (axis_title(axis), axis_words(axis)) == (title, words)


def test_what_a_metric_is_of_stands_behind_it():
    assert metric_title("gain_error") == "largest gain error"
    assert metric_title("error.validate") == "error of the current, not fitted"
