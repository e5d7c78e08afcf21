"""What a worker does in tests; a module that is imported at once."""

import os
import signal
import time

from bench.basics.errors import BenchError


def double(arguments, progress):
    progress.phase("doubling", 2)
    progress.advance()
    return 2 * arguments["number"]


def refuse(arguments, progress):
    raise BenchError(f"{arguments['number']}: is odd")


def die(arguments, progress):
    os._exit(3)


def kill(arguments, progress):
    os.kill(os.getpid(), signal.SIGKILL)


def wait(arguments, progress):
    progress.phase("waiting")
    time.sleep(600)
