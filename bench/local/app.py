"""The server's responses: the page, the contents of the folder, the jobs, and files to download."""

import asyncio
import json
import socket
import tempfile
from collections.abc import AsyncIterator, Awaitable, Callable
from dataclasses import asdict
from http import HTTPStatus
from pathlib import Path
from time import localtime, strftime
from typing import Any

import uvicorn
from starlette.applications import Starlette
from starlette.background import BackgroundTask
from starlette.exceptions import HTTPException
from starlette.requests import Request
from starlette.responses import FileResponse, JSONResponse, Response, StreamingResponse
from starlette.routing import Route
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from bench.basics.errors import BenchError
from bench.basics.plain_data import finite
from bench.basics.progress import SILENT
from bench.dataset.names import DATASET_FILE, RUN_FILE
from bench.local.folder import LARGEST, Folder, take, zip_dataset
from bench.local.guard import REPORT_POLICY
from bench.local.jobs import Jobs
from bench.local.steps import command_of
from bench.local.worker import CancelledError, DiedError, Worker
from bench.page.render import ASSETS as REPORT_ASSETS
from bench.page.render import EVERY_PAGE, MACHINE

ENDING = "`bench open` is being ended; start it again, what was found lies in the folder"
ASSETS = Path(__file__).with_name("assets")
LARGEST_REQUEST = 1 << 20  # bytes of a request other than a log
LEAVING = {".json", ".html", ".csv", ".parquet", ".toml", ".png", ".zip", ".xml", ".urdf", ".yaml", ".c"}
NEW_DATASET = "my_data"  # default name of a new dataset, with a number if it is taken


class EndingServer(uvicorn.Server):
    """A server that, on shutdown, first ends the work on which open requests wait, then waits for these requests."""

    def __init__(self, config: uvicorn.Config, close: Callable[[], None]) -> None:
        super().__init__(config)
        self._close = close

    async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
        """Call `close`, then shut down."""
        await asyncio.to_thread(self._close)
        await super().shutdown(sockets)


def answered_at_the_end(app: ASGIApp) -> ASGIApp:
    """The application; a request interrupted by the server's shutdown is answered with status 503 and `ENDING`."""

    async def answered(scope: Scope, receive: Receive, send: Send) -> None:
        begun = False

        async def sent(message: Message) -> None:
            nonlocal begun
            begun = True
            await send(message)

        try:
            await app(scope, receive, sent)
        except asyncio.CancelledError:
            if begun:
                raise
            await JSONResponse({"error": ENDING}, HTTPStatus.SERVICE_UNAVAILABLE)(scope, receive, send)

    return answered


SCRIPTS = (
    "dom.js",
    "kept.js",
    "server.js",
    "step.js",
    "figure.js",
    "columns.js",
    "payload.js",
    "robots.js",
    "dataset.js",
    "gains.js",
    "recordings.js",
    "errors.js",
    "bars.js",
    "answer.js",
    "choosing.js",
    "effects.js",
    "results.js",
    "open.js",
)


KINDS = {".js": "text/javascript", ".css": "text/css"}
ASSET_FILES = {name: REPORT_ASSETS / name for name in (*EVERY_PAGE, MACHINE, "page.css")} | {
    name: ASSETS / name for name in (*SCRIPTS, "open.css")
}
"""Scripts and styles of the page, by name."""


Handler = Callable[[Request], Awaitable[Response]]


class Pages:
    """The server's state and its handlers. folder: that is open; jobs: commands; looker: a worker that reads files."""

    def __init__(self, folder: Folder, jobs: Jobs, looker: Worker, start: str, command: str) -> None:
        self.folder, self.jobs, self.looker = folder, jobs, looker
        self.start, self.command = start, command

    def routes(self) -> list[Route]:
        """The routes."""
        plain: list[tuple[str, Handler, str]] = [
            ("/", self.page, "GET"),
            ("/assets/{name}", self.asset, "GET"),
            ("/events", self.events, "GET"),
            ("/api/folder", self.contents, "GET"),
            ("/api/look/{name}", self.look, "POST"),
            ("/api/command", self.shown_command, "POST"),
            ("/api/run", self.run, "POST"),
            ("/api/cancel", self.cancel, "POST"),
            ("/api/logs/{name}", self.upload, "PUT"),
            ("/files/{path:path}", self.file, "GET"),
            ("/show/{path:path}", self.show, "GET"),
            ("/zip/{path:path}", self.archive, "GET"),
        ]
        return [Route(path, handler, methods=[method]) for path, handler, method in plain]

    async def page(self, _request: Request) -> Response:
        """The page; scripts and styles are separate requests, as its content-security policy demands."""
        names = (*EVERY_PAGE, MACHINE, *SCRIPTS)
        scripts = "\n".join(f'<script src="assets/{name}"></script>' for name in names)
        page = (ASSETS / "open.html").read_text(encoding="utf-8").replace("<!-- scripts -->", scripts)
        return Response(page, media_type="text/html")

    async def asset(self, request: Request) -> Response:
        """A script or style of the page."""
        file = ASSET_FILES.get(request.path_params["name"])
        if file is None:
            raise HTTPException(404)
        return Response(file.read_text(encoding="utf-8"), media_type=KINDS[file.suffix])

    async def events(self, _request: Request) -> Response:
        """Server-sent events: the state of all jobs, now and after every change."""

        async def messages() -> AsyncIterator[str]:
            async for version in self.jobs.changes():
                yield f"id: {version}\ndata: {json.dumps(finite(self.jobs.as_json()))}\n\n"

        return StreamingResponse(messages(), media_type="text/event-stream")

    async def contents(self, _request: Request) -> Response:
        """The contents of the folder."""
        entry = await asyncio.to_thread(self.folder.look)
        answer, root = asdict(entry), self.folder.root
        written = {run: root / run / RUN_FILE for run in entry.runs}
        written |= {model: root / model for model in entry.models}
        in_time = sorted((file.stat().st_mtime, path) for path, file in written.items())
        form = "%Y-%m-%d %H:%M"
        answer["runs"] = [{"path": path, "time": strftime(form, localtime(when))} for when, path in in_time]
        answer |= {"root": str(root), "name": root.name, "start": self.start}
        answer["named_robots"] = [str(path) for path in self.folder.robots]
        answer["free"] = self.folder.free(NEW_DATASET)
        return JSONResponse(answer | {"command": self.command, "largest": LARGEST})

    async def look(self, request: Request) -> Response:
        """The answer of one of the looker's functions."""
        name, asked = request.path_params["name"], await _json(request)
        arguments = self._arguments(name, asked)
        try:
            answer = await asyncio.to_thread(self.looker.call, name, arguments, SILENT)
        except CancelledError:
            raise BenchError(ENDING) from None
        except DiedError as error:
            raise BenchError(f"reading ended unexpectedly: {error}") from None
        return JSONResponse(finite(answer))

    async def shown_command(self, request: Request) -> Response:
        """The command of a step, without running it."""
        command = command_of(self.folder, await _json(request))
        return JSONResponse({"line": command.line, "there": command.there})

    async def run(self, request: Request) -> Response:
        """Run the command of a step."""
        command = command_of(self.folder, await _json(request))
        job = self.jobs.start(command.step, command.subject, command.line, command.files, command.words)
        return JSONResponse(job.as_json())

    async def cancel(self, request: Request) -> Response:
        """End a command that runs or waits."""
        number = (await _json(request)).get("number")
        self.jobs.cancel(number if isinstance(number, int) else -1)
        return JSONResponse({})

    async def upload(self, request: Request) -> Response:
        """Take a log into the folder."""
        name = await take(self.folder, request.path_params["name"], request.stream())
        self.jobs.tell()
        return JSONResponse({"log": name})

    async def file(self, request: Request) -> Response:
        """A file that a command wrote, as a download; never shown as a page of this server."""
        path = self._leaving(request)
        return FileResponse(path, filename=path.name, media_type="application/octet-stream")

    async def show(self, request: Request) -> Response:
        """A report, in a sandbox without access to this server."""
        path = self._leaving(request)
        if path.suffix != ".html":
            raise HTTPException(404)
        return FileResponse(path, media_type="text/html", headers={"content-security-policy": REPORT_POLICY})

    async def archive(self, request: Request) -> Response:
        """A dataset's folder as a ZIP archive."""
        text = request.path_params["path"]
        path = self.folder.root if text == "." else self.folder.inside(text)
        if not (path / DATASET_FILE).is_file():
            raise HTTPException(404)
        with tempfile.NamedTemporaryFile(suffix=".zip", delete=False) as made:
            target = Path(made.name)
        await asyncio.to_thread(zip_dataset, path, target)
        name = f"{path.resolve().name}.zip"
        return FileResponse(
            target, filename=name, media_type="application/zip", background=BackgroundTask(target.unlink)
        )

    def _leaving(self, request: Request) -> Path:
        path = self.folder.inside(request.path_params["path"])
        if path.suffix not in LEAVING or not path.is_file():
            raise HTTPException(404)
        return path

    def _arguments(self, name: str, asked: dict[str, Any]) -> dict[str, Any]:
        """The arguments of a look, with every path checked."""
        inside = self.folder.inside
        if name in ("columns", "checks"):
            known = {"columns": {}, "scale": {}, "rate": None, "split_gaps": False, "accept": []} | asked
            skipped = asked.get("skip_rows", 0)
            return known | {
                "skip_rows": skipped if isinstance(skipped, int) and skipped >= 0 else 0,
                "topic": _text(asked, "topic") if asked.get("topic") else None,
                "log": str(inside(_text(asked, "log"))),
                "robot": self.folder.robot(_text(asked, "robot")),
            }
        if name == "payload":
            mass = asked.get("mass")
            if not isinstance(mass, int | float):
                raise BenchError("mass: a number is needed")
            return {"robot": self.folder.robot(_text(asked, "robot")), "mass": float(mass)}
        if name == "parts":
            return {"model": str(inside(_text(asked, "model")))}
        if name == "runs":
            paths = _texts(asked, "paths")
            for path in paths:
                inside(path)
            return {"root": str(self.folder.root), "paths": paths}
        if name in ("dataset", "curves", "machine"):
            text = _text(asked, "dataset")
            data = self.folder.root if text == "." else inside(text)
            models = [
                (str(inside(_text(model, "path"))), _text(model, "name"), _text(model, "role"))
                for model in asked.get("models", [])
            ]
            known = {"dataset": str(data), "models": models}
            if name == "machine":
                known |= {"model": str(inside(_text(asked, "model"))), "recording": _text(asked, "recording")}
            return known
        raise HTTPException(404)


def application(pages: Pages) -> Starlette:
    """The server's application, without its guard."""
    return Starlette(
        routes=pages.routes(), exception_handlers=dict.fromkeys((BenchError, HTTPException), _fault)
    )


async def _fault(_request: Request, error: Exception) -> Response:
    if isinstance(error, HTTPException):
        return JSONResponse({"error": "there is no such thing here"}, error.status_code)
    return JSONResponse({"error": str(error)}, 400)


async def _json(request: Request) -> dict[str, Any]:
    """The JSON object of a request. Raises BenchError if it is none, or too large."""
    content = b""
    async for part in request.stream():
        content += part
        if len(content) > LARGEST_REQUEST:
            raise BenchError("the request is too large")
    try:
        body = json.loads(content)
    except (ValueError, RecursionError):
        body = None
    if not isinstance(body, dict):
        raise BenchError("the request is no JSON object")
    return body


def _text(asked: Any, key: str) -> str:
    value = asked.get(key) if isinstance(asked, dict) else None
    if not isinstance(value, str):
        raise BenchError(f"{key}: a text is needed")
    return value


def _texts(asked: dict[str, Any], key: str) -> list[str]:
    value = asked.get(key)
    if not isinstance(value, list) or not all(isinstance(entry, str) for entry in value):
        raise BenchError(f"{key}: a list of texts is needed")
    return value
