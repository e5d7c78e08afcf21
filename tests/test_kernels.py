"""`make test-kernels` runs what it can, says what it cannot, and keeps to what the environment prescribes."""

from fnmatch import fnmatch

from tests import kernels


def test_each_kernel_runs_once_and_what_does_not_run_is_said():
    chosen, said = kernels.plan(
        {"Haswell": "Haswell", "Zen": "Haswell", "SkylakeX": None, "Prescott": "Katmai"}
    )
    assert chosen == {"Haswell": "Haswell", "Prescott": "Katmai"}
    assert said == [
        "Zen: runs as Haswell here, as Haswell does",
        "SkylakeX: this processor cannot run it, or numpy has no OpenBLAS",
    ]


def test_a_kernel_that_the_environment_prescribes_stays(monkeypatch, capsys):
    monkeypatch.setenv(kernels.CHOICE, "Haswell")
    monkeypatch.setattr(kernels, "running", lambda kernel: kernel)
    assert kernels.main() == 0
    assert capsys.readouterr().out == "OPENBLAS_CORETYPE is 'Haswell' already: no other kernel is tried\n"


def test_what_is_left_out_exists_and_what_computes_is_not_left_out(project_root):
    names = [path.stem.removeprefix("test_") for path in (project_root / "tests").glob("test_*.py")]
    numeric = {name for name in names if not any(fnmatch(name, one) for one in kernels.OTHERS)}
    assert all(any(fnmatch(name, one) for name in names) for one in kernels.OTHERS)
    assert {"identify", "diagnose", "rounding", "workbench", "effects_fit", "truth_physics"} <= numeric
