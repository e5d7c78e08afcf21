"""The project as a whole: pinned versions, what stands at the top level, how long a file is."""

import re
import subprocess
import tomllib

import pytest

PIN = re.compile(r"(?P<name>[A-Za-z0-9._-]+)==(?P<version>[A-Za-z0-9.!+]+)")
TOP_LEVEL = {
    *(".ci", ".gitignore", "CHANGELOG.md", "CONTRIBUTING.md", "LICENSE", "Makefile", "README.md"),
    *("bench", "pyproject.toml", "results", "robots", "scenarios", "tests"),
}
MOST_LINES = 400


def pins(lines):
    """Normalised name -> version; fails on a line that is more or less than an exact pin."""
    found = {}
    for line in lines:
        pin = PIN.fullmatch(line)
        assert pin, f"not an exact pin: {line!r}"
        found[re.sub(r"[-_.]+", "-", pin["name"]).lower()] = pin["version"]
    return found


@pytest.fixture(scope="module")
def project(project_root):
    return tomllib.loads((project_root / "pyproject.toml").read_text())


def test_every_dependency_is_pinned_and_the_constraints_agree(project, project_root):
    groups = project["project"]["optional-dependencies"].values()
    wanted = pins([*project["project"]["dependencies"], *(line for group in groups for line in group)])
    constraints = pins((project_root / ".ci" / "constraints.txt").read_text().splitlines())
    assert {name: constraints.get(name) for name in wanted} == wanted
    assert set(pins(project["build-system"]["requires"]).items()) <= set(constraints.items())


def test_top_level_holds_only_what_belongs_there(project_root):
    if not (project_root / ".git").exists():
        pytest.skip("not a git checkout")
    tracked = subprocess.run(
        ["git", "ls-files"], cwd=project_root, capture_output=True, text=True, check=True
    )
    assert {name.split("/")[0] for name in tracked.stdout.splitlines()} <= TOP_LEVEL


def test_a_file_has_one_idea(project_root):
    lengths = {
        p: len(p.read_text(encoding="utf-8").splitlines()) for p in (project_root / "bench").rglob("*.py")
    }
    assert [(str(path), lines) for path, lines in lengths.items() if lines > MOST_LINES] == []
