"""A click group that imports its commands on demand and suggests names; output that tolerates a closed pipe."""

import importlib
import os
import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, redirect_stdout
from dataclasses import dataclass
from typing import Any, TextIO

import click

from bench.basics.errors import nearest
from bench.cli.last_lines import set_quiet
from bench.cli.progress import QUIET


@dataclass(frozen=True)
class LazyCommand:
    """The location of a command, and its line in the group's help."""

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
    """Add the option --quiet to a command, or to the commands of a group."""
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
        """Names in the order of the table."""
        return list(self.lazy_commands)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:  # noqa: ARG002 - click's
        """Import one command; None if there is none of that name."""
        lazy = self.lazy_commands.get(cmd_name)
        return lazy.load() if lazy else None

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:  # noqa: ARG002 - click's
        """List all commands by section, from the table, without importing them."""
        width = max(map(len, self.lazy_commands), default=0)
        for section in dict.fromkeys(lazy.section for lazy in self.lazy_commands.values()):
            with formatter.section(section):
                rows = [
                    (n.ljust(width), command.help)
                    for n, command in self.lazy_commands.items()
                    if command.section == section
                ]
                formatter.write_dl(rows)


def misspelt(error: click.NoSuchOption | click.NoSuchCommand) -> str:
    """The error's message with the nearest known name; click's similarity counts the dashes, too."""
    context = error.ctx
    if context is None:
        return error.message
    if isinstance(error, click.NoSuchCommand):
        name = error.command_name
        words = context.command.list_commands(context) if isinstance(context.command, click.Group) else []
    else:
        name = error.option_name
        options = [(*parameter.opts, *parameter.secondary_opts) for parameter in context.command.params]
        words = [word for spelled in options for word in spelled if word.startswith("--")]
    known = {word.lstrip("-"): word for word in words}
    near = nearest(name.lstrip("-"), known)
    return error.message if near is None else f"{error.message} Did you mean {known[near]!r}?"


class Forgiving:
    """A wrapper of a stream that discards output after the reader has closed the pipe."""

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream

    def write(self, text: str) -> int:
        """Write, unless the pipe is closed."""
        try:
            return self._stream.write(text)
        except BrokenPipeError:
            self._let_go()
            return len(text)

    def flush(self) -> None:
        """Flush, unless the pipe is closed."""
        try:
            self._stream.flush()
        except BrokenPipeError:
            self._let_go()

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)

    def _let_go(self) -> None:
        """Redirect the stream to the null device, which also receives the buffer that Python flushes at exit."""
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, self._stream.fileno())
        os.close(nowhere)


@contextmanager
def forgiving_output() -> Iterator[None]:
    """Tolerate a closed standard output inside the context."""
    stream = Forgiving(sys.stdout)
    with redirect_stdout(stream):
        try:
            yield
        finally:
            stream.flush()
