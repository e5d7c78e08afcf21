"""A picture of the viewer without a screen, to look at what `write_rrd` writes: for developers only.

    python docs/pictures/viewer.py FILE.rrd PICTURE.png [--time SECONDS] [--size 1600x1000]

Needs a Vulkan driver; a software one will do (Debian: mesa-vulkan-drivers, libvulkan1).
"""

import argparse
import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from rerun.experimental import ViewerClient

from bench.basics.errors import BenchError

STARTING = 60.0  # s to wait for the viewer
SETTLING = 60.0  # s to wait for a picture that stays the same
ENDING = 5.0  # s in which a viewer that does not answer any more ends, where it had to
NO_DRIVER = (
    "the Rerun viewer ended: it draws with a Vulkan driver "
    "(Debian: apt-get install mesa-vulkan-drivers libvulkan1)"
)


def screenshot(recording: Path, picture: Path, at: float, size: str) -> None:
    """Open a recording in a viewer without a window, and save the picture once nothing changes any more.

    Raises BenchError where the viewer ends, as it does without a Vulkan driver.
    """
    with _viewer(size) as client:
        client.open(str(recording.resolve()))
        _set_time(client, at)
        picture.write_bytes(_settled(client))


@contextmanager
def _viewer(size: str) -> Iterator[ViewerClient]:
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    program = Path(sys.executable).with_name("rerun")
    command = [
        str(program),
        "--headless",
        "--window-size",
        size,
        "--port",
        str(port),
        "--hide-welcome-screen",
    ]
    # The program starts the viewer as a separate process, and would leave it behind: both are one group.
    with subprocess.Popen(
        command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True
    ) as process:
        try:
            yield _connected(port, process)
        except ConnectionError as error:
            with suppress(subprocess.TimeoutExpired):
                process.wait(ENDING)
            if process.poll() is None:
                raise
            raise BenchError(NO_DRIVER) from error
        finally:
            with suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGTERM)


def _connected(port: int, process: subprocess.Popen[bytes]) -> ViewerClient:
    end = time.monotonic() + STARTING
    while True:
        if process.poll() is not None:
            raise ConnectionError("the viewer has ended")
        try:
            client = ViewerClient.connect(f"rerun+http://127.0.0.1:{port}/proxy")
            client.get_state()
        except (RuntimeError, ConnectionError, OSError):
            if time.monotonic() > end:
                raise
            time.sleep(0.5)
        else:
            return client


def _set_time(client: ViewerClient, at: float) -> None:
    """Go to a time [s], once the recording has been loaded."""
    end = time.monotonic() + STARTING
    while True:
        try:
            client.set_time("time", duration=at, play_state="paused")
        except ConnectionError:  # no recording yet
            if time.monotonic() > end:
                raise
            time.sleep(0.3)
        else:
            return


def _settled(client: ViewerClient) -> bytes:
    """The first picture that comes three times in a row: plots and shapes are loaded one after the other."""
    end = time.monotonic() + SETTLING
    before, same = b"", 0
    while same < 2 and time.monotonic() < end:
        time.sleep(0.3)
        now = client.take_screenshot()
        same = same + 1 if now == before else 0
        before = now
    return before


def main() -> None:
    """Read the command line."""
    parser = argparse.ArgumentParser(
        prog="python docs/pictures/viewer.py", description=__doc__.splitlines()[0]
    )
    parser.add_argument("recording", type=Path)
    parser.add_argument("picture", type=Path)
    parser.add_argument("--time", type=float, default=5.0, help="seconds into the recording")
    parser.add_argument("--size", default="1600x1000", help="width x height in points")
    given = parser.parse_args()
    try:
        screenshot(given.recording, given.picture, given.time, given.size)
    except BenchError as error:
        parser.exit(2, f"{error}\n")


if __name__ == "__main__":
    main()
