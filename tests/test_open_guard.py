"""Who may speak to `bench open`, and what nobody may reach through it: each way in is tried."""

import asyncio
import os
import socket
import time
from concurrent.futures import ThreadPoolExecutor

import pytest

from bench.basics.errors import BenchError
from bench.local.folder import Folder, take
from bench.local.server import _listening
from bench.local.steps import command_of
from tests.open_kit import opened

CSV = b"time,a\n0,1\n"


@pytest.fixture(scope="module")
def outside(tmp_path_factory):
    folder = tmp_path_factory.mktemp("outside")
    (folder / "secret.csv").write_bytes(b"secret")
    (folder / "secret.json").write_bytes(b'"secret"')
    return folder


@pytest.fixture(scope="module")
def root(tmp_path_factory, outside):
    folder = tmp_path_factory.mktemp("opened")
    (folder / "log.csv").write_bytes(CSV)
    (folder / ".hidden.csv").write_bytes(CSV)
    (folder / "program.py").write_text("raise SystemExit")
    (folder / "report.html").write_text("<script>alert(1)</script>")
    (folder / "link.json").symlink_to(outside / "secret.json")
    (folder / "links").symlink_to(outside, target_is_directory=True)
    (folder / "circle").symlink_to(folder / "circle")
    return folder


@pytest.fixture(scope="module")
def site(root):
    with opened(root) as one:
        yield one


def test_it_listens_to_this_machine_alone():
    with _listening(0) as listener:
        assert listener.getsockname()[0] == "127.0.0.1"


def test_a_taken_port_is_one_line():
    with _listening(0) as listener, pytest.raises(BenchError, match="in use"):
        _listening(listener.getsockname()[1])


def test_the_page_has_its_policy_and_leaves_no_trace(site):
    answer = site.get("")
    assert answer.status == 200
    policy = answer.headers["content-security-policy"]
    assert "default-src 'none'" in policy
    assert "unsafe" not in policy
    assert answer.headers["referrer-policy"] == "no-referrer"
    assert answer.headers["x-content-type-options"] == "nosniff"
    assert answer.headers["cache-control"] == "no-store"
    assert site.token.encode() not in answer.body


@pytest.mark.parametrize("path", ["/", "/api/folder", "/x/api/folder", "//api/folder", "/%2e/api/folder"])
def test_nothing_is_told_without_the_token(site, path):
    answer = site.ask("GET", path, bare=True)
    assert answer.status == 404
    assert b"log.csv" not in answer.body


def test_a_token_that_is_almost_right_is_wrong(site):
    for token in (site.token[:-1], site.token + "a", site.token.swapcase(), "é"):
        answer = site.ask("GET", f"/{token.encode('ascii', 'ignore').decode()}/api/folder", bare=True)
        assert answer.status == 404


@pytest.mark.parametrize(
    "headers",
    [
        {"Host": "evil.example"},
        {"Host": "evil.example:80"},
        {"Host": "127.0.0.1"},
        {"Origin": "http://evil.example"},
        {"Origin": "null"},
        {"Origin": "http://127.0.0.1:1"},
        {"Sec-Fetch-Site": "cross-site"},
        {"Sec-Fetch-Site": "same-site"},
        {"Sec-Fetch-Site": "cross-site", "Sec-Fetch-Mode": "navigate", "Sec-Fetch-Dest": "iframe"},
    ],
)
@pytest.mark.parametrize(
    ("method", "path"), [("GET", "api/folder"), ("POST", "api/run"), ("PUT", "api/logs/x.csv")]
)
def test_other_pages_and_names_are_refused(site, root, method, path, headers):
    assert site.ask(method, path, CSV, headers).status == 403
    assert not (root / "x.csv").exists()


def test_a_person_may_open_the_page_from_elsewhere_but_no_page_may_post(site):
    opens = {"Sec-Fetch-Site": "cross-site", "Sec-Fetch-Mode": "navigate", "Sec-Fetch-Dest": "document"}
    assert site.get("", **opens).status == 200
    assert site.ask("POST", "api/run", {}, opens).status == 403


def test_no_answer_lets_another_page_read_it(site):
    headers = site.get("api/folder", Origin=f"http://127.0.0.1:{site.port}").headers
    assert not [name for name in headers if name.startswith("access-control")]
    assert site.ask("OPTIONS", "api/run").status == 405


@pytest.mark.parametrize(
    "path",
    [
        "../outside0/secret.json",
        "..%2foutside0%2fsecret.json",
        "%2e%2e/outside0/secret.json",
        "a/../../outside0/secret.json",
        "/etc/passwd",
        "%2fetc%2fpasswd",
        "link.json",
        "links/secret.json",
        "circle",
        ".hidden.csv",
        "a%00.json",
        "..%5csecret.json",
        "program.py",
        "",
    ],
)
@pytest.mark.parametrize("kind", ["files", "show", "zip"])
def test_no_path_leads_out_of_the_folder(site, kind, path):
    answer = site.get(f"{kind}/{path}")
    assert answer.status in (400, 404)
    assert b'"secret"' not in answer.body
    assert b"SystemExit" not in answer.body


@pytest.mark.parametrize("path", ["../secret.csv", "links/secret.csv", "/etc/passwd", ".hidden.csv"])
def test_no_look_leads_out_of_the_folder(site, path):
    for name, asked in (
        ("columns", {"log": path, "robot": "five_bar"}),
        ("columns", {"log": "log.csv", "robot": path}),
        ("dataset", {"dataset": path}),
        ("runs", {"paths": [path]}),
    ):
        assert site.post(f"api/look/{name}", asked).status == 400


def test_what_lies_behind_links_is_not_listed(site):
    told = site.get("api/folder").json
    assert told["logs"] == ["log.csv"]


def test_a_file_is_kept_and_a_report_is_a_stranger(site):
    assert site.get("files/log.csv").headers["content-disposition"].startswith("attachment")
    shown = site.get("show/report.html")
    assert shown.headers["content-security-policy"].startswith("sandbox ")
    assert "allow-same-origin" not in shown.headers["content-security-policy"]
    assert site.get("show/log.csv").status == 404


@pytest.mark.parametrize("name", ["page.py", "..%2fpage.py", "..%2f..%2ffiles.py", "nothing.js"])
def test_only_what_belongs_to_the_page_is_an_asset(site, name):
    assert site.get(f"assets/{name}").status == 404


@pytest.mark.parametrize(
    ("name", "content", "says"),
    [
        ("evil.py", b"print()", "a log is one of"),
        ("evil.html", b"<script>", "a log is one of"),
        ("dataset.toml", b"robot = 'x'", "a log is one of"),
        ("..%2fup.csv", CSV, None),
        (".hidden2.csv", CSV, "give a name"),
        ("a%5Cb.csv", CSV, "give a name"),
        ("%3Cimg%20src=x%3E.py", CSV, "a log is one of"),
        ("log.csv", CSV + b"0,0\n", "another file of that name is in the folder already"),
        ("empty.csv", b"", "empty"),
        ("program.parquet", b"\x7fELF", "does not begin as"),
        ("program.mat", b"MZ", "does not begin as"),
        ("program.mcap", b"\x7fELF", "does not begin as"),
        ("program.bag", b"#!/bin/sh", "does not begin as"),
        ("program.csv", b"\x7fELF\0\0", "is no text"),
        ("book.csv", b"PK\x03\x04", "Excel"),
        ("program.xml", b"\x7fELF\0\0", "is no text"),
    ],
)
def test_only_logs_are_taken(site, root, name, content, says):
    before = sorted(os.listdir(root))
    answer = site.ask("PUT", f"api/logs/{name}", content)
    assert answer.status in (400, 404, 405)
    if says is not None:
        assert says in answer.json["error"]
    assert sorted(os.listdir(root)) == before


@pytest.mark.parametrize(
    ("name", "taken"),
    [
        ("-rf.csv", "log-rf.csv"),
        ("%3Cimg%20src=x%3E.csv", "_img src=x_.csv"),
        ("$(rm%20-r)%0A;%22'.csv", "_(rm -r)____.csv"),
        (f"{'q' * 200}%3F.CSV", f"{'q' * 116}.CSV"),
    ],
)
def test_a_log_of_an_odd_name_is_taken_under_a_plain_one(site, root, name, taken):
    answer = site.ask("PUT", f"api/logs/{name}", CSV)
    assert (answer.status, answer.json) == (200, {"log": taken})
    assert (root / taken).read_bytes() == CSV
    assert taken in site.get("api/folder").json["logs"]
    (root / taken).unlink()


def test_a_log_that_is_there_already_is_taken_as_it_is(site, root):
    content = (root / "log.csv").read_bytes()
    assert site.ask("PUT", "api/logs/log.csv", content).status == 200
    assert (root / "log.csv").read_bytes() == content


async def parts(*content):
    for one in content:
        yield one


def test_a_log_that_is_too_large_leaves_nothing(tmp_path):
    def taken():
        asyncio.run(take(Folder(tmp_path), "log.csv", parts(CSV, CSV * 4), largest=20))

    # a thread of its own: where a browser was driven before, this one has a loop already
    with ThreadPoolExecutor(1) as thread, pytest.raises(BenchError, match="larger than"):
        thread.submit(taken).result()
    assert os.listdir(tmp_path) == []


def test_a_log_that_breaks_off_leaves_nothing(site, root):
    before = sorted(os.listdir(root))
    with socket.create_connection(("127.0.0.1", site.port)) as connection:
        head = f"PUT /{site.token}/api/logs/half.csv HTTP/1.1\r\nHost: 127.0.0.1:{site.port}\r\n"
        connection.sendall(f"{head}Content-Length: 1000\r\n\r\n".encode() + CSV)
    for _ in range(200):
        if sorted(os.listdir(root)) == before:
            break
        time.sleep(0.02)
    assert sorted(os.listdir(root)) == before


@pytest.mark.parametrize(
    "asked",
    [
        {},
        {"step": "sweep"},
        {"step": "compare"},
        {"step": "compare", "dataset": "--help"},
        {"step": "compare", "dataset": ".."},
        {"step": "compare", "dataset": ".", "models": ["../secret.json"]},
        {"step": "identify", "dataset": ".", "effects": ["--effect-file=x.py"]},
        {"step": "export", "dataset": ".", "model": "../secret.json", "form": "mjcf"},
        {"step": "export", "dataset": ".", "model": "model.json", "form": "exe"},
        {
            "step": "import",
            "log": "log.csv",
            "robot": "five_bar",
            "dataset": "x",
            "columns": {},
            "topic": "/a\nb",
        },
        {
            "step": "import",
            "log": "log.csv",
            "robot": "five_bar",
            "dataset": "x",
            "columns": {},
            "payload": "a",
            "payload_mass": 1.0,
            "payload_center": [0.0, 1.0],
        },
        {"step": "robot", "robot": "/"},
        {"step": "new robot", "model": "../x.xml", "name": "x", "motors": [["a", 1.0]]},
        {"step": "new robot", "model": "x.xml", "name": "../x", "motors": [["a", 1.0]]},
        {"step": "new robot", "model": "x.xml", "name": "x", "motors": [["a\nb", 1.0]]},
        {"step": "new robot", "model": "x.xml", "name": "x", "motors": []},
        {"step": "robot", "robot": "--help"},
        {"step": "import", "log": "log.csv", "robot": "five_bar", "dataset": "../x", "columns": {}},
        {"step": "import", "log": "log.csv", "robot": "five_bar", "dataset": "x", "columns": {"a": "b\nc"}},
        {
            "step": "import",
            "log": "log.csv",
            "robot": "five_bar",
            "dataset": "x",
            "columns": {},
            "output": "/",
        },
        {
            "step": "import",
            "log": "log.csv",
            "robot": "five_bar",
            "dataset": "x",
            "columns": {},
            "payload": "a\nb",
        },
    ],
)
def test_only_the_page_s_own_commands_are_run(site, root, asked):
    answer = site.post("api/run", asked)
    assert answer.status == 400
    assert answer.json["error"]
    assert site.get("api/folder").json["datasets"] == []


def test_a_request_that_is_no_request_is_refused(site):
    for body in (b"", b"[]", b"{", b"\xff", b"[" * 100_000, b'{"step": ' + b" " * 1_100_000 + b"1}"):
        assert site.ask("POST", "api/run", body).status == 400


def test_a_name_is_never_taken_for_an_option(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert Folder(tmp_path).word(tmp_path / "-o.csv") == "./-o.csv"


def test_results_are_not_written_through_a_link(tmp_path, outside):
    folder = tmp_path / "data"
    folder.mkdir()
    (folder / "dataset.toml").write_text("")
    (tmp_path / "data.results").symlink_to(outside)
    with pytest.raises(BenchError, match="symbolic link"):
        command_of(Folder(tmp_path), {"step": "compare", "dataset": "data"})
