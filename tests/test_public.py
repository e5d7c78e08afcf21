"""The public names of the package."""

import ast
import subprocess
import sys
from importlib.metadata import version
from pathlib import Path

import pytest

import bench
from tests.import_graph import modules_of


@pytest.mark.parametrize("name", bench.__all__)
def test_public_name_is_there_and_documented(name):
    assert getattr(bench, name).__doc__


def test_every_list_of_public_names_agrees():
    tree = ast.parse(Path(bench.__file__).read_text(encoding="utf-8"))
    typed = {
        alias.asname: node.module
        for node in ast.walk(tree)
        if isinstance(node, ast.ImportFrom) and node.module.startswith("bench.")
        for alias in node.names
    }
    assert typed == bench._HOME_OF
    assert bench.__all__ == sorted(bench._HOME_OF)
    assert dir(bench) == bench.__all__


def test_the_version_is_that_of_the_package():
    assert bench.__version__ == version("parabench")


def test_no_module_shadows_a_public_name(project_root):
    """Importing bench/identify.py would replace the function bench.identify."""
    modules = {name.split(".")[1] for name in modules_of(project_root / "bench") if "." in name}
    assert modules & set(bench.__all__) == set()


def test_unknown_name_is_an_attribute_error():
    with pytest.raises(AttributeError, match="no attribute 'nonsense'"):
        _ = bench.nonsense


def test_star_import_gives_the_public_names():
    program = "from bench import *; print(load_robot.__module__, BenchError.__module__)"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["bench.dataset.robot", "bench.basics.errors"]
