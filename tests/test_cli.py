"""The command `bench`: its table of commands, its help, its exit codes."""

import os
import signal
import subprocess
import sys
import time
from importlib.metadata import version

import click
import pytest

from bench import cli
from bench.basics.errors import BenchError
from bench.basics.files.atomic import atomic_path
from bench.cli.lazy import LazyCommand, LazyGroup

SLOW = {
    "jinja2",
    "matplotlib",
    "rerun",
    "scipy.interpolate",
    "scipy.io",
    "scipy.optimize",
    "scipy.signal",
    "scipy.sparse",
    "scipy.spatial",
    "scipy.stats",
}
SCIPY = tuple(int(part) for part in version("scipy").split(".")[:2])
HEAVY = {"matplotlib", "mujoco", "numpy", "pinocchio", "pyarrow", "pydantic", "rerun", "rich", "scipy"}


@pytest.fixture
def command(monkeypatch):
    """Give the group one command, `probe`, that runs a function."""

    def install(function):
        probe = click.Command("probe", callback=function, params=[click.Option(["--count"], type=int)])
        monkeypatch.setattr(LazyCommand, "load", lambda _: probe)
        monkeypatch.setattr(cli.cli, "lazy_commands", {"probe": LazyCommand("anywhere:probe", "Probe.")})

    return install


def heavy_imports(*arguments):
    """The slow packages that a new process imports to run `bench` with these arguments."""
    program = (
        "import sys; from bench.cli import main\n"
        f"main({list(arguments)!r})\n"
        f"print('imported:', *sorted({HEAVY!r} & set(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    return done.stdout.rpartition("imported:")[2].split()


@pytest.mark.parametrize("name", cli.COMMANDS)
def test_help_in_the_table_is_the_command_s_own(name):
    lazy = cli.COMMANDS[name]
    assert lazy.load().get_short_help_str(limit=200) == lazy.help
    assert len(lazy.help) <= 65, "does not fit one line of an 80-column terminal"


@pytest.mark.parametrize("name", cli.COMMANDS)
def test_name_in_the_table_is_the_command_s_own(name):
    assert cli.COMMANDS[name].load().name == name


def test_help_lists_every_command_and_imports_nothing_heavy(capsys):
    assert cli.main(["--help"]) == 0
    text = capsys.readouterr().out
    assert [name for name in cli.COMMANDS if f"\n  {name} " not in text] == []
    assert heavy_imports("--help") == []


@pytest.mark.parametrize(
    ("typed", "name"),
    [
        ("/opt/bin/bench", "bench"),
        ("/opt/bin/parabench", "parabench"),
        ("parabench.exe", "parabench"),
        ("/opt/bench/__main__.py", "bench"),
        ("pytest", "bench"),
    ],
)
def test_help_and_version_say_the_name_that_was_typed(typed, name):
    def said(argument):
        program = f"import sys; from bench.cli import main; sys.argv = [{typed!r}]; main([{argument!r}])"
        done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
        return done.stdout + done.stderr

    assert said("--help").startswith(f"Usage: {name} [OPTIONS]")
    assert said("--version") == f"{name}, version {version('parabench')}\n"
    assert said("diagnos").rstrip().endswith(f"(see: {name} --help)")


@pytest.mark.parametrize("name", cli.COMMANDS)
def test_help_of_a_command_imports_nothing_heavy(name):
    assert heavy_imports(name, "--help") == []


@pytest.mark.parametrize("name", ["identify", "diagnose"])
def test_what_is_slow_to_import_and_not_needed_is_not_imported(name, tmp_path):
    program = (
        "import sys; from bench.cli import main\n"
        f"code = main([{name!r}, {str(tmp_path / 'nothing')!r}])\n"
        f"print(code, *sorted({SLOW!r} & set(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    own = {"scipy.sparse"} if SCIPY < (1, 17) else set()  # older ones import it themselves
    code, *imported = done.stdout.split()
    assert (code, {*imported} - own) == ("2", set())


def test_what_simulates_and_what_writes_a_page_imports_nothing_slow():
    modules = "bench.studies.sweep.work, bench.studies.trial.work, bench.page.write"
    program = f"import sys, {modules}; print(*sorted({SLOW!r} & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    own = {"jinja2", *(["scipy.sparse"] if SCIPY < (1, 17) else [])}  # pages are made of templates
    assert {*done.stdout.split()} - own == set()


def test_a_diagnosis_of_recordings_in_memory_imports_no_reader_of_files():
    modules = "bench.dataset.dataset, bench.diagnosis.catalogue_search, bench.diagnosis.discovery.find"
    program = f"import sys, {modules}; print(*sorted({HEAVY!r} & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["mujoco", "numpy", "pinocchio", "pydantic", "scipy"]


def test_import_bench_is_light():
    program = f"import sys, bench; print(*sorted({HEAVY!r} & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout.split() == []


def test_success(command, capsys):
    command(lambda count: click.echo(f"done {count}"))
    assert cli.main(["probe", "--count", "3"]) == 0
    assert capsys.readouterr() == ("done 3\n", "")


def test_user_mistake_is_one_line_and_exit_code_2(command, capsys):
    def fail(count):
        raise BenchError(f"unloaded.csv: column current.left,\n  row {count}: not a number")

    command(fail)
    assert cli.main(["probe", "--count", "7"]) == 2
    assert capsys.readouterr() == ("", "bench: unloaded.csv: column current.left, row 7: not a number\n")


def test_bug_keeps_its_traceback(command):
    command(lambda count: 1 / count)
    with pytest.raises(ZeroDivisionError):
        cli.main(["probe", "--count", "0"])


@pytest.mark.parametrize(
    ("arguments", "culprit", "hint"),
    [
        (["nonsense"], "nonsense", "bench --help"),
        (["probe", "--nonsense"], "--nonsense", "bench probe --help"),
        (["probe", "--count", "many"], "many", "bench probe --help"),
        (["probe", "surplus"], "surplus", "bench probe --help"),
    ],
)
def test_wrong_usage_is_one_line_and_exit_code_2(command, capsys, arguments, culprit, hint):
    command(lambda count: count)
    assert cli.main(arguments) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.count("\n") == 1
    assert culprit in err
    assert hint in err


def test_interrupt_is_one_line_and_exit_code_130(command, capsys, tmp_path):
    def interrupted(count):
        with atomic_path(tmp_path / "answer.json") as partial:
            partial.write_text("{")
            raise KeyboardInterrupt

    command(interrupted)
    assert cli.main(["probe"]) == 130
    out, err = capsys.readouterr()
    assert out == ""
    assert err.strip() == "bench: interrupted"
    assert os.listdir(tmp_path) == []


@pytest.mark.parametrize(
    ("number", "exit_code", "line"),
    [(signal.SIGINT, 130, "bench: interrupted"), (signal.SIGTERM, 143, "bench: terminated")],
)
def test_signal_to_a_process_leaves_no_half_written_file(tmp_path, number, exit_code, line):
    program = f"""
import signal, sys, time
import click
from bench import cli
signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell's background jobs start with it ignored
from bench.cli.lazy import LazyCommand
from bench.basics.files.atomic import atomic_path

def wait():
    with atomic_path({str(tmp_path / "answer.json")!r}) as partial:
        partial.write_text("half")
        print("writing", flush=True)
        time.sleep(60)

LazyCommand.load = lambda _: click.Command("probe", callback=wait)
cli.cli.lazy_commands = {{"probe": LazyCommand("anywhere:probe", "Probe.")}}
sys.exit(cli.main(["probe"]))
"""
    with subprocess.Popen(
        [sys.executable, "-c", program], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as process:
        assert process.stdout.readline() == "writing\n"
        assert len(os.listdir(tmp_path)) == 1
        time.sleep(0.1)
        process.send_signal(number)
        _, err = process.communicate(timeout=30)
    assert process.returncode == exit_code
    assert err.strip() == line
    assert os.listdir(tmp_path) == []


def test_version_and_module(project_root):
    version = [
        line for line in (project_root / "pyproject.toml").read_text().splitlines() if "version = " in line
    ]
    done = subprocess.run(
        [sys.executable, "-m", "bench", "--version"], capture_output=True, text=True, check=True
    )
    assert done.stdout.split()[-1] == version[0].split('"')[1]


def test_a_target_that_is_no_command_is_a_bug():
    with pytest.raises(TypeError, match="not a click command"):
        LazyCommand("bench.basics.errors:BenchError", "No command.").load()


def test_commands_are_listed_in_the_order_of_the_table():
    table = {name: LazyCommand("anywhere:nothing", "Help.") for name in ("zeta", "alpha")}
    group = LazyGroup("group", lazy_commands=table)
    assert group.list_commands(click.Context(group)) == ["zeta", "alpha"]
