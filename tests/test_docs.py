"""The site of the documentation: it builds without a warning, and asks no other machine for anything."""

import re
import subprocess
import sys

import pytest

ASKED = re.compile(
    r'<(?:script|img|iframe)[^>]*src="(https?:)?//|<link[^>]*rel="?stylesheet[^>]*href="(https?:)?//'
)


@pytest.fixture(scope="module")
def site(project_root, tmp_path_factory):
    folder = tmp_path_factory.mktemp("site")
    arguments = [
        "build",
        "--strict",
        "--quiet",
        "-f",
        str(project_root / "docs" / "mkdocs.yml"),
        "-d",
        str(folder),
    ]
    done = subprocess.run(
        [sys.executable, "-W", "ignore", "-m", "properdocs", *arguments],
        capture_output=True,
        text=True,
        check=False,
        cwd=project_root,
    )
    assert done.returncode == 0, done.stderr
    return folder


def test_every_effect_has_its_page(site):
    from bench.effects import CATALOGUE

    assert {path.stem for path in (site / "atlas").glob("*.html")} == {*CATALOGUE, "index"}


def test_a_page_asks_nobody_for_anything(site):
    foreign = {path.name: ASKED.findall(path.read_text(encoding="utf-8")) for path in site.rglob("*.html")}
    assert {name: found for name, found in foreign.items() if found} == {}


def test_equations_are_drawn_by_the_browser_itself(site):
    start = (site / "index.html").read_text(encoding="utf-8")
    assert '<math xmlns="http://www.w3.org/1998/Math/MathML"' in start
    assert "arithmatex" not in start
