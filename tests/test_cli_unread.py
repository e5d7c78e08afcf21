"""A reader who leaves early, as `head` does, loses nothing: files are complete, and nothing is complained of."""

import json
import os
import subprocess
import sys
from contextlib import redirect_stderr, redirect_stdout
from io import StringIO

import pytest

from bench.cli import main

SWEEP = """
base = "two_link"
seeds = 2
[scenario]
"design.optimise" = false
"design.duration" = 4.0
"""
FILES = {
    "identify": ["identify", "{data}", "--json", "{out}/model.json", "-o", "{out}"],
    "compare": ["compare", "{data}", "--json", "{out}/compared.json", "-o", "{out}"],
    "diagnose": [
        "diagnose",
        "{data}",
        "--json",
        "{out}/diagnosis.json",
        "--apply",
        "{out}/model.json",
        "-o",
        "{out}",
    ],
    "sweep": ["sweep", "{sweep}", "-o", "{out}", "--workers", "1"],
    "trial": [
        "trial",
        "two_link",
        *("--kinds", "one", "--effects", "viscous_friction", "--seeds", "1", "--duration", "6"),
        *("--workers", "1", "-o", "{out}"),
    ],
}
LAST = {
    "identify": ["model.json", "report.html"],
    "compare": ["compared.json", "report.html"],
    "diagnose": ["diagnosis.json", "model.json", "errors.png", "report.json", "report.html"],
    "sweep": ["runs.parquet", "summary.md", "report.html"],
    "trial": ["two_link.parquet", "two_link.md"],
}


def unread_here(arguments):
    """The command in this process, with a standard output that nobody reads: exit code and complaints."""
    reader, writer = os.pipe()
    os.close(reader)
    with os.fdopen(writer, "w") as stream, redirect_stdout(stream), redirect_stderr(StringIO()) as complaints:
        code = main(arguments)
        stream.write("Nobody reads this.")  # nor does the end of the stream complain
    return code, complaints.getvalue()


def unread(arguments):
    """The same in a process of its own, whose last words Python flushes when it ends."""
    reader, writer = os.pipe()
    os.close(reader)
    command = [sys.executable, "-m", "bench", *arguments]
    with subprocess.Popen(command, stdout=writer, stderr=subprocess.PIPE, text=True) as process:
        os.close(writer)
        complaints = process.communicate()[1]
    return process.returncode, complaints


@pytest.mark.parametrize("name", FILES)
def test_files_are_complete(name, arm, tmp_path):
    out = tmp_path / "out"
    out.mkdir()
    (tmp_path / "sweep.toml").write_text(SWEEP)
    arguments = [one.format(data=arm / "data", out=out, sweep=tmp_path / "sweep.toml") for one in FILES[name]]
    assert (unread if name == "identify" else unread_here)(arguments) == (0, "")
    for file in LAST[name]:
        path = out / file
        assert path.stat().st_size > 0
        if path.suffix == ".json":
            json.loads(path.read_text())
        elif path.suffix == ".html":
            assert path.read_text().rstrip().endswith("</html>")
    if name == "diagnose":  # the folder is whole
        assert main(["report", str(out), "-o", str(tmp_path / "page.html")]) == 0


def test_a_mistake_is_told_all_the_same():
    code, complaints = unread(["identify", "nowhere"])
    assert code == 2
    assert complaints.count("\n") == 1
    assert "nowhere" in complaints
