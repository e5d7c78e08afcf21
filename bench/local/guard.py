"""Access control of the server: only a browser on this machine that has the address with its token."""

import hmac
from collections.abc import Collection

from starlette.datastructures import Headers, MutableHeaders
from starlette.responses import PlainTextResponse
from starlette.types import ASGIApp, Message, Receive, Scope, Send

LOOPBACK = "127.0.0.1"

POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; connect-src 'self'; "
    "frame-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)
"""For the page: scripts and styles of this server only."""

REPORT_POLICY = "sandbox allow-scripts allow-downloads; frame-ancestors 'self'"
"""For a report: its file contains the policy for its contents; the sandbox isolates it from this server."""

HEADERS = {
    "cache-control": "no-store",
    "cross-origin-opener-policy": "same-origin",
    "cross-origin-resource-policy": "same-origin",
    "referrer-policy": "no-referrer",  # the token is part of the address
    "x-content-type-options": "nosniff",
}


class Guard:
    """Passes on requests that name this server as host, come from its page, and have the token in front of the path.

    All others are refused before their body is read. A request that passes goes on without the token.
    """

    def __init__(self, app: ASGIApp, token: str, port: int) -> None:
        self._app = app
        self._token = token
        self._hosts = {f"{name}:{port}" for name in (LOOPBACK, "localhost")}

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass on or refuse one request."""
        if scope["type"] == "lifespan":
            await self._app(scope, receive, send)
            return
        if scope["type"] != "http":
            return
        headers = Headers(scope=scope)
        token, _, rest = scope["path"].removeprefix("/").partition("/")
        if (why := _foreign(headers, self._hosts, scope["method"])) is not None:
            await _refuse(403, why)(scope, receive, send)
        elif not hmac.compare_digest(token.encode(), self._token.encode()):
            why = "Open the address that `bench open` printed, with all of its letters."
            await _refuse(404, why)(scope, receive, send)
        else:
            inner = {**scope, "path": f"/{rest}", "root_path": "", "raw_path": None}
            await self._app(inner, receive, _with_headers(send))


def _foreign(headers: Headers, hosts: Collection[str], method: str) -> str | None:
    """Why a request is not from this server's page; None if it is, or if a person opens the page."""
    if headers.get("host") not in hosts:
        return "This server answers to its own name alone."  # another name may resolve to this machine
    origin = headers.get("origin")
    if origin is not None and origin not in {f"http://{host}" for host in hosts}:
        return "This server does not answer other pages."
    opened = method == "GET" and headers.get("sec-fetch-mode") == "navigate"
    opened = opened and headers.get("sec-fetch-dest") == "document"
    if headers.get("sec-fetch-site", "none") not in ("none", "same-origin") and not opened:
        return "This server does not answer other pages."
    return None


def _refuse(status: int, why: str) -> PlainTextResponse:
    return PlainTextResponse(f"{why}\n", status, headers=HEADERS)


def _with_headers(send: Send) -> Send:
    async def sent(message: Message) -> None:
        if message["type"] == "http.response.start":
            headers = MutableHeaders(scope=message)
            for name, value in {"content-security-policy": POLICY, **HEADERS}.items():
                headers.setdefault(name, value)
        await send(message)

    return sent
