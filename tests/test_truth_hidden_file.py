"""Hidden effects of one's own, from a file that a scenario names."""

import pickle
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from bench.basics.errors import BenchError
from bench.truth.hidden.entries import hidden_in
from tests.hidden_kit import plain, run


@pytest.fixture
def fan(project_root: Path, tmp_path: Path) -> Path:
    """The example of scenarios/README.md, as a file."""
    text = (project_root / "scenarios/README.md").read_text(encoding="utf-8")
    file = tmp_path / "fan.py"
    file.write_text(re.findall(r"```python\n(.*?)```", text, re.DOTALL)[0], encoding="utf-8")
    return file


def test_an_effect_of_one_s_own_is_hidden_where_it_is_named(fan: Path) -> None:
    hidden = {"effect": "fan", "file": str(fan), "joint": "left", "c": 0.05}
    for with_fan, without in zip(
        run("five_bar", hidden).recordings, plain("five_bar").recordings, strict=True
    ):
        change = with_fan.motion.torque - without.motion.torque
        speed = without.motion.qvel[:, 0]
        assert np.corrcoef(change[:, 0], 0.05 * speed**3)[0, 1] > 0.95


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ({"c": -1.0}, "hidden\\[0\\].c: should be greater than 0"),
        ({"effect": "gust"}, "no effect 'gust' in .*fan.py; there are fan$"),
        ({"file": "nowhere.py"}, "nowhere.py: No such file"),
    ],
)
def test_mistakes_in_such_an_entry_are_named(fan: Path, change: dict[str, object], told: str) -> None:
    with pytest.raises(BenchError, match=told):
        run("five_bar", {"effect": "fan", "file": str(fan), "c": 0.05, **change})


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("x = 1\n", "no subclass of HiddenEffect or JointEffect that has a name"),
        ("import math\nmath.nothing\n", "line 2: AttributeError"),
        ("def broken(:\n", "line 1: invalid syntax"),
    ],
)
def test_mistakes_in_the_file_are_named(tmp_path: Path, text: str, told: str) -> None:
    file = tmp_path / "mine.py"
    file.write_text(text, encoding="utf-8")
    with pytest.raises(BenchError, match=told):
        hidden_in(file)


def test_such_an_effect_goes_to_a_process_that_has_not_run_its_file(fan: Path, tmp_path: Path) -> None:
    sent = tmp_path / "effect"
    sent.write_bytes(pickle.dumps(hidden_in(fan)["fan"](joint="left", c=0.05)))
    fan.unlink()
    script = (
        "import pickle, sys; one = pickle.loads(open(sys.argv[1], 'rb').read()); "
        "print(one.name, one.joint, one.c, one.torque.__qualname__)"
    )
    done = subprocess.run(
        [sys.executable, "-c", script, str(sent)], capture_output=True, text=True, check=True
    )
    assert done.stdout.split() == ["fan", "left", "0.05", "Fan.torque"]
