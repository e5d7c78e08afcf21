"""Serve the page at the loopback address until interrupted."""

import os
import secrets
import socket
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

import uvicorn

from bench.basics.errors import BenchError
from bench.dataset.names import DATASET_FILE
from bench.local.app import EndingServer, Pages, answered_at_the_end, application
from bench.local.folder import Folder
from bench.local.guard import LOOPBACK, Guard
from bench.local.jobs import Jobs
from bench.local.worker import Home, Worker

LOOKS = {
    name: f"bench.local.looks:{name}"
    for name in ("columns", "checks", "parts", "payload", "dataset", "curves", "machine", "runs")
}
"""The looker's functions, by name."""
PATIENCE = 1  # s for open requests to end when the server shuts down


@dataclass(frozen=True)
class Opened:
    """Arguments of `bench open`. start: the dataset that the page opens, relative to the folder; "" for none.

    command: as typed, for repetition.
    """

    folder: Folder
    start: str
    command: str
    port: int = 0


def opened(path: Path, robots: tuple[Path, ...], command: str, port: int = 0) -> Opened:
    """The arguments, checked; `path` is a folder, a dataset or its file. Raises BenchError if it cannot be opened."""
    if path.name == DATASET_FILE:
        path = path.parent
    if path.is_file():
        raise BenchError(f"{path}: is a file: name the folder that it is in")
    if not path.is_dir():
        raise BenchError(f"{path}: no such folder")
    for robot in robots:
        if not (robot / "robot.toml").is_file():
            raise BenchError(f"{robot}: no robot folder: it holds no robot.toml")
    start = "." if (path / DATASET_FILE).is_file() else ""
    folder = Folder(path.resolve(), tuple(robot.resolve() for robot in robots))
    return Opened(folder, start, command, port)


def serve(asked: Opened, functions: Mapping[str, Home], ready: Callable[[str], None]) -> None:
    """Serve until interrupted. ready: called with the page's address once it can be opened.

    functions: `command`, which runs a command. Raises BenchError if the port is taken.
    """
    commander, looker = Worker(functions), Worker(LOOKS)
    with _listening(asked.port) as listener:
        port = listener.getsockname()[1]
        token = secrets.token_urlsafe(24)
        pages = Pages(asked.folder, Jobs(commander), looker, asked.start, asked.command)
        app = answered_at_the_end(Guard(application(pages), token, port))
        config = uvicorn.Config(
            app,
            log_level="critical",
            access_log=False,
            server_header=False,
            timeout_graceful_shutdown=PATIENCE,
            lifespan="off",
            proxy_headers=False,
        )

        def close() -> None:
            commander.close()
            looker.close()

        ready(f"http://{LOOPBACK}:{port}/{token}/")
        try:
            EndingServer(config, close).run(sockets=[listener])
        finally:
            close()


def _listening(port: int) -> socket.socket:
    try:
        return socket.create_server((LOOPBACK, port), backlog=64)
    except OSError as error:
        raise BenchError(f"--port {port}: {os.strerror(error.errno or 0)}") from error
