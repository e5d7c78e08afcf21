"""Effects that are too small to be named, and how far they can have moved a drive gain."""

import numpy as np

from bench.api.diagnose import diagnose
from bench.diagnosis.unnamed_effects import _random_effect
from bench.scenario.scenario import load_scenario
from bench.truth.dataset import as_dataset
from bench.truth.machine import true_gains
from bench.truth.simulate import simulate

PLACES = 10
BY_UNIT = np.eye(2, PLACES) * 0.5
INFORMATION = np.diag(np.geomspace(1.0, 1e4, PLACES))


def score_of(sizes: np.ndarray, random: np.random.Generator) -> np.ndarray:
    """The score of effects of these sizes, with noise."""
    return INFORMATION @ sizes + np.sqrt(INFORMATION) @ random.normal(size=PLACES)


def test_noise_speaks_for_no_effect() -> None:
    random = np.random.default_rng(1)
    evidence = [
        _random_effect(INFORMATION, score_of(np.zeros(PLACES), random), BY_UNIT).evidence for _ in range(200)
    ]
    assert np.median(evidence) < 0.0
    assert np.mean(np.array(evidence) > np.log(30.0)) < 0.03


def test_many_small_effects_speak_together_and_their_squares_contain_what_they_do() -> None:
    """Each size is about 0.2 where the best determined one has a standard error of 0.01, and the first ones of 1."""
    random = np.random.default_rng(2)
    ratios, evidence = [], []
    for _ in range(200):
        sizes = 0.2 * random.normal(size=PLACES)
        effect = _random_effect(INFORMATION, score_of(sizes, random), BY_UNIT)
        ratios.append(BY_UNIT @ sizes / np.sqrt(effect.squares))
        evidence.append(effect.evidence)
    assert np.median(evidence) > 10.0
    assert 0.7 < np.sqrt(np.mean(np.square(ratios))) < 1.2


def test_an_effect_without_information_says_nothing() -> None:
    effect = _random_effect(np.zeros((2, 2)), np.zeros(2), np.ones((2, 2)))
    assert effect.evidence == -np.inf
    assert not effect.squares.any()


def test_a_wrong_length_that_nobody_can_name_widens_the_gains() -> None:
    """Of 0.5 mm in a crank of a five-bar: the error is that of the noise, and the gains are 0.15 to 0.3 % off."""
    hidden = [{"effect": "geometric_error", "joint": "left", "error": 0.0005}]
    before, after = [], []
    for seed in (1, 2):
        changes = {"design": {"optimise": False}, "hidden": hidden, "seed": seed}
        simulation = simulate(load_scenario("five_bar", changes))
        answer = diagnose(as_dataset(simulation), discover=False)
        assert not answer.missing
        for joint, true in zip(answer.after.drive_gains, true_gains(simulation.scenario), strict=True):
            for result, ratios in ((answer.before, before), (answer.after, after)):
                gain = result.drive_gains[joint]
                ratios.append((gain.value - true) / gain.std)
    rms_before, rms_after = (float(np.sqrt(np.mean(np.square(ratios)))) for ratios in (before, after))
    assert rms_before > 4.0
    assert rms_after < 2.5
