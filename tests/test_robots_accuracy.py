"""The scenarios of the robots that people own: gains as good as 20-bit encoders and 1 % current noise allow."""

import numpy as np
import pytest

from bench.diagnosis.unexplained import relative_noise_floor
from bench.excitation.scenario import designer
from bench.identification.identify import identify
from bench.identification.prepare import prepare
from bench.identification.problem import problem_of
from bench.scenario.scenario import load_scenario, resolve_trajectories
from bench.signals.decimation import noise_bandwidth
from bench.truth.dataset import as_dataset
from bench.truth.machine import true_gains
from bench.truth.simulate import simulate
from tests.hidden_kit import STEP

GAIN_ERROR = 0.003
CURRENT_NOISE = 0.01  # of the RMS current
OVER_NOISE = 1.1  # error on recordings that were not fitted, over that of the noise
DURATION = dict.fromkeys(("orthoglide", "palletiser"), 10.0)  # s, where half of the scenario's tells as much
STEPS = dict.fromkeys(("palletiser", "three_rrr"), 0.00025)  # s, whose loops ask for less
ROBOTS = ("dualv", "orthoglide", "palletiser", "stewart", "three_rrr", "wrist")


@pytest.mark.slow
@pytest.mark.parametrize("name", ROBOTS)
def test_gains_are_found_and_nothing_is_left_but_noise(name: str) -> None:
    design = {"duration": DURATION[name]} if name in DURATION else {}
    scenario = load_scenario(name, {"step": STEPS.get(name, STEP), "design": design})
    dataset = as_dataset(simulate(scenario, resolve_trajectories(scenario, designer)))
    found = identify(prepare(problem_of(dataset)))
    for true, (joint, gain) in zip(true_gains(scenario), found.drive_gains.items(), strict=True):
        assert gain.value == pytest.approx(true, rel=GAIN_ERROR), joint
    floor = CURRENT_NOISE * np.sqrt(noise_bandwidth(found.settings.decimation))
    if found.redundant:  # whose currents' noise is in the others' equations too
        checked = [one for one in found.recordings if one.use == "validate"]
        floor = relative_noise_floor(dataset.recordings, checked, found.settings)
    assert float(found.error.validate or np.inf) < OVER_NOISE * floor
