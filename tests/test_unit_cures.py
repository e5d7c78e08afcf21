"""Which unit an import proposes: that of the header, else the guess, at one joint where the others are right."""

from pathlib import Path

import numpy as np
import pytest

from bench.cli import main
from bench.dataset.dataset import load_dataset
from bench.dataset.joint_facts import joint_facts
from bench.dataset.logs.units import UNITS, unit_named
from bench.dataset.robot import load_robot

COUNT = 1000


def import_crank(
    tmp_path: Path, carriage: float, *options: str, names=("x", "i1", "i2"), milli=1.0, time="t", empty=0
) -> int:
    """Import a log of the robot crank_slide with its carriage in other units, or its first current."""
    stamps = np.arange(COUNT) / 100.0
    rng = np.random.default_rng(1)
    columns = [stamps]
    for j, joint in enumerate(joint_facts(load_robot("crank_slide"))):
        at = 0.5 * (joint.lower + joint.upper)
        wide = 0.3 * (joint.upper - joint.lower)
        columns.append((at + wide * np.sin(2.0 * stamps)) * (carriage if j else 1.0))
    for j in range(2):
        scaled = milli if j == 0 else 1.0
        columns.append(scaled * (2.0 * np.cos(3.0 * stamps) + 0.01 * rng.normal(size=COUNT)))
    header = [time, "q", *names]
    log = tmp_path / "log.csv"
    rows = [[f"{value:.9g}" for value in row] for row in zip(*columns, strict=True)]
    if empty:
        rows[empty][1:] = [""] * (len(rows[empty]) - 1)
    log.write_text("\n".join(";".join(row) for row in [header, *rows]))
    targets = ("time", "position.crank", "position.carriage", "current.crank", "current.carriage")
    words = [
        word for target, name in zip(targets, header, strict=True) for word in ("--map", f"{target}={name}")
    ]
    return main(
        ["import", str(log), "--robot", "crank_slide", *words, *options, "-o", str(tmp_path / "data")]
    )


@pytest.mark.parametrize(
    ("carriage", "names", "milli", "cure"),
    [
        (1e2, ("x", "i1", "i2"), 1.0, "looks like centimetres, metres are expected"),
        (1e2, ("x", "i1", "i2"), 1.0, "; add --scale position=cm"),
        (
            1e3,
            ("x [furlong]", "i1", "i2"),
            1.0,
            "'furlong', which is not a known unit: add --scale position.carr",
        ),
        (1e3, ("x_cm", "i1", "i2"), 1.0, "its name says cm: add --scale position.carriage=cm"),
        (1.0, ("x", "i1", "i2"), 1e3, "add --scale current.crank=mA"),
        (1.0, ("x", "i1 [A]", "i2 [mA]"), 1e3, "add --scale current.crank=mA --scale current.carriage=A"),
    ],
)
def test_the_cure_names_the_joint_and_respects_the_header(tmp_path, capsys, carriage, names, milli, cure):
    assert import_crank(tmp_path, carriage, names=names, milli=milli) == 2
    assert cure in capsys.readouterr().err


@pytest.mark.parametrize(("options", "name"), [((), "x [cm]"), (("--scale", "position=cm"), "x")])
def test_centimetres_are_a_unit(tmp_path, options, name):
    assert import_crank(tmp_path, 1e2, *options, names=(name, "i1", "i2")) == 0
    joint = joint_facts(load_robot("crank_slide"))[1]
    (recording,) = load_dataset(tmp_path / "data").recordings
    assert joint.lower < recording.position[:, 1].min()
    assert recording.position[:, 1].max() < joint.upper


def test_a_scale_takes_the_spellings_of_a_header(tmp_path):
    assert import_crank(tmp_path, 1.0, "--scale", "time=µs") == 2
    assert unit_named("min") is UNITS["min"]
    assert unit_named("[cm]") is UNITS["cm"]
    assert import_crank(tmp_path, 1.0, "--scale", "position.crank=rad") == 0


@pytest.mark.parametrize(
    ("options", "name", "milli"),
    [((), "i1 [mA]", 1e3), (("--scale", "current=mA"), "i1", 1e3), ((), "i1", 1.0)],
)
def test_minus_one_changes_the_sign_and_keeps_the_unit(tmp_path, options, name, milli):
    for folder, sign in (("as_it_is", ()), ("reversed", ("--scale", "current.crank=-1"))):
        (tmp_path / folder).mkdir()
        assert (
            import_crank(tmp_path / folder, 1.0, *options, *sign, names=("x", name, "i2"), milli=milli) == 0
        )
    plain, turned = (
        load_dataset(tmp_path / folder / "data").recordings[0].current for folder in ("as_it_is", "reversed")
    )
    assert np.abs(plain[:, 0]).max() < 3.0
    np.testing.assert_allclose(turned, plain * [-1.0, 1.0], rtol=1e-12)


def test_a_time_too_short_in_its_unit_names_the_unit_of_the_header(tmp_path, capsys):
    assert import_crank(tmp_path, 1.0, "--scale", "time=ns") == 2
    assert "give another unit than --scale time=ns" in capsys.readouterr().err
    assert import_crank(tmp_path, 1.0, time="t [ns]") == 2
    assert "turned from ns, as the log says: if that is wrong, add --scale time=ms" in capsys.readouterr().err


def test_an_empty_row_is_one_line(tmp_path, capsys):
    assert import_crank(tmp_path, 1.0, empty=500) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert "line 502: is empty, likewise in position.carriage, current.crank, current.carriage" in line


def test_a_column_that_is_mapped_already_is_not_proposed(tmp_path, capsys):
    assert import_crank(tmp_path, 1.0, "--map", "temperature=i3") == 2
    assert "did you mean" not in capsys.readouterr().err


@pytest.mark.parametrize("command", [["import", "log.csv"], ["excite", "two_link", "-o", "plan"]])
def test_a_decimal_comma_is_called_so(command, capsys):
    assert main([*command, "--payload-mass", "1,2"]) == 2
    assert "'1,2' is no number: write the decimal point as in 1.2" in capsys.readouterr().err
