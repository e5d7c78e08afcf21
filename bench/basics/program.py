"""The command name of this program."""

import shutil
import sys
from pathlib import Path

from bench.basics.shell_word import quoted

COMMAND, OTHER_NAME = "bench", "parabench"  # another package installs a `bench`, too


def called_as() -> str:
    """The name with which the command was called: `bench` or `parabench`."""
    return OTHER_NAME if Path(sys.argv[0]).stem == OTHER_NAME else COMMAND


def typed() -> str:
    """The word that starts this program in the user's shell: its name if that is on the path, else the path of its
    file.
    """
    name, called = called_as(), Path(sys.argv[0])
    if called.stem != name or not called.is_file():  # `python -m bench`, or called from Python
        return name
    on_path = shutil.which(name)
    return name if on_path is not None and Path(on_path).samefile(called) else quoted(called)
