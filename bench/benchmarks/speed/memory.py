"""The largest memory of a process that has nothing else to do."""

import re
import resource
from pathlib import Path

STATUS = Path("/proc/self/status")
KILO = 1024


def peak_bytes() -> int:
    """Peak memory of this process since it was started, bytes.

    What `getrusage` says on Linux is never less than what the process had that started it.
    """
    if STATUS.is_file():
        match = re.search(r"^VmHWM:\s+(\d+) kB", STATUS.read_text(encoding="ascii"), re.MULTILINE)
        if match:
            return int(match[1]) * KILO
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * KILO
