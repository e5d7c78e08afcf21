"""The notebooks of the documentation run from their first cell to their last."""

import pytest


def run(project_root, name):
    """The names that a notebook leaves."""
    path = project_root / "docs" / "notebooks" / f"{name}.py"
    names: dict[str, object] = {}
    exec(compile(path.read_text(encoding="utf-8"), str(path), "exec"), names)
    return names


def test_a_first_look(project_root, capsys):
    names = run(project_root, "first_look")
    assert set(names["diagnosis"].missing) == {"coulomb_friction", "viscous_friction"}
    assert names["after"].value == pytest.approx(3.3, rel=0.002)
    assert 0.05 < names["before"].value / 3.3 - 1.0 < 0.08
    assert names["before"].std > 50.0 * names["after"].std
    assert len(names["gains"]) == 2
    assert "the truth is 3.3" in capsys.readouterr().out


def test_an_effect_of_ones_own(project_root):
    names = run(project_root, "own_effect")
    assert names["found"].value == pytest.approx(0.015, rel=0.01)
    assert names["braked"].error.validate < 0.3 * names["plain"].error.validate
    assert names["ratio"] < 1.15
