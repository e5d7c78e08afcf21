"""A server that ends: whoever waits for an answer gets one that says so."""

import asyncio
import socket
from collections.abc import Callable
from http import HTTPStatus

import uvicorn
from starlette.responses import JSONResponse
from starlette.types import ASGIApp, Message, Receive, Scope, Send

ENDING = "`bench open` is being ended; start it again, what was found lies in the folder"


class EndingServer(uvicorn.Server):
    """A server that closes what its requests wait for before it waits for its requests."""

    def __init__(self, config: uvicorn.Config, close: Callable[[], None]) -> None:
        super().__init__(config)
        self._close = close

    async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
        """End in order."""
        await asyncio.to_thread(self._close)
        await super().shutdown(sockets)


def answered_at_the_end(app: ASGIApp) -> ASGIApp:
    """The application; a request that is cut off by the server's end is answered with 503, and what that means."""

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
