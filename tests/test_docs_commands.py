"""The commands that the handbook shows exist, with the options that it gives them."""

import re
import shlex
from pathlib import Path

import click
import pytest

from bench.cli import cli

PAGES = Path(__file__).resolve().parents[1] / "docs" / "pages"
FENCED = re.compile(r"```sh\n(.*?)```", re.DOTALL)


def commands():
    """(page, command line) of every line that starts with `bench`."""
    for path in [*sorted(PAGES.rglob("*.md")), PAGES.parents[1] / "README.md"]:
        for block in FENCED.findall(path.read_text(encoding="utf-8")):
            for line in block.replace("\\\n", " ").splitlines():
                if line.startswith("bench "):
                    yield pytest.param(line, id=f"{path.stem}: {line[:40]}")


def named(words):
    """The command of these words, and the words that are its own."""
    group = cli
    context = click.Context(cli)
    while isinstance(group, click.Group):
        found = group.get_command(context, words[0])
        assert found is not None, words[0]
        group, words = found, words[1:]
    return group, words


@pytest.mark.parametrize("line", [*commands()])
def test_a_command_of_the_handbook_is_one(line):
    command, words = named(shlex.split(line, comments=True)[1:])
    known = {name for one in command.params for name in (*one.opts, *one.secondary_opts)}
    given = {word for word in words if re.match(r"--?[a-z]", word)}
    assert given - known - {"--help"} == set()
    least = sum(isinstance(one, click.Argument) and one.required for one in command.params)
    assert len([word for word in words if not word.startswith("-")]) >= least
