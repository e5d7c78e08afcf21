"""A click group whose commands are imported when they are asked for, and not for its help."""

import importlib
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import click

from bench.cli.last_lines import set_quiet
from bench.cli.progress import QUIET


@dataclass(frozen=True)
class LazyCommand:
    """Where a command is, and the line that the group's help shows for it."""

    target: str
    """`package.module:name` of a click command."""
    help: str
    section: str = "Commands"
    """Its heading in the group's help."""

    def load(self) -> click.Command:
        """Import the command."""
        module, _, name = self.target.partition(":")
        command = getattr(importlib.import_module(module), name)
        if not isinstance(command, click.Command):
            raise TypeError(f"{self.target} is not a click command")
        _may_be_quiet(command)
        return command


def _may_be_quiet(command: click.Command) -> None:
    """Give a command, or those of a group, the option that all have."""
    if isinstance(command, click.Group):
        for member in command.commands.values():
            _may_be_quiet(member)
    elif not any(parameter.name == "quiet" for parameter in command.params):
        quiet = ["-q", "--quiet"]
        option = click.Option(quiet, is_flag=True, callback=set_quiet, help=QUIET, expose_value=False)
        command.params.append(option)


class LazyGroup(click.Group):
    """A group that lists its commands in the order of `lazy_commands`, which maps name to command."""

    def __init__(self, *args: Any, lazy_commands: Mapping[str, LazyCommand], **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)
        self.lazy_commands = lazy_commands

    def list_commands(self, ctx: click.Context) -> list[str]:  # noqa: ARG002 - click's signature
        """Names, in the order of the table."""
        return list(self.lazy_commands)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:  # noqa: ARG002 - click's
        """Import one command; None if there is none of that name."""
        lazy = self.lazy_commands.get(cmd_name)
        return lazy.load() if lazy else None

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:  # noqa: ARG002 - click's
        """List every command from the table alone, section by section."""
        width = max(map(len, self.lazy_commands), default=0)
        for section in dict.fromkeys(lazy.section for lazy in self.lazy_commands.values()):
            with formatter.section(section):
                rows = [
                    (n.ljust(width), command.help)
                    for n, command in self.lazy_commands.items()
                    if command.section == section
                ]
                formatter.write_dl(rows)
