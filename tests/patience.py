"""A browser test waits as long as somebody works, however slow the machine is, and ends where nobody does."""

import os
import signal
import subprocess
import threading
from contextlib import contextmanager, suppress

PATIENT = 300_000  # ms that a step may take
LOOKED = 60.0  # s between two looks at what was worked
NOTHING = 2  # s of processor in that time: open pages that wait take less, one that works more


def offspring():
    """Number, seconds of processor and line of every process that this one has started, and those have."""
    words = ["ps", "-wweo", "pid=,ppid=,cputimes=,args="]
    listed = subprocess.run(words, capture_output=True, text=True, check=True).stdout
    rows = [line.split(None, 3) for line in listed.splitlines()]
    families, found = {os.getpid()}, []
    for pid, parent, seconds, *line in sorted(rows, key=lambda row: int(row[0])):
        if int(parent) in families:
            families.add(int(pid))
            found.append((int(pid), int(seconds), " ".join(line)))
    return found


@contextmanager
def ended_at_a_standstill():
    """Inside, pages are ended, and what waits for them fails, once nobody has worked between two looks."""
    over = threading.Event()

    def watch():
        before = {pid: seconds for pid, seconds, _ in offspring()}
        while not over.wait(LOOKED):
            now = offspring()
            if sum(seconds - before.get(pid, 0) for pid, seconds, _ in now) < NOTHING:
                for pid, _, line in now:
                    if "--type=renderer" in line:
                        with suppress(ProcessLookupError):
                            os.kill(pid, signal.SIGKILL)
            before = {pid: seconds for pid, seconds, _ in now}

    watching = threading.Thread(target=watch, daemon=True)
    watching.start()
    try:
        yield
    finally:
        over.set()
        watching.join()
