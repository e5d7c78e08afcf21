"""`bench open` in a process of its own, and a client that sends what it is told to, as no browser would."""

import http.client
import json
import subprocess
import sys
from contextlib import contextmanager
from dataclasses import dataclass
from urllib.parse import urlsplit

import numpy as np

from bench.dataset.dataset import load_dataset
from bench.truth.dataset import write_simulation
from bench.truth.simulate import simulate
from tests.hidden_kit import scenario

OVER = ("done", "refused", "cancelled", "ended")


@dataclass
class Answer:
    status: int
    headers: dict
    body: bytes

    @property
    def json(self):
        return json.loads(self.body)


@dataclass
class Site:
    """A server that runs. address: of its page, with the token."""

    address: str
    process: subprocess.Popen

    @property
    def port(self):
        return urlsplit(self.address).port

    @property
    def token(self):
        return urlsplit(self.address).path.strip("/")

    def ask(self, method, path, body=None, headers=None, *, bare=False):
        """One request; path: below the token, or all of it where `bare`."""
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=120)
        given = {"Host": f"127.0.0.1:{self.port}", **(headers or {})}
        connection.putrequest(method, path if bare else f"/{self.token}/{path}", skip_host=True)
        content = json.dumps(body).encode() if isinstance(body, dict | list) else body or b""
        given.setdefault("Content-Length", str(len(content)))
        for name, value in given.items():
            connection.putheader(name, value)
        connection.endheaders(content)
        response = connection.getresponse()
        answer = Answer(response.status, {k.lower(): v for k, v in response.getheaders()}, response.read())
        connection.close()
        return answer

    def get(self, path, **headers):
        return self.ask("GET", path, headers=headers)

    def post(self, path, body):
        return self.ask("POST", path, body)

    def jobs(self):
        """What the server tells of its jobs, again and again."""
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=120)
        connection.request("GET", f"/{self.token}/events")
        response = connection.getresponse()
        try:
            while line := response.readline():
                if line.startswith(b"data: "):
                    yield json.loads(line[6:])
        finally:
            connection.close()

    def started(self, step):
        """The job of a step that was asked for."""
        answer = self.post("api/run", step)
        assert answer.status == 200, answer.body
        return answer.json

    def run(self, step):
        """A step's job once it is over."""
        number = self.started(step)["number"]
        return self.until(lambda job: job["number"] == number and job["state"] in OVER)

    def workers(self):
        """Numbers of the processes that the server has started to work."""
        words = ["ps", "-wweo", "pid=,ppid=,args="]
        listed = subprocess.run(words, capture_output=True, text=True, check=True).stdout
        rows = [line.split(None, 2) for line in listed.splitlines()]
        return [
            int(pid) for pid, parent, line in rows if int(parent) == self.process.pid and "spawn_main" in line
        ]

    def until(self, wanted):
        """The first job that is as wanted."""
        return next(job for jobs in self.jobs() for job in jobs if wanted(job))


@contextmanager
def opened(folder, *options, cwd=None):
    """Serve a folder while inside; it ends as by Ctrl+C."""
    program = "import signal, sys; signal.signal(signal.SIGINT, signal.default_int_handler)\n"
    program += "from bench.cli import main\nif __name__ == '__main__':\n    sys.exit(main(sys.argv[1:]))"
    words = [sys.executable, "-c", program, "open", str(folder), "--no-browser", *map(str, options)]
    with subprocess.Popen(
        words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=cwd
    ) as process:
        line = process.stdout.readline()
        try:
            assert line.startswith("Open http://"), process.stderr.read() if process.poll() else line
            yield Site(line.split()[1], process)
        finally:
            process.terminate()
            process.communicate(timeout=30)


def write_log(path, dataset, recording):
    """A recording as a controller would log it: other names, milliseconds, degrees, and a column nobody needs."""
    one = next(r for r in dataset.recordings if r.name == recording)
    columns = {"t_ms": one.time * 1e3}
    for j, joint in enumerate(dataset.robot.joints):
        columns[f"q_{joint}"] = np.degrees(one.position[:, j])
        columns[f"i_{joint}"] = one.current[:, j]
    columns["supply"] = np.full(len(one.time), 48.0) + 0.01 * np.sin(one.time)
    header = ",".join(columns)
    np.savetxt(
        path, np.column_stack(list(columns.values())), delimiter=",", header=header, comments="", fmt="%.12g"
    )


def short_dataset(folder):
    """Write a dataset with viscous friction at one motor that no model is told of; short, so that fits are quick."""
    hidden = {"effect": "viscous_friction", "joint": "left", "Fv": 0.3}
    design = {"optimise": False, "duration": 5.0, "ramp": 0.5}
    write_simulation(simulate(scenario("five_bar", [hidden], design=design), threads=1), folder)
    return load_dataset(folder)
