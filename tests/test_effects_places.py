"""How many places an effect touches, and that code which is for all of them names none."""

import re
from pathlib import Path

import numpy as np
import pytest

from bench.effects import CATALOGUE, ActuatorEffect
from bench.truth.hidden import HIDDEN_EFFECTS
from tests.effects_kit import joint_signals

MADE = {"bench/effects/README.md", "scenarios/README.md"}  # python docs/made/readme_tables.py
OF_THEIR_OWN = {  # what a few effects have and most do without, each with its reason
    "bench/benchmarks/measured/sentences.py": "what an effect does, in a clause about a machine",
    "bench/diagnosis/discovery/grammar.py": "the names of laws that a search finds",
    "bench/export/c_code.py": "what a law is in C",
    "bench/export/placed.py": "what a joint of MuJoCo holds",
    "bench/studies/trial/compatible.py": "two names for the same part",
    "bench/studies/trial/intervals.py": "parameters with another name in the model",
    "bench/studies/trial/unknown.py": "what is hidden beside an unknown law",
    "bench/truth/hidden/sizes.py": "sizes that no parameter is in proportion to",
}
FIGURES = (
    "bench/benchmarks/speed/",
    "bench/benchmarks/peers/",
    "bench/benchmarks/measured/known.toml",
    "scenarios/",
)  # machines that have some of them


def files_with(name: str, root: Path) -> set[str]:
    """Files of the package and its scenarios in which an effect's name stands as a word of the program."""
    word = re.compile(rf'["\'`]{name}["\'`:]')
    found = (path for place in ("bench", "scenarios") for path in (root / place).rglob("*.*"))
    texts = (path for path in found if path.suffix in (".py", ".toml", ".md", ".js"))
    return {
        path.relative_to(root).as_posix() for path in texts if word.search(path.read_text(encoding="utf-8"))
    }


@pytest.mark.parametrize("name", ["tool_drag"])
def test_an_effect_that_needs_no_rule_of_its_own_has_two_places_and_its_tests(
    name: str, project_root: Path
) -> None:
    own = {f"bench/effects/laws/{name}.py", f"bench/truth/hidden/laws/{name}.py"}
    assert files_with(name, project_root) == own | MADE


@pytest.mark.parametrize("name", CATALOGUE)
def test_code_for_all_effects_names_none(name: str, project_root: Path) -> None:
    elsewhere = {
        file
        for file in files_with(name, project_root) - MADE - OF_THEIR_OWN.keys()
        if not file.startswith((*FIGURES, "bench/effects/laws/", "bench/truth/hidden/"))
    }
    assert elsewhere == set()


def test_every_exception_is_one(project_root: Path) -> None:
    named = set().union(*(files_with(name, project_root) for name in CATALOGUE))
    assert OF_THEIR_OWN.keys() <= named


def test_the_key_of_the_atlas_has_words_for_every_look() -> None:
    for name, effect in CATALOGUE.items():
        assert len(effect.in_key) == len(effect.seen) > 0, name
        assert any(effect.in_key), name


@pytest.mark.parametrize("name", [name for name, one in CATALOGUE.items() if one.of_velocity])
def test_what_is_said_to_go_by_the_velocity_alone_does(name: str) -> None:
    effect, joint = CATALOGUE[name], joint_signals()
    assert isinstance(effect, ActuatorEffect)
    turned = type(joint)(**{**vars(joint), "velocity": -joint.velocity, "position": 2.0 * joint.position})
    np.testing.assert_allclose(effect.torque(turned), -effect.torque(joint), rtol=1e-12)


def test_every_hidden_effect_that_a_diagnosis_may_name_is_in_the_catalogue() -> None:
    assert {name for name, kind in HIDDEN_EFFECTS.items() if kind.in_catalogue} == set(CATALOGUE)
