"""Real bodies with the identified base parameters, and what is said where there are none."""

from dataclasses import replace

import numpy as np
import pytest

from bench.basics.errors import BenchError
from bench.cli import main
from bench.dataset.dataset import load_dataset
from bench.export.bodies import about_center, cad_prior, from_scaled, pseudo_inertia, standard_parameters
from bench.export.identified import load_identified
from bench.export.mjcf import write_mjcf
from bench.export.physical import physical_set
from bench.identification.identify import identify
from bench.identification.model_file import save_model
from bench.identification.prepare import prepare
from bench.identification.problem import problem_of
from bench.model.geometry import read_geometry
from bench.model.regressor import moved_parameters
from bench.truth.dataset import write_simulation
from tests.export_kit import RICH, identified, identified_file, robot_with
from tests.hidden_kit import run

BODY = np.array([2.0, 0.2, -0.1, 0.3, 0.5, 0.01, 0.6, -0.02, 0.03, 0.4])


def base_of(physical):
    """Base parameters (nb,) of the bodies and rotors."""
    geometry, base = physical.model.model.geometry, physical.model.model.base
    standard = np.zeros(10 * len(geometry.joints))
    for joint, name in geometry.bodies:
        standard[10 * joint : 10 * joint + 10] = physical.bodies[name]
    return base.grouping @ standard + base.rotors @ physical.rotors


def test_pseudo_inertia_and_back():
    assert standard_parameters(pseudo_inertia(BODY)) == pytest.approx(BODY, abs=1e-15)
    root = np.linalg.cholesky(pseudo_inertia(BODY))
    assert from_scaled(root) @ np.eye(4).ravel() == pytest.approx(BODY, abs=1e-14)


def test_a_body_about_its_center_and_back():
    mass, center, inertia = about_center(BODY)
    xx, yy, zz, xy, xz, yz = inertia[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]
    own = np.array([mass, 0, 0, 0, xx, xy, yy, xz, yz, zz])
    assert moved_parameters(own, np.eye(3), center) == pytest.approx(BODY, abs=1e-14)


def test_a_point_at_its_edge_is_no_body_and_a_cloud_of_points_is():
    points = np.random.default_rng(1).normal(size=(5, 3))
    lifted = np.column_stack((points, np.ones(5)))
    assert np.linalg.eigvalsh(pseudo_inertia(standard_parameters(lifted.T @ lifted)))[0] > 0.0
    needle = BODY.copy()
    needle[4] = needle[6] + needle[9] + 1.0  # more than the sum of the other two
    assert np.linalg.eigvalsh(pseudo_inertia(needle))[0] < 0.0


@pytest.mark.parametrize("use_cad", [True, False])
@pytest.mark.parametrize("name", ["five_bar", "two_link"])
def test_bodies_are_real_and_have_the_base_parameters(name, use_cad):
    model = identified(name)
    physical = physical_set(model, use_cad=use_cad)
    assert physical.contradiction is None
    assert (physical.rotors >= 0.0).all()
    for parameters in physical.bodies.values():
        assert np.linalg.eigvalsh(pseudo_inertia(parameters))[0] > 0.0
    assert base_of(physical) == pytest.approx(physical.model.base, rel=1e-9, abs=1e-10)
    off = physical.model.base - model.base
    std = np.sqrt(np.diag(model.covariance)[: len(off)])
    assert np.abs(off / std).max() <= physical.distance + 1e-6
    assert physical.distance < 2.0


def test_masses_stay_near_those_of_the_mjcf_where_they_are_asked_for():
    model = identified("five_bar")
    cad = cad_prior(model.model.geometry).parameters
    near, bars = physical_set(model), physical_set(model, use_cad=False)

    def distance(physical):
        own = [(cad[10 * joint], physical.bodies[name][0]) for joint, name in model.model.geometry.bodies]
        return sum(abs(np.log(mass / found)) for mass, found in own)

    assert distance(near) < 0.2
    assert distance(near) < 0.5 * distance(bars)
    assert "MJCF" in near.prior
    assert "MJCF" not in bars.prior


def test_an_impossible_body_is_named():
    model = identified("two_link")
    names = list(model.model.base.names)
    base = model.base.copy()
    base[names.index("Iyy(forearm)")] = -0.001
    physical = physical_set(replace(model, base=base))
    assert physical.contradiction is not None
    assert physical.contradiction.distance > 3.0 * physical.contradiction.expected
    assert physical.contradiction.culprits[0][0] == "forearm"
    assert physical.contradiction.culprits[0][1] < physical.contradiction.expected
    assert "forearm that would need" in physical.contradiction.words()
    for parameters in physical.bodies.values():
        assert np.linalg.eigvalsh(pseudo_inertia(parameters))[0] > 0.0


def test_what_moves_with_the_base_parameters_moves_as_the_covariance_says():
    model = identified("five_bar")
    step = 0.3 * np.sqrt(np.diag(model.covariance))[0]
    estimated = model.estimated.copy()
    estimated[0] += step
    nz = len(estimated)
    moved = model.moved(estimated)
    weights = np.linalg.solve(model.covariance[:nz, :nz], estimated - model.estimated)
    assert moved.gains - model.gains == pytest.approx(model.covariance[nz:, :nz] @ weights, rel=1e-4)
    assert moved.estimated == pytest.approx(estimated, abs=1e-15)


@pytest.fixture(scope="module")
def with_load(tmp_path_factory):
    """A model with a payload of which only the mass is declared."""
    folder = tmp_path_factory.mktemp("with_load")
    write_simulation(run("two_link", design=RICH), folder / "data")
    toml = folder / "data" / "dataset.toml"
    lines = toml.read_text().splitlines()
    toml.write_text("\n".join(line for line in lines if not line.startswith(("center", "inertia"))) + "\n")
    path = folder / "model.json"
    save_model(identify(prepare(problem_of(load_dataset(folder / "data")))), path, folder / "data")
    return load_identified(path)


def test_a_payload_that_was_estimated_is_a_real_body_too(with_load):
    physical = physical_set(with_load)
    ((name, payload),) = physical.payloads.items()
    assert payload[0] == pytest.approx(with_load.declared[name].mass, rel=1e-6)
    assert np.linalg.eigvalsh(pseudo_inertia(payload))[0] > 0.0


@pytest.mark.parametrize("share", [0.0, -1e-4])
def test_a_payload_at_the_limit_of_what_is_real_becomes_a_body_beside_it(with_load, share, tmp_path):
    real = physical_set(with_load).model
    ((name, values),) = real.payloads.items()
    model = replace(real, payloads={name: {index: share * value for index, value in values.items()}})
    physical = physical_set(model)
    assert physical.contradiction is None
    assert 0.0 < physical.distance < 1.0
    assert physical.payloads[name][0] == pytest.approx(model.declared[name].mass, rel=1e-6)
    assert np.linalg.eigvalsh(pseudo_inertia(physical.payloads[name]))[0] > 0.0
    assert base_of(physical) == pytest.approx(physical.model.base, rel=1e-9, abs=1e-10)
    off = physical.model.estimated - model.estimated
    errors = np.sqrt(np.diag(model.covariance))[: len(off)]
    assert np.abs(off / errors).max() <= physical.distance + 1e-6
    write_mjcf(tmp_path / "out.xml", physical)
    geometry = read_geometry(robot_with(tmp_path / "robot", tmp_path / "out.xml", "two_link"))
    written, base = cad_prior(geometry), model.model.base
    assert base.grouping @ written.parameters + base.rotors @ written.rotors == pytest.approx(
        base_of(physical), rel=1e-6, abs=1e-9
    )


def test_a_model_of_another_robot_is_refused():
    with pytest.raises(BenchError, match="motors"):
        load_identified(identified_file("five_bar"), "two_link")


def test_a_solver_that_fails_is_tried_with_other_settings(monkeypatch):
    import cvxpy

    solve, tried = cvxpy.Problem.solve, []

    def failing(problem, **settings):
        tried.append(settings)
        if len(tried) == 1:
            raise cvxpy.error.SolverError("no way")
        return solve(problem, **settings)

    monkeypatch.setattr(cvxpy.Problem, "solve", failing)
    found = physical_set(identified("two_link"))
    assert [len(settings) for settings in tried[:2]] == [1, 2]
    assert base_of(found) == pytest.approx(found.model.base, rel=1e-6, abs=1e-9)


def test_a_solver_that_fails_in_every_way_is_one_line_and_leaves_nothing(monkeypatch, tmp_path, capsys):
    import cvxpy

    def failing(problem, **settings):
        raise cvxpy.error.SolverError("no way")

    monkeypatch.setattr(cvxpy.Problem, "solve", failing)
    words = ["export", str(identified_file("two_link")), "--to", "mjcf", "-o", str(tmp_path / "arm.xml")]
    assert main(words) == 2
    told = capsys.readouterr()
    assert told.out == ""
    assert told.err.startswith(
        "bench: no physically possible bodies were found for this model: the data determine"
    )
    assert "no way" not in told.err
    assert told.err.count("\n") == 1
    assert list(tmp_path.iterdir()) == []
