"""Friction that a robot's own file gives its joints is dry in the simulated machine, and is named there."""

import shutil
from pathlib import Path

import numpy as np

from bench.api.diagnose import diagnose
from bench.scenario.scenario import load_scenario
from bench.truth.dataset import as_dataset
from bench.truth.machine import build_machine
from bench.truth.simulate import simulate

DESIGN = {"design": {"optimise": False, "duration": 8.0}}


def test_friction_and_armature_of_a_file_as_exporters_write_them_are_named(
    project_root: Path, tmp_path: Path
) -> None:
    """MuJoCo's default for such friction is soft: full only beyond 0.1 rad/s, which no law of the catalogue is."""
    folder = shutil.copytree(project_root / "robots" / "five_bar", tmp_path / "five_bar")
    model = folder / "five_bar.xml"
    written = model.read_text()
    assert written.count('<joint type="hinge" axis="0 -1 0"/>') == 1  # the default of all four
    model.write_text(
        written.replace('axis="0 -1 0"/>', 'axis="0 -1 0" frictionloss="0.1" armature="0.005"/>', 1)
    )
    scenario = load_scenario("five_bar", {**DESIGN, "robot": str(folder)})
    (compiled, *_) = build_machine(scenario).models.values()
    rubbed = compiled.dof_frictionloss > 0.0
    assert rubbed.sum() == 4
    assert np.allclose(compiled.dof_solref[rubbed], [2.0 * compiled.opt.timestep, 1.0])
    found = diagnose(as_dataset(simulate(scenario)), discover=False)
    assert sorted(found.missing) == [
        "coulomb_friction",
        "passive_coulomb_friction",
        "passive_rotor_inertia",
    ]
    assert found.ladder[-1].validate < 1.15 * found.unexplained.noise_floor
