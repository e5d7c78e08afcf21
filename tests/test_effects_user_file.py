"""A user's own effects: from the documented ten lines to an identification, and every mistake named."""

import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from bench import cli
from bench.basics.errors import BenchError
from bench.dataset.dataset import Dataset, load_dataset
from bench.effects import CATALOGUE, catalogue_for, load_effects
from bench.identification.identify import identify
from bench.identification.model_file import load_model
from bench.identification.prepare import prepare
from bench.identification.problem import problem_of
from bench.truth.dataset import as_dataset, write_simulation
from bench.truth.simulate import Simulation

HEAD = """
import numpy as np
from dataclasses import dataclass
from bench.effects import ActuatorEffect, Effect, EffectParameter, ShapeParameter
"""
GOOD = """
@dataclass(frozen=True)
class Mine(ActuatorEffect):
    name = "mine"
    parameters = (EffectParameter("c", "{effort}"),)
    def torque(self, joint):
        return TORQUE
"""


@pytest.fixture(scope="module")
def dataset(five_bar_simulation: Simulation) -> Dataset:
    return as_dataset(five_bar_simulation)


@pytest.fixture(scope="module")
def documented(project_root: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The example of CONTRIBUTING.md, as a file."""
    text = (project_root / "CONTRIBUTING.md").read_text(encoding="utf-8")
    source = re.findall(r"```python\n(.*?)```", text, re.DOTALL)[0]
    assert len([line for line in source.splitlines() if line.strip()]) <= 10
    path = tmp_path_factory.mktemp("own") / "my_effect.py"
    path.write_text(source)
    return path


def test_the_documented_example_finds_its_torque_in_measurements(dataset: Dataset, documented: Path) -> None:
    size = {"left": 0.03, "right": -0.02}
    gain = np.array([3.3, 2.76])

    def with_fan(position: np.ndarray, current: np.ndarray) -> np.ndarray:
        velocity = np.gradient(position, 1e-3, axis=0)
        smooth = np.array([np.convolve(v, np.ones(9) / 9, mode="same") for v in velocity.T]).T
        return current + smooth**3 * np.array(list(size.values())) / gain

    recordings = tuple(
        replace(one, current=with_fan(one.position, one.current)) for one in dataset.recordings
    )
    own = replace(dataset, recordings=recordings, effect_files=(documented,))
    plain, result = (
        identify(prepare(problem_of(own))),
        identify(prepare(problem_of(own, ["fan_torque", "viscous_friction"]))),
    )
    assert result.error.validate < 0.5 * plain.error.validate
    for joint, value in size.items():
        found = result.effect_parameters["fan_torque"][joint]["c"]
        assert found.unit == "N*m*s^3/rad^3"
        assert found.value == pytest.approx(value, rel=0.05)


def test_on_the_command_line_and_in_the_dataset(
    five_bar_simulation: Simulation, documented: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "data"
    write_simulation(five_bar_simulation, folder)
    words = ["identify", str(folder), "--with", "fan_torque", "--json", str(tmp_path / "model.json")]
    assert cli.main(words) == 2
    assert "unknown effect 'fan_torque'" in capsys.readouterr().err
    assert cli.main([*words, "--effect-file", str(documented)]) == 0
    answer = json.loads((tmp_path / "model.json").read_text())
    assert answer["effect_parameters"]["fan_torque"]["right"]["c"]["unit"] == "N*m*s^3/rad^3"
    # the model names the file: who reads it need not
    assert load_model(tmp_path / "model.json").effect_files == (documented.resolve(),)
    assert cli.main(["compare", str(folder), "--model", str(tmp_path / "model.json")]) == 0
    (folder / "my_effect.py").write_text(documented.read_text())
    text = (folder / "dataset.toml").read_text()
    (folder / "dataset.toml").write_text('effects = ["my_effect.py"]\n' + text)
    assert cli.main(words) == 0
    assert identify(prepare(problem_of(load_dataset(folder), ["fan_torque"]))).effects == ("fan_torque",)
    capsys.readouterr()


def test_the_catalogue_holds_built_in_and_own_effects_in_order(documented: Path) -> None:
    catalogue = catalogue_for((documented,), [documented])  # the same file twice is no clash
    assert list(catalogue) == sorted([*CATALOGUE, "fan_torque"])
    assert catalogue_for() == CATALOGUE


@pytest.mark.parametrize(
    ("source", "message"),
    [
        ("x = (", r"bad\.py, line 1: '\(' was never closed"),
        ("import nothing_of_that_name", r"bad\.py, line 1: ModuleNotFoundError: No module named"),
        ("\n\n1 / 0", r"bad\.py, line 3: ZeroDivisionError: division by zero"),
        ("x = 1", r"bad\.py: no subclass of Effect or ActuatorEffect$"),
        (HEAD + "class Half(ActuatorEffect):\n    name = 'half'", r"no subclass .*\(Half lacks torque\)"),
        (HEAD + GOOD.replace('name = "mine"', "pass"), "name must be a word.*not None"),
        (HEAD + GOOD.replace('"mine"', '"my:effect"'), "name must be a word.*'my:effect'"),
        (
            HEAD + GOOD.replace("(EffectParameter", "[EffectParameter").replace("),)", ")]"),
            "tuple of EffectParameter",
        ),
        (HEAD + GOOD.replace('(EffectParameter("c", "{effort}"),)', "()"), "at least one"),
        (HEAD + GOOD.replace("{effort}", "{torque}"), r"unit '\{torque\}'"),
        (HEAD + GOOD + '    place = "elbow"', "place 'elbow' is none of actuator, passive"),
        (HEAD + GOOD + '    shape = (ShapeParameter("v", "1", (1.0,)),)', "'v' needs candidates and a field"),
        (HEAD + GOOD + "    v: float\n", r"class Mine cannot be made without arguments: .*'v'"),
        (HEAD + GOOD + GOOD.replace("Mine", "Other"), "two effects have the same name: mine, mine"),
        (
            HEAD + GOOD.replace('"mine"', '"viscous_friction"'),
            "'viscous_friction' has the name of a built-in one",
        ),
    ],
)
def test_a_file_that_cannot_be_used_is_refused_in_one_line(source: str, message: str, tmp_path: Path) -> None:
    path = tmp_path / "bad.py"
    path.write_text(source)
    with pytest.raises(BenchError, match=message) as caught:
        catalogue_for([path])
    assert "\n" not in str(caught.value)
    assert str(path) in str(caught.value)


def test_a_missing_file_and_two_files_of_one_name_are_refused(tmp_path: Path) -> None:
    with pytest.raises(BenchError, match=r"none\.py: No such file"):
        load_effects(tmp_path / "none.py")
    for name in ("one.py", "two.py"):
        (tmp_path / name).write_text(HEAD + GOOD)
    with pytest.raises(BenchError, match=r"two\.py: effect 'mine' has the name of one in .*one\.py"):
        catalogue_for([tmp_path / "one.py", tmp_path / "two.py"])


@pytest.mark.parametrize(
    ("torque", "message"),
    [
        ("joint.velocity", r"torque has the shape \(\d+,\) instead of \(\d+, 1\)"),
        ("joint.velocity[:-1, None]", r"torque has the shape"),
        (
            "np.log(joint.velocity[:, None] * 0 - 1)",
            r"effect 'mine': its column of c is not finite at t = 0\.",
        ),
        (
            "joint.speeed[:, None]",
            r"line 11: AttributeError: 'JointSignals' object has no attribute 'speeed'",
        ),
        ("1 / 0", r"line 11: ZeroDivisionError"),
    ],
)
def test_wrong_columns_are_refused_when_they_are_used(
    torque: str, message: str, dataset: Dataset, tmp_path: Path
) -> None:
    path = tmp_path / "wrong.py"
    path.write_text(HEAD + GOOD.replace("TORQUE", f"(np.seterr(invalid='ignore'), {torque})[1]"))
    with np.errstate(), pytest.raises(BenchError, match=message) as caught:
        identify(prepare(problem_of(replace(dataset, effect_files=(path,)), ["mine"])))
    assert str(path) in str(caught.value) or "effect 'mine'" in str(caught.value)
