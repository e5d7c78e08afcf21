"""`bench open` that ends while somebody waits for it: every request gets an answer that says so."""

import json
import os
import signal
import socket
import sys

import pytest

from tests.open_kit import opened

ROBOT = {"robot": "five_bar", "mass": 0.5}
pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX")


def begun(site, length):
    """A connection whose request the server has begun to answer: it asks for the body."""
    connection = socket.create_connection(("127.0.0.1", site.port))
    connection.settimeout(120)
    head = f"POST /{site.token}/api/look/payload HTTP/1.1\r\nHost: 127.0.0.1:{site.port}\r\n"
    connection.sendall(f"{head}Expect: 100-continue\r\nContent-Length: {length}\r\n\r\n".encode())
    assert connection.recv(1000).startswith(b"HTTP/1.1 100")
    return connection


def answer(connection):
    """Status and content of what comes until the server closes the connection."""
    got = b""
    with connection:
        while part := connection.recv(10_000):
            got += part
    head, _, body = got.partition(b"\r\n\r\n")
    return int(head.split()[1]), json.loads(body)


def test_who_waits_for_a_worker_when_the_server_ends_is_told(tmp_path):
    body = json.dumps(ROBOT).encode()
    with opened(tmp_path, cwd=tmp_path) as site:
        assert site.post("api/look/payload", ROBOT).status == 200  # its worker is there
        for number in site.workers():
            os.kill(number, signal.SIGSTOP)
        connection = begun(site, len(body))
        connection.sendall(body)
        site.process.send_signal(signal.SIGINT)
        status, said = answer(connection)
        assert status in (400, 503)  # told by the worker that is closed, or by the server
        assert "is being ended" in said["error"]
        site.process.wait(timeout=120)


def test_who_still_asks_when_the_server_ends_is_told(tmp_path):
    with opened(tmp_path, cwd=tmp_path) as site:
        connection = begun(site, 10)
        site.process.send_signal(signal.SIGINT)
        status, said = answer(connection)
        assert status == 503
        assert "is being ended" in said["error"]
