"""A spring that the MJCF has in a joint without a motor: simulated, told by the check, and fitted."""

import re
from pathlib import Path

import pytest

from bench.dataset.catalogue import built_in_robots
from bench.dataset.robot import load_robot
from bench.effects import CATALOGUE, EffectInstance, catalogue_for, effect_columns
from bench.excitation.scenario import designer
from bench.identification.identify import identify
from bench.identification.prepare import prepare
from bench.identification.problem import problem_of
from bench.identification.result import Identification
from bench.robot_check.check import check_robot
from bench.robot_check.words import detail_of
from bench.scenario.scenario import load_scenario, resolve_trajectories
from bench.truth.dataset import as_dataset
from bench.truth.simulate import simulate
from tests.effects_kit import moving_robot
from tests.hidden_kit import STEP

STIFFNESS, RELAXED = 1.5, 0.4


@pytest.fixture(scope="module")
def sprung(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The built-in five-bar with a spring at its left elbow."""
    folder = tmp_path_factory.mktemp("sprung")
    source = built_in_robots()["five_bar"]
    text = (source / "five_bar.xml").read_text(encoding="utf-8")
    spring = f'stiffness="{STIFFNESS}" springref="{RELAXED}"'
    changed = text.replace('<joint name="left_elbow"/>', f'<joint name="left_elbow" {spring}/>')
    assert changed != text
    (folder / "five_bar.xml").write_text(changed, encoding="utf-8")
    (folder / "robot.toml").write_text((source / "robot.toml").read_text(encoding="utf-8"), encoding="utf-8")
    return folder


@pytest.fixture(scope="module")
def found(sprung: Path) -> Identification:
    """Measurements of it, identified with the spring as an effect."""
    scenario = load_scenario("five_bar", {"robot": str(sprung), "step": STEP})
    dataset = as_dataset(simulate(scenario, resolve_trajectories(scenario, designer)))
    return identify(prepare(problem_of(dataset, ["passive_spring:left_elbow"])))


def test_the_check_tells_how_to_fit_it(sprung: Path) -> None:
    notes = [detail_of(check) for check in check_robot(load_robot(sprung)).checks if check.verdict == "note"]
    assert any("--with passive_spring:left_elbow" in note for note in notes)


def test_its_stiffness_is_found(found: Identification) -> None:
    spring = found.effect_parameters["passive_spring"]["left_elbow"]
    assert spring["k"].unit == "N*m/rad"
    assert spring["k"].value == pytest.approx(STIFFNESS, rel=0.02)
    assert spring["kq0"].value == pytest.approx(STIFFNESS * RELAXED, abs=0.03 * STIFFNESS)
    assert found.drive_gains["left"].value == pytest.approx(3.3, rel=0.003)


def test_the_readme_s_spring_of_one_s_own_is_a_law_in_that_joint(project_root: Path, tmp_path: Path) -> None:
    text = (project_root / "bench" / "effects" / "README.md").read_text(encoding="utf-8")
    (source,) = re.findall(r"```python\n(.*?)```", text, re.DOTALL)
    (tmp_path / "hardening_spring.py").write_text(source, encoding="utf-8")
    effect = catalogue_for((tmp_path / "hardening_spring.py",))["hardening_spring"]
    robot, *_ = moving_robot("five_bar", tmp_path, samples=201)
    columns = effect_columns(EffectInstance(effect, "left_elbow", effect.name), robot)
    linear = effect_columns(EffectInstance(CATALOGUE["passive_spring"], "left_elbow", ""), robot)
    carried = -linear[:, :, 1]  # what the motors feel of 1 N*m there
    position = linear[:, :, 0] / carried
    assert columns[:, :, 0] == pytest.approx(carried * position**3)
