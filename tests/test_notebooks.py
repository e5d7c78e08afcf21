"""The notebooks of the documentation run from their first cell to their last."""

import importlib.util
import json
import math
import re

import pytest

NUMBER = re.compile(r"\d+(?:\.\d+)?")


def alike(now, then):
    """Whether two numbers are the same but for another rounding: to a fifth, or to their last digit."""
    last = 10.0 ** -len(then.partition(".")[2])
    return math.isclose(float(now), float(then), rel_tol=0.2, abs_tol=1.01 * last)


def run(project_root, name):
    """The names that a notebook leaves; what it prints is held to what is kept for its page."""
    docs = project_root / "docs"
    spec = importlib.util.spec_from_file_location("run_notebooks", docs / "made" / "run_notebooks.py")
    runner = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(runner)
    names, printed = runner.run(docs / "notebooks" / f"{name}.py")
    kept = json.loads(runner.OUTPUTS.read_text(encoding="utf-8"))[name]
    assert [NUMBER.sub("#", one).split() for one in printed] == [NUMBER.sub("#", one).split() for one in kept]
    for now, then in zip(printed, kept, strict=True):
        pairs = zip(NUMBER.findall(now), NUMBER.findall(then), strict=True)
        assert all(alike(a, b) for a, b in pairs), (now, then)
    return names


def test_a_first_look(project_root):
    names = run(project_root, "first_look")
    assert set(names["diagnosis"].missing) == {"coulomb_friction", "viscous_friction"}
    assert names["after"].value == pytest.approx(3.3, rel=0.002)
    assert 0.05 < names["before"].value / 3.3 - 1.0 < 0.08
    assert names["before"].std > 50.0 * names["after"].std
    assert len(names["gains"]) == 2


def test_an_effect_of_ones_own(project_root):
    names = run(project_root, "own_effect")
    assert names["found"].value == pytest.approx(0.015, rel=0.01)
    assert names["braked"].error.validate < 0.3 * names["plain"].error.validate
    assert names["ratio"] < 1.15
