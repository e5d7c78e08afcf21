"""Peak memory of a process."""

import re
import resource
from pathlib import Path

STATUS = Path("/proc/self/status")
KILO = 1024


def peak_bytes() -> int:
    """Peak memory of this process since its start, bytes.

    `getrusage` is only a fallback: on Linux its value is never below the memory of the parent process.
    """
    if STATUS.is_file():
        match = re.search(r"^VmHWM:\s+(\d+) kB", STATUS.read_text(encoding="ascii"), re.MULTILINE)
        if match:
            return int(match[1]) * KILO
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * KILO
