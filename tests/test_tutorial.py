"""The tutorials: their commands run in their order, and say what the pages say that they say."""

import json
import math
import re
import shlex

import pytest

from bench.cli import main

NUMBER = re.compile(r"[-+−]?\d+(?:\.\d+)?")
DRAWN = re.compile(r"[█-▏─•]+")  # bars, rules and bullets
CLOSE = 0.05  # relative: the words are held to the letter, numbers to what another rounding may change


def blocks_of(path):
    """(language, text) of every block of a page."""
    return re.findall(r"```(\w+)\n(.*?)```", path.read_text(encoding="utf-8"), flags=re.DOTALL)


def words(text):
    return DRAWN.sub(" ", text).split()


def masked(tokens):
    return [NUMBER.sub("#", token) for token in tokens]


def said(shown, printed):
    """The part of what was printed that has the words of what is shown, whatever its numbers."""
    wanted, there = masked(words(shown)), masked(words(printed))
    for start in range(len(there) - len(wanted) + 1):
        if there[start : start + len(wanted)] == wanted:
            return words(printed)[start : start + len(wanted)]
    return None


def held(blocks, capsys):
    """Run the commands of a page, and hold what is shown against what is printed; how many parts were held."""
    printed, shown = "", 0
    for language, text in blocks:
        if language == "sh":
            printed = ""
            for command in text.strip().splitlines():
                program, *arguments = shlex.split(command)
                assert program == "bench"
                assert main(arguments) == 0
                printed += capsys.readouterr().out
        elif language == "text":
            shown += len([check(part, printed) for part in parts_of(text)])
    return shown


def parts_of(text):
    """A block of sentences is held line by line, as bullets stand between them, an indented line with the one before;
    what runs on over lines as a whole.
    """
    whole = any(words in text for words in ("noise of the currents", "falls from"))
    return [text] if whole else text.strip().replace("\n  ", " ").splitlines()


def check(part, printed):
    found = said(part, printed)
    assert found is not None, f"not said: {part}"
    numbers = [float(one.replace("−", "-")) for one in NUMBER.findall(" ".join(words(part)))]
    now = [float(one.replace("−", "-")) for one in NUMBER.findall(" ".join(found))]
    assert all(math.isclose(a, b, rel_tol=CLOSE) for a, b in zip(numbers, now, strict=True)), part


@pytest.mark.slow
def test_the_commands_run_and_say_what_is_shown(project_root, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    page = project_root / "docs" / "pages" / "tutorials" / "friction.md"
    assert held(blocks_of(page), capsys) >= 6
    folder = tmp_path / "results" / "tutorial"
    truth = json.loads((folder / "data.truth.json").read_text())
    model = json.loads((folder / "model.json").read_text())
    hidden = {one["effect"]: one for one in truth["hidden"]}
    for effect, parameter in (("coulomb_friction", "Fc"), ("viscous_friction", "Fv")):
        found = model["effect_parameters"][effect]["left"][parameter]["value"]
        assert found == pytest.approx(hidden[effect][parameter], rel=0.01)
    gain = model["drive_gains"]["left"]["value"]
    assert gain == pytest.approx(truth["drive_gains"]["left"]["true"], rel=0.002)
    pictures = {path.name for path in folder.rglob("*.png")}
    assert {"errors_left.png", "ladder.png", "gains.png", "errors.png"} <= pictures


def test_the_readme_says_what_the_tutorial_says(project_root):
    (verdict,) = [text for language, text in blocks_of(project_root / "README.md") if language == "text"]
    page = (project_root / "docs" / "pages" / "tutorials" / "friction.md").read_text(encoding="utf-8")
    assert words(verdict) == said(verdict, page)


@pytest.mark.slow
def test_a_law_that_nobody_told_is_found_as_the_page_says(project_root, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    blocks = blocks_of(project_root / "docs" / "pages" / "tutorials" / "law.md")
    (scenario,) = [text for language, text in blocks if language == "toml"]
    (tmp_path / "braked.toml").write_text(scenario, encoding="utf-8")
    assert held(blocks, capsys) >= 5
    assert (tmp_path / "law_left.py").exists()


def test_a_block_is_found_with_other_numbers_but_not_with_other_words():
    printed = "• motor left: error 10 %, 61.2 times\n  the noise ██▎ -3"
    assert said("motor left: error 9.9 %, 60 times the noise", printed)[3] == "10"
    assert said("motor left: error 9.9 %, 60 times the current", printed) is None
