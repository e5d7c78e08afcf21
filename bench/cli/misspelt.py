"""What is said of a command or an option that there is not: the one that is most like it."""

import click

from bench.basics.errors import nearest


def misspelt(error: click.NoSuchOption | click.NoSuchCommand) -> str:
    """The message. The similarity of click counts the dashes, and so takes --robots for --verbose."""
    command = error.ctx.command if error.ctx is not None else None
    if isinstance(error, click.NoSuchCommand):
        name, known = error.command_name, _commands(command, error.ctx)
    else:
        name = error.option_name
        known = {option.lstrip("-"): option for option in _options(command)}
    near = nearest(name.lstrip("-"), known)
    return error.message if near is None else f"{error.message} Did you mean {known[near]!r}?"


def _commands(command: click.Command | None, context: click.Context | None) -> dict[str, str]:
    if not isinstance(command, click.Group) or context is None:
        return {}
    return {name: name for name in command.list_commands(context)}


def _options(command: click.Command | None) -> list[str]:
    parameters = [] if command is None else command.params
    return [
        option
        for parameter in parameters
        for option in (*parameter.opts, *parameter.secondary_opts)
        if option.startswith("--")
    ]
