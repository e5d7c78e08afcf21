"""Metrics and axes of sweeps in words."""

import pytest

from bench.studies.sweep.measure import METRICS
from bench.studies.sweep.titles import METRIC_TITLES, RELATIVE, axis_title, axis_words, metric_title


def test_titles_are_of_metrics_that_there_are():
    assert {*METRIC_TITLES, *RELATIVE} <= set(METRICS)


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
    assert metric_title("error.validate") == "error of the current, validate"
