"""The project as a whole: versions, what stands at the top level, how long a file is."""

import re
import subprocess
import tomllib

import pytest
import yaml
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

PIN = re.compile(r"(?P<name>[A-Za-z0-9._-]+)==(?P<version>[A-Za-z0-9.!+]+)")
TOP_LEVEL = {
    *(".ci", ".gitignore", "CHANGELOG.md", "CITATION.cff", "CONTRIBUTING.md", "LICENSE", "Makefile"),
    *("README.md", "bench", "docs", "pyproject.toml", "results", "robots", "scenarios", "tests"),
}
MOST_LINES = 400


def pins(lines):
    """Normalised name -> version; fails on a line that is more or less than an exact pin."""
    found = {}
    for line in lines:
        pin = PIN.fullmatch(line)
        assert pin, f"not an exact pin: {line!r}"
        found[canonicalize_name(pin["name"])] = pin["version"]
    return found


@pytest.fixture(scope="module")
def project(project_root):
    return tomllib.loads((project_root / "pyproject.toml").read_text())


def test_dependencies_are_ranges_and_the_constraints_lie_in_them(project, project_root):
    groups = project["project"]["optional-dependencies"].values()
    wanted = [*project["project"]["dependencies"], *(line for group in groups for line in group)]
    constraints = pins((project_root / ".ci" / "constraints.txt").read_text().splitlines())
    for line in (*wanted, *project["build-system"]["requires"]):
        asked = Requirement(line)
        if asked.name == project["project"]["name"]:  # one group of extras that takes in another
            continue
        operators = {one.operator for one in asked.specifier}
        assert ">=" in operators, f"no lower end: {line!r}"
        assert "==" not in operators, f"nobody can install it beside anything else: {line!r}"
        assert constraints[canonicalize_name(asked.name)] in asked.specifier, line


def test_one_version_in_package_citation_and_changelog(project, project_root):
    citation = yaml.safe_load((project_root / "CITATION.cff").read_text(encoding="utf-8"))
    version = project["project"]["version"]
    assert str(citation["version"]) == version
    released = f"## {version} ({citation['date-released']})"
    assert released in (project_root / "CHANGELOG.md").read_text(encoding="utf-8").splitlines()


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
