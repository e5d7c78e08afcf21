"""Settings that must stand before numpy and rerun are imported, and folders that several tests need."""

import gc
import os
import shutil
from collections.abc import Generator
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from tests.made_once import made_once

if TYPE_CHECKING:
    from bench.identification.prepare import Prepared
    from bench.truth.simulate import Simulation

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # two workers on two cores
os.environ.setdefault("MPLBACKEND", "Agg")
os.environ.setdefault("RERUN_STRICT", "1")  # errors in what is logged are raised


@pytest.hookimpl(wrapper=True)
def pytest_collection() -> Generator[None, object, object]:
    """Nothing is garbage while tests are collected, nor afterwards of what that leaves: a third of the time.

    Afterwards it is looked for more seldom, since what tests share is much and stays.
    """
    gc.disable()
    try:
        return (yield)
    finally:
        gc.freeze()
        gc.set_threshold(20_000, 20, 50)
        gc.enable()


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport() -> Generator[None, pytest.TestReport, pytest.TestReport]:
    """In CI, which installs what the tests need, only measured data may be lacking."""
    report = yield
    if os.environ.get("CI") == "true" and report.skipped and not hasattr(report, "wasxfail"):
        reason = report.longrepr[2] if isinstance(report.longrepr, tuple) else str(report.longrepr)
        if "measured" not in reason:
            report.outcome, report.longrepr = "failed", f"not to be skipped in CI: {reason}"
    return report


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """What takes long comes first, so that no worker is left alone with it at the end."""
    items.sort(key=lambda item: item.get_closest_marker("slow") is None)


@pytest.fixture(scope="session", autouse=True)
def blank_pictures() -> Generator[pytest.MonkeyPatch, None, None]:
    """Pictures that a command writes beside what a test is about are put together, but stay blank files.

    Drawing them takes a tenth of all tests' time. In files marked `pictures` they are drawn.
    """
    from matplotlib.figure import Figure

    draw = Figure.savefig

    def blank(_: Figure, path: object, **options: object) -> None:
        draw(Figure(figsize=(1.0, 1.0)), path, **options)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Figure, "savefig", blank)
        yield patch


@pytest.fixture(scope="module", autouse=True)
def pictures(
    request: pytest.FixtureRequest, blank_pictures: pytest.MonkeyPatch
) -> Generator[None, None, None]:
    """In files marked `pictures` they are drawn."""
    from matplotlib.figure import Figure

    if request.node.get_closest_marker("pictures") is None:
        yield
        return
    blank = Figure.savefig
    blank_pictures.undo()
    yield
    blank_pictures.setattr(Figure, "savefig", blank)


@pytest.fixture(scope="session")
def project_root() -> Path:
    """The checkout: the folder of pyproject.toml."""
    return Path(__file__).resolve().parent.parent


@pytest.fixture(scope="session")
def measured_data(project_root: Path) -> Path:
    """Folder of measured data sets, too large or not ours to carry along; skips where it is absent."""
    folder = Path(os.environ.get("PARABENCH_DATA", project_root.parent / "shared" / "data"))
    if not folder.is_dir():
        pytest.skip(f"no measured data: set PARABENCH_DATA (looked in {folder})")
    return folder


@pytest.fixture(scope="session")
def five_bar_simulation() -> "Simulation":
    """The scenario `five_bar` as it comes along but for a larger step, with nothing hidden; never changed."""
    from bench.excitation.scenario import designer
    from bench.scenario.scenario import load_scenario, resolve_trajectories
    from bench.truth.simulate import simulate

    scenario = load_scenario("five_bar", {"step": 0.0005})
    return simulate(scenario, resolve_trajectories(scenario, designer))


@pytest.fixture(scope="session")
def five_bar_equations(five_bar_simulation: "Simulation") -> "Prepared":
    """Of its recordings, with no effects; never changed."""
    from bench.identification.prepare import prepare
    from bench.identification.problem import problem_of
    from bench.truth.dataset import as_dataset

    return prepare(problem_of(as_dataset(five_bar_simulation)))


@pytest.fixture(scope="session")
def arm(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with measurements, in `data`, of an arm with friction at one joint; they are never changed."""
    return made_once(tmp_path_factory, "arm", _measured_arm)


def _measured_arm(folder: Path) -> None:
    from bench.truth.dataset import write_simulation
    from tests.hidden_kit import run

    hidden = {"effect": "viscous_friction", "joint": "shoulder", "Fv": 1.5}
    design = {"optimise": False, "duration": 10.0, "ramp": 0.5}
    write_simulation(run("two_link", hidden, design=design), folder / "data")


@pytest.fixture(scope="session")
def diagnosed_arm(arm: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The same, with all that `bench diagnose` writes about the arm: answer.json, model.json, `found`."""

    def make(folder: Path) -> None:
        from bench.cli import main

        shutil.copytree(arm, folder, dirs_exist_ok=True)
        files = ["--json", str(folder / "answer.json"), "--apply", str(folder / "model.json")]
        assert main(["diagnose", str(folder / "data"), *files, "-o", str(folder / "found")]) == 0

    return made_once(tmp_path_factory, "diagnosed_arm", make)


@pytest.fixture(scope="session")
def chromium():
    """A browser without a window; skips where there is none."""
    from docs.pictures.browser import browser, browser_program

    if browser_program() is None:
        pytest.skip("no Chromium on this machine (Debian: apt-get install chromium)")
    with browser() as launched:
        yield launched
