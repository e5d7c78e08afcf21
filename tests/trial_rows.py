"""Rows of a trial, written by hand."""

import json

from bench.studies.sweep.journal import cell_of, names_in

INTERVAL = '[{"effect": "viscous_friction", "parameter": "Fv", "truth": 1.0, "value": 1.1, "std": %s}]'


def trial_row(kind, hidden, missing, **more):
    """A case that was diagnosed; exact where what is missing is what was hidden."""
    exact = missing == hidden
    row = {
        "run": 0,
        "status": "ok",
        "reason": None,
        "kind": kind,
        "hidden": hidden,
        "missing": missing,
        "joints": cell_of("motor" for _ in names_in(hidden)),
        "verdicts": json.dumps([{"effect": name, "actuators": ["motor"]} for name in names_in(missing)]),
        "absorbed": False,
        "unexplained": False,
        "first": exact,
        "first_undecided": exact,
        "exact": exact,
        "exact_undecided": exact,
        "wrong": "" if exact else missing,
        "least_own_error_over_floor": 5.0,
        "intervals": "[]",
        "commit": "0123456789ab",
        "version.numpy": "2.0",
    }
    for name in ("before", "after", "told"):
        row |= {f"gain_error.{name}": 1e-3, f"error_over_floor.{name}": 1.0}
    return row | more


def trial_rows():
    """Ten cases: found, missed, small, absorbed, false alarms, outside the catalogue, failed."""
    return [
        trial_row("one", "viscous_friction", "viscous_friction", intervals=INTERVAL % 0.1),
        trial_row("one", "viscous_friction", "viscous_friction", intervals=INTERVAL % 0.01),
        trial_row("one", "viscous_friction", "base_tilt"),
        trial_row("one", "viscous_friction", "", least_own_error_over_floor=1.2),
        trial_row("one", "rotor_inertia", "", absorbed=True),
        trial_row("nothing", "", ""),
        trial_row("nothing", "", "", unexplained=True),
        trial_row("outside", "torque_drift", "", unexplained=True),
        trial_row("outside", "torque_drift", "viscous_friction", unexplained=True),
        {**trial_row("two", "", ""), "status": "failed", "reason": "lost"},
    ]
