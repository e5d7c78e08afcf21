"""An installed wheel works from any folder: robots and scenarios travel inside it."""

import os
import subprocess
import sys
import tarfile
import zipfile

import pytest

from bench import __version__


@pytest.fixture(scope="module")
def wheel(project_root, tmp_path_factory):
    folder = tmp_path_factory.mktemp("wheel")
    subprocess.run(
        [sys.executable, "-m", "hatchling", "build", "--target", "wheel", "--directory", str(folder)],
        cwd=project_root,
        check=True,
        capture_output=True,
    )
    (built,) = folder.glob("parabench-*.whl")
    return built


def tracked(project_root, *folders):
    done = subprocess.run(
        ["git", "ls-files", *folders], cwd=project_root, capture_output=True, text=True, check=True
    )
    return done.stdout.split()


def test_wheel_holds_every_tracked_file_of_package_robots_and_scenarios(wheel, project_root):
    if not (project_root / ".git").exists():
        pytest.skip("not a git checkout: nothing to compare with")
    inside = set(zipfile.ZipFile(wheel).namelist())
    assert [name for name in tracked(project_root, "bench") if name not in inside] == []
    catalogue = tracked(project_root, "robots", "scenarios")
    assert [name for name in catalogue if f"bench/_catalogue/{name}" not in inside] == []


def test_installed_wheel_loads_a_robot_from_another_folder(wheel, project_root, tmp_path):
    site = tmp_path / "site"
    install = [sys.executable, "-m", "pip", "install", "--quiet", "--no-deps", "--no-index", "--target"]
    subprocess.run([*install, str(site), str(wheel)], check=True)
    program = """
import bench
from bench.dataset.catalogue import built_in_robots, built_in_scenarios
print(bench.__file__)
print(*built_in_robots())
print(*built_in_scenarios())
for name in built_in_robots():
    print(bench.load_robot(name).model_path)
"""
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    done = subprocess.run(
        [sys.executable, "-c", program],
        cwd=elsewhere,
        env={**os.environ, "PYTHONPATH": str(site)},
        capture_output=True,
        text=True,
        check=True,
    )
    package, robots, scenarios, *models = done.stdout.splitlines()
    assert package == str(site / "bench" / "__init__.py")
    assert robots.split() == sorted(
        path.parent.name for path in (project_root / "robots").glob("*/robot.toml")
    )
    assert scenarios.split() == sorted(path.stem for path in (project_root / "scenarios").glob("*.toml"))
    assert robots, "the catalogue is empty"
    assert all(path.startswith(str(site / "bench" / "_catalogue")) for path in models)
    for command in ("bench", "parabench"):  # another package installs a `bench`, too
        done = subprocess.run(
            [sys.executable, str(site / "bin" / command), "--version"],
            cwd=elsewhere,
            env={**os.environ, "PYTHONPATH": str(site)},
            capture_output=True,
            text=True,
            check=True,
        )
        assert __version__ in done.stdout


def test_what_is_published_as_source_builds_the_same_wheel(wheel, project_root, tmp_path):
    build = [sys.executable, "-m", "hatchling", "build", "--directory", str(tmp_path), "--target"]
    subprocess.run([*build, "sdist"], cwd=project_root, check=True, capture_output=True)
    (packed,) = tmp_path.glob("parabench-*.tar.gz")
    with tarfile.open(packed) as archive:
        archive.extractall(tmp_path, filter="data")
    folder = tmp_path / packed.name.removesuffix(".tar.gz")
    subprocess.run([*build, "wheel"], cwd=folder, check=True, capture_output=True)
    (again,) = tmp_path.glob("parabench-*.whl")
    assert zipfile.ZipFile(again).namelist() == zipfile.ZipFile(wheel).namelist()
