"""The measured EMPS data, imported and identified by command: the published table to the last digit printed."""

import json
from pathlib import Path
from typing import Any

import pytest

from bench.cli import main
from bench.effects import CATALOGUE

PUBLISHED_FILTERS = [
    "--position-cutoff",
    "100",
    "--decimation",
    "10",
    "--difference-order",
    "2",
    "--border",
    "49,0",
]
EFFECTS = ["--with", "viscous_friction", "--with", "coulomb_friction", "--with", "constant_offset"]


def test_import_and_identify_give_the_published_table(
    measured_data: Path, project_root: Path, tmp_path: Path
) -> None:
    log = measured_data / "emps" / "DATA_EMPS.mat"
    if not log.is_file():
        pytest.skip("the measured EMPS data are not here (set PARABENCH_DATA)")
    columns = ["--map", "position.axis=qm", "--map", "current.axis=vir", "--map", "time=t"]
    assert main(["import", str(log), "--robot", "emps", *columns, "-o", str(tmp_path / "emps")]) == 0
    answer = tmp_path / "emps.json"
    settings = [*PUBLISHED_FILTERS, "--keep-standstill", "--deviations", "independent", "--method", "ls"]
    assert main(["identify", str(tmp_path / "emps"), *EFFECTS, *settings, "--json", str(answer)]) == 0
    model = json.loads(answer.read_text())
    mass = model["parameters"][0]
    effects = {
        name: next(iter(joints["axis"].values())) for name, joints in model["effect_parameters"].items()
    }
    found = {
        "M": (mass["value"], mass["std"]),
        "Fv": (effects["viscous_friction"]["value"], effects["viscous_friction"]["std"]),
        "Fc": (effects["coulomb_friction"]["value"], effects["coulomb_friction"]["std"]),
        "offset": (effects["constant_offset"]["value"], effects["constant_offset"]["std"]),
    }
    assert {name: (f"{value:.4f}", f"{std:.4f}") for name, (value, std) in found.items()} == {
        "M": ("95.1089", "0.1085"),
        "Fv": ("203.5034", "1.1460"),
        "Fc": ("20.3935", "0.1012"),
        "offset": ("-3.1648", "0.0444"),
    }
    stored = json.loads((project_root / "results" / "measured" / "published" / "emps.json").read_text())
    for key in ("parameters", "effect_parameters"):  # the page on trust tells these
        assert _digits(stored[key]) == _digits(model[key])
    assert f"{stored['condition']:.4f} {100 * stored['error']['identify']:.4f}" == "25.9883 4.0834"
    assert f"{model['condition']:.4f}" == "25.9883"
    assert f"{100 * model['error']['identify']:.4f}" == "4.0834"
    kept = {
        "value": 35.15065,
        "std": 0.0,
        "unit": "N/V",
        "nominal": 35.15065,
        "fitted": False,
        "determined": False,
    }
    assert model["drive_gains"]["axis"] == kept


def _digits(value: Any) -> Any:
    """Plain data with every number to the digits of the paper."""
    if isinstance(value, dict):
        return {key: _digits(part) for key, part in value.items()}
    if isinstance(value, list):
        return [_digits(part) for part in value]
    return f"{value:.4f}" if isinstance(value, float) else value


@pytest.mark.slow
def test_diagnosis_climbs_from_inertia_alone_with_signs_that_can_be(
    measured_data: Path, tmp_path: Path
) -> None:
    log = measured_data / "emps" / "DATA_EMPS.mat"
    if not log.is_file():
        pytest.skip("the measured EMPS data are not here (set PARABENCH_DATA)")
    columns = ["--map", "position.axis=qm", "--map", "current.axis=vir", "--map", "time=t"]
    assert main(["import", str(log), "--robot", "emps", *columns, "-o", str(tmp_path / "emps")]) == 0
    assert main(["diagnose", str(tmp_path / "emps"), "--json", str(tmp_path / "answer.json")]) == 0
    answer = json.loads((tmp_path / "answer.json").read_text())
    assert answer["ladder"][0]["error"]["validate"] > 0.5
    assert (
        answer["ladder"][-1]["error"]["validate"] < 0.0408
    )  # the published model's, on the data it was fitted to
    for name, joints in answer["after"]["effect_parameters"].items():
        known = CATALOGUE[name].parameters if name in CATALOGUE else ()  # of a law that was found, none
        for parameter in known:
            value = joints["axis"][parameter.name]
            assert not parameter.positive or value["value"] > -3.0 * value["std"], (name, parameter.name)
