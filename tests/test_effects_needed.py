"""Effects made of the torque that the model needs: never of themselves, and never of the current that they explain."""

from dataclasses import replace

import numpy as np
import pytest

from bench.dataset.dataset import Dataset, load_dataset
from bench.effects import CATALOGUE, catalogue_for
from bench.excitation.scenario import designer
from bench.identification.identify import identify
from bench.identification.nonlinear import converged
from bench.identification.prepare import prepare, with_effects
from bench.identification.problem import Problem, problem_of
from bench.scenario.scenario import load_scenario, resolve_trajectories
from bench.truth.dataset import as_dataset
from bench.truth.simulate import simulate

GAINS = {"left": 3.0 * 1.10, "right": 3.0 * 0.92}

OWN = """
from dataclasses import dataclass

import numpy as np

from bench.effects import ActuatorEffect, EffectParameter


@dataclass(frozen=True)
class Loss(ActuatorEffect):
    name = "loss"
    parameters = (EffectParameter("eta", "1", positive=True),)
    depends_on_model = True

    def torque(self, joint):
        return (np.abs(joint.needed_torque) * np.sign(joint.velocity))[:, None]
"""


def measurements(*hidden: dict[str, float | str]) -> Dataset:
    scenario = load_scenario("five_bar", {"hidden": list(hidden), "step": 0.0005})
    return as_dataset(simulate(scenario, resolve_trajectories(scenario, designer)))


@pytest.fixture(scope="module")
def loaded():
    return measurements({"effect": "load_dependent_friction", "mu": 0.05})


def test_an_effect_of_one_s_own_may_ask_for_the_torque_that_the_model_needs(loaded, tmp_path):
    (tmp_path / "loss.py").write_text(OWN)
    catalogue = catalogue_for([tmp_path / "loss.py"])
    result = identify(prepare(Problem(loaded, catalogue, ("loss", "viscous_friction"))))
    for one in result.effect_parameters["loss"].values():
        assert one["eta"].value == pytest.approx(0.05, abs=0.005)


@pytest.mark.parametrize("joint", GAINS)
def test_the_torque_needed_leaves_out_what_is_made_of_it(loaded, tmp_path, joint):
    (tmp_path / "loss.py").write_text(OWN)
    rigid = converged(prepare(problem_of(loaded, ["viscous_friction"])))
    catalogue = catalogue_for([tmp_path / "loss.py"])
    more = converged(prepare(Problem(loaded, catalogue, ("viscous_friction", "loss"))))
    about = with_effects(rigid, rigid.effects, more.present)
    values = {(one.effect.name, one.joint): own for one, own in more.present.effects}
    j = list(GAINS).index(joint)
    seen = about.signals[0]
    expected = seen.refined(seen.coarse.torque)[:, j]
    expected = expected + values["viscous_friction", joint][0] * seen.joints[joint].velocity
    assert seen.joints[joint].needs() == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("name", ["load_dependent_friction", "gain_saturation", "torque_ripple"])
def test_a_current_does_not_explain_itself(name, loaded):
    """What else is in the current changes nothing, but for which way the torque is taken to go."""
    prepared = prepare(problem_of(loaded, ()))
    joint = prepared.signals[0].joints["left"]
    noise = 0.1 * np.random.default_rng(1).normal(size=len(joint.current)) * joint.current.std()
    other = replace(joint, current=joint.current + noise)
    one, two = (CATALOGUE[name].torque(each) for each in (joint, other))
    assert np.abs(two) == pytest.approx(np.abs(one))


def test_where_friction_and_gain_cannot_be_told_apart_that_is_said_and_no_number_given(measured_data):
    arm = load_dataset(measured_data / "ur10e")
    beside = ("viscous_friction", "coulomb_friction", "constant_offset")
    plain = identify(prepare(problem_of(arm, beside)))
    result = identify(prepare(problem_of(arm, [*beside, "load_dependent_friction"])))
    found = result.effect_parameters["load_dependent_friction"]
    assert [joint for joint, one in found.items() if np.isinf(one["mu"].std)] == ["j1"]
    assert any(
        "cannot distinguish load dependent friction at j1 from the drive gain" in one for one in result.notes
    )
    assert result.drive_gains["j1"].value == pytest.approx(plain.drive_gains["j1"].value, rel=0.2)
    for joint, known in zip(("j2", "j3", "j4", "j5", "j6"), (11.98, 9.84, 10.75, 10.70, 10.68), strict=True):
        assert result.drive_gains[joint].value == pytest.approx(known, rel=0.05)
        assert 0.02 < found[joint]["mu"].value < 0.1
