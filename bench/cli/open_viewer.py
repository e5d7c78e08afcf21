"""Start the Rerun viewer that comes with the library."""

import os
import shutil
import subprocess
import sys
from pathlib import Path


def open_viewer(path: Path) -> str:
    """Open a recording in a separate window that outlives the command; says what was done, or what to do."""
    installed = Path(sys.executable).with_name("rerun")
    program = str(installed) if installed.is_file() else shutil.which("rerun")
    if program is None:
        return f"The program rerun is not on the path; open it with: rerun {path}"
    if sys.platform.startswith("linux") and not (
        os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")
    ):
        return f"No screen; open it on another machine, or in a browser with: rerun --web-viewer {path}"
    subprocess.Popen(
        [program, str(path)],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
    )
    return "Opened in the Rerun viewer."
