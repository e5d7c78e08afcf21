"""The figures of the atlas are what its maker makes."""

import importlib.util
import json

import pytest


def test_a_page_of_the_atlas_is_drawn_as_it_is_kept(project_root, tmp_path, monkeypatch):
    spec = importlib.util.spec_from_file_location("draw", project_root / "docs" / "atlas" / "draw.py")
    draw = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(draw)
    monkeypatch.setattr(draw, "OUT", tmp_path)
    draw.main(["viscous_friction"])
    (now,) = json.loads((tmp_path / "effects.json").read_text())["effects"].values()
    kept = json.loads((project_root / "results" / "atlas" / "effects.json").read_text())["effects"]
    then = kept["viscous_friction"]
    assert (now["hidden"], now["motor"]) == (then["hidden"], then["motor"])
    assert now["error"] == pytest.approx(then["error"], rel=0.05)
    assert now["gains_off"]["without"]["left"] == pytest.approx(then["gains_off"]["without"]["left"], rel=0.1)
    assert max(now["follows"], key=now["follows"].get) == "velocity"
    assert (tmp_path / "viscous_friction.png").read_bytes().startswith(b"\x89PNG")


def test_what_robots_can_show_is_known_of_every_effect_and_robot(project_root):
    from bench.dataset.catalogue import built_in_robots, built_in_scenarios
    from bench.effects import CATALOGUE

    robots = json.loads((project_root / "results" / "atlas" / "robots.json").read_text())["robots"]
    assert {*robots} == {*built_in_robots()} & {*built_in_scenarios()}
    assert {name for one in robots.values() for name in (*one["shows"], *one["absorbed"])} == {*CATALOGUE}
