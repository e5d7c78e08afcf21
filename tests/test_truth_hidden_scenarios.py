"""Hidden effects in scenarios: together, each alone on every robot, reproducible, refused in one line."""

import json

import numpy as np
import pytest

from bench.basics.errors import BenchError
from bench.truth.hidden import HIDDEN_EFFECTS, JointEffect
from bench.truth.hidden.reference import Reference
from bench.truth.hidden.sizes import typical
from bench.truth.machine import build_machine
from bench.truth.report import truth
from bench.truth.simulate import simulate
from tests.hidden_kit import BRIEF, STEP, bare_machine, cart, plain, run, scenario, states

# each large enough to be felt and small enough for any robot; of the others, a share of what its motors give
EACH = {
    "acceleration_dependent_friction": {"c": 0.01},
    "asymmetric_viscous_friction": {"Fv_plus": 0.1, "Fv_minus": 0.2},
    "backlash": {"play": 2e-3, "stiffness": 3e3, "damping": 0.5, "rotor_inertia": 5e-3},
    "base_tilt": {"about_y": 0.05},
    "cogging_torque": {"a": 0.1, "b": 0.2, "period": 0.3},
    "constant_offset": {"c": 0.2},
    "coulomb_friction": {"Fc": 0.2},
    "current_crosstalk": {"c": 0.05},
    "current_delay": {"T": 0.002},
    "current_loop_lag": {"T": 0.002},
    "drive_flexibility": {"stiffness": 500.0, "damping": 0.5, "rotor_inertia": 5e-3},
    "encoder_offset": {"offset": 0.01},
    "gain_saturation": {"k": 3e-3},
    "geometric_error": {"error": 2e-3},
    "joint_spring": {"k": 0.5, "q0": 0.0},
    "load_dependent_friction": {"mu": 0.05},
    "passive_coulomb_friction": {"Fc": 0.05},
    "passive_load_friction": {"mu": 0.002},
    "passive_rotor_inertia": {"Ia": 0.005},
    "passive_spring": {"k": 0.5, "q0": 0.1},
    "passive_viscous_friction": {"Fv": 0.05},
    "payload_mass_error": {"error": 0.1},
    "periodic_disturbance": {"size": 0.2, "frequency": 3.0},
    "platform_force": {"fx": 1.0, "fz": 2.0},
    "position_dependent_friction": {"a": 0.0, "b": 0.1},
    "position_dependent_viscous_friction": {"a": 0.1, "b": 0.1},
    "presliding_hysteresis": {"Fc": 0.2, "stiffness": 10.0},
    "product_law": {"c": 0.1, "direction": 1.0, "v": 1.5},
    "quadratic_drag": {"c": 0.05},
    "rotor_inertia": {"Ia": 0.01},
    "speed_dependent_gain": {"v0": 50.0},
    "stribeck_friction": {"Fc": 0.1, "Fs": 0.1, "vs": 0.2},
    "thermal_friction_drift": {"T": 1.0, "Fv": 0.1},
    "tool_drag": {"c": 1.0},
    "torque_drift": {"size": 0.2, "T": 0.3},
    "torque_ripple": {"a": 0.05, "b": 0.0, "period": 0.3},
    "transmission_error": {"a": 1e-3, "b": 1e-3, "period": 0.5},
    "viscoelastic_cable": {"k": 1.0, "T": 0.5},
    "viscous_friction": {"Fv": 0.1},
}
SETTLE = 0.1  # s before a log
STIFF = {"drive_flexibility": STEP / 2, "backlash": STEP}  # s, the steps of springs that swing fast
KEEPS = {"position_dependent_friction": {"effect": "coulomb_friction", "Fc": 0.1}}


def test_catalogue_and_this_table_are_in_step():
    assert set(EACH) <= set(HIDDEN_EFFECTS)
    for name, kind in HIDDEN_EFFECTS.items():
        assert kind.name == name
        assert kind.__module__ == f"bench.truth.hidden.laws.{name}"
        assert set(kind.positive) | set(kind.not_negative) <= set(kind.__dataclass_fields__)
    outside = [name for name, kind in HIDDEN_EFFECTS.items() if not kind.in_catalogue]
    assert len(outside) == 8


@pytest.mark.parametrize("robot", ["five_bar", "delta"])
@pytest.mark.parametrize("effect", HIDDEN_EFFECTS)
def test_each_effect_changes_the_currents_and_leaves_the_loops_closed(effect, robot):
    step = STIFF.get(effect, 0.001)
    # a payload of another mass changes nothing without it; of the others, one recording says what two would
    recordings = ("free", "held") if effect == "payload_mass_error" else ("held",)
    brief = {"settle": SETTLE, "step": step, "recordings": recordings}
    without = plain(robot, duration=BRIEF["duration"], **brief)
    parameters = EACH.get(effect) or _share_of(effect, without)
    hidden = [{"effect": effect, **parameters}] + ([KEEPS[effect]] if effect in KEEPS else [])
    simulation = run(robot, *hidden, design=BRIEF, **brief)
    assert simulation.loop_gap < 1e-5
    for recording, reference in zip(simulation.recordings, without.recordings, strict=True):
        assert np.isfinite(recording.current).all()
        differs = np.abs(recording.current - reference.current).max()
        free = effect == "payload_mass_error" and recording.name == "free"
        assert (differs == 0) if free else (differs > 1e-4 * np.abs(reference.current).max())
    told = truth(simulation)["hidden"]
    assert told[0]["effect"] == effect
    assert parameters.items() <= told[0].items()
    json.dumps(told)


def _share_of(effect, without):
    of_motor = issubclass(HIDDEN_EFFECTS[effect], JointEffect) and HIDDEN_EFFECTS[effect].where != "passive"
    return typical(effect, Reference(without), 0.05, without.robot.joints[0] if of_motor else None)


@pytest.mark.parametrize("effect", ["backlash", "stribeck_friction", "torque_drift", "presliding_hysteresis"])
def test_same_scenario_same_bits_and_no_recording_depends_on_another(effect):
    hidden = {"effect": effect, **EACH[effect]}
    one, two = run("five_bar", hidden, design=BRIEF), run("five_bar", hidden, design=BRIEF)
    alone = run("five_bar", hidden, design=BRIEF, recordings=("held",))
    for a, b in [*zip(one.recordings, two.recordings, strict=True), (one.recordings[1], alone.recordings[0])]:
        np.testing.assert_array_equal(a.log.position, b.log.position)
        np.testing.assert_array_equal(a.log.current, b.log.current)


def test_the_number_of_threads_changes_nothing():
    given = scenario("five_bar", [{"effect": "load_dependent_friction", "mu": 0.1}], design=BRIEF)
    for a, b in zip(
        simulate(given, threads=1).recordings, simulate(given, threads=2).recordings, strict=True
    ):
        np.testing.assert_array_equal(a.log.current, b.log.current)


def test_effects_add_up_whichever_way_they_are_simulated():
    """Twelve at once, on one joint or both, with laws of MuJoCo and of our own."""
    hidden = (
        {"effect": "viscous_friction", "Fv": 0.1},
        {"effect": "viscous_friction", "Fv": 0.05, "joint": "left"},
        {"effect": "coulomb_friction", "Fc": 0.1, "joint": "left"},
        {"effect": "stribeck_friction", "Fc": 0.1, "Fs": 0.2, "vs": 0.5},
        {"effect": "load_dependent_friction", "mu": 0.05, "joint": "right"},
        {"effect": "constant_offset", "c": -0.1},
        {"effect": "constant_offset", "c": 0.3, "joint": "right"},
        {"effect": "cogging_torque", "a": 0.1, "b": 0.0, "period": 0.2},
        {"effect": "joint_spring", "k": 0.3, "q0": 0.1},
        {"effect": "current_crosstalk", "c": 0.02, "joint": "left"},
        {"effect": "gain_saturation", "k": 2e-3, "joint": "left"},
        {"effect": "torque_ripple", "a": 0.03, "b": 0.02, "period": 0.25, "joint": "left"},
    )
    for s in states(run("five_bar", *hidden, design=BRIEF), "five_bar", slowest=0.02):
        sign = np.sign(s.v)
        both = 0.1 * s.v + (0.1 + 0.2 * np.exp(-((s.v / 0.5) ** 2))) * sign - 0.1
        both += 0.1 * np.cos(2 * np.pi * s.q / 0.2) + 0.3 * (s.q - 0.1)
        left = 0.05 * s.v[:, 0] + 0.1 * sign[:, 0] + 0.02 * s.torque[:, 1]
        right = 0.3 + 0.05 * abs(s.torque[:, 1]) * sign[:, 1]
        np.testing.assert_allclose(s.extra, both + np.column_stack([left, right]), atol=1e-10)
        phase = 2 * np.pi * s.q[:, 0] / 0.25
        factor = (1 - 2e-3 * s.current[:, 0] ** 2) * (1 + 0.03 * np.cos(phase) + 0.02 * np.sin(phase))
        np.testing.assert_allclose(s.torque[:, 0], s.gains[0] * s.current[:, 0] * factor, rtol=1e-12)
        np.testing.assert_allclose(s.torque[:, 1], s.gains[1] * s.current[:, 1], rtol=1e-12)


def test_delays_and_lags_add_up():
    """A lag after a delay, and a log that is late on top: each shifts what is logged further."""
    delay, lag = {"effect": "current_delay", "T": 0.001}, {"effect": "current_loop_lag", "T": 0.002}
    simulation = run(
        "five_bar", delay, lag, {"effect": "current_delay", "T": -0.003}, every_step=True, design=BRIEF
    )
    for s in states(simulation, "five_bar", step=1):
        flowing, entering = (s.torque / s.gains)[:-4], s.current[4:]  # what enters: the reference 2 steps ago
        stay = np.exp(-STEP / 0.002)
        mean = (1 - stay) * 0.002 / STEP
        expected = stay * flowing[:-1] + (1 - mean) * entering[1:] + (mean - stay) * entering[:-1]
        np.testing.assert_allclose(flowing[1:], expected, atol=1e-8)


def test_a_law_in_python_and_the_same_law_in_mujoco_move_alike():
    same = [
        (
            {"effect": "viscous_friction", "Fv": 0.2},
            {"effect": "asymmetric_viscous_friction", "Fv_plus": 0.2, "Fv_minus": 0.2},
            (1e-10, 1e-8),
        ),
        (
            {"effect": "coulomb_friction", "Fc": 0.3},
            {"effect": "stribeck_friction", "Fc": 0.3, "Fs": 0.0, "vs": 1.0},
            (1e-9, 1e-6),
        ),
    ]
    for native, law, (position, current) in same:
        for one, other in zip(
            run("five_bar", native, design=BRIEF).recordings,
            run("five_bar", law, design=BRIEF).recordings,
            strict=True,
        ):
            np.testing.assert_allclose(one.motion.qpos, other.motion.qpos, atol=position)
            np.testing.assert_allclose(one.current, other.current, atol=current)


@pytest.mark.parametrize(
    "effect", ["stribeck_friction", "presliding_hysteresis", "current_delay", "backlash"]
)
def test_a_longer_step_moves_nearly_alike(effect):
    """Of 0.5 ms instead of 0.25 ms: what the step alone makes of the currents."""
    hidden = {"effect": effect, **EACH[effect]}
    one = {"recordings": ("held",)}
    fine, coarse = run("five_bar", hidden, step=STEP / 2, **one), run("five_bar", hidden, **one)
    for one, other in zip(fine.recordings, coarse.recordings, strict=True):
        difference = np.sqrt(np.mean((one.current - other.current) ** 2) / np.mean(one.current**2))
        assert difference < 2e-3


MISTAKES = [
    ({"effect": "viscous_friction", "Fc": 1}, "hidden\\[0\\].Fc: unknown key; viscous_friction has Fv"),
    (
        {"effect": "stribeck_friction", "Fc": 1, "Fs": 1},
        "hidden\\[0\\].vs: missing; stribeck_friction needs it",
    ),
    (
        {"effect": "stribeck_friction", "Fc": 1, "Fs": 1, "vs": 0},
        "hidden\\[0\\].vs: should be greater than 0",
    ),
    ({"effect": "stribeck_friction", "Fc": "1", "Fs": 1, "vs": 1}, "hidden\\[0\\].Fc: should be a number"),
    ({"effect": "quadratic_drag", "c": True}, "hidden\\[0\\].c: should be a number"),
    ({"effect": "quadratic_drag", "c": float("nan")}, "hidden\\[0\\].c: should be finite"),
    ({"effect": "quadratic_drag", "c": -1.0}, "hidden\\[0\\].c: should be at least 0"),
    ({"effect": "fricton"}, "hidden\\[0\\].effect: no effect 'fricton'; there are .*viscous_friction"),
    (
        {"effect": "viscous_friction", "Fv": 1, "joint": "knee"},
        "no hinge or slide joint 'knee'; there are left, right$",
    ),
    (
        {"effect": "viscous_friction", "Fv": 1, "joint": "left_elbow"},
        "'left_elbow', which has no motor; there are left, right$",
    ),
    (
        {"effect": "passive_viscous_friction", "Fv": 1, "joint": "left"},
        "'left', which has a motor; there are left_elbow, right_elbow$",
    ),
    (
        {"effect": "base_tilt", "about_x": 1, "joint": "left"},
        "base_tilt is of the whole machine, not of a joint",
    ),
    (
        {"effect": "drive_flexibility", "stiffness": 100, "damping": 1},
        "joint left has no rotor: rotor_inertia",
    ),
    (
        {"effect": "drive_flexibility", "stiffness": 1e7, "damping": 1, "rotor_inertia": 1e-3},
        "drive_flexibility of joint left: .* swings too fast",
    ),
    (
        {"effect": "presliding_hysteresis", "Fc": 1, "stiffness": 1e7},
        "presliding_hysteresis of joint left: .* too fast",
    ),
    ({"effect": "payload_mass_error", "error": -2}, "payload 'disc' would weigh -1.5 kg"),
    (
        {"effect": "position_dependent_friction", "joint": "left", "a": 0.1, "b": 0.1},
        "recording 'free': the dry friction of joint left would be -.* at .* s: it needs a coulomb_friction",
    ),
    ({"effect": "gain_saturation", "k": 1.0}, "the controller lost joint|diverged"),
]


@pytest.mark.parametrize(("hidden", "told"), MISTAKES)
def test_mistakes_are_named_in_one_line(hidden, told):
    with pytest.raises(BenchError, match=told) as raised:
        run("five_bar", hidden)
    assert str(raised.value).startswith("scenario five_bar: ")
    assert "\n" not in str(raised.value)


def test_what_a_robot_or_scenario_lacks_is_named(tmp_path):
    with pytest.raises(BenchError, match="already has a spring or play"):
        run("five_bar", *({"effect": effect, **EACH[effect]} for effect in ("backlash", "drive_flexibility")))
    for effect, told in (
        ("payload_mass_error", "the scenario has no payload"),
        ("platform_force", "the robot 'cart' has no \\[tool\\] site"),
        ("tool_drag", "the robot 'cart' has no \\[tool\\] site"),
        ("passive_viscous_friction", "the robot has no passive hinge, slide or ball joint"),
        ("passive_spring", "the robot has no passive hinge or slide joint"),
        ("current_crosstalk", "the robot 'cart' has one motor only"),
        ("geometric_error", "the link of joint .* has no length"),
    ):
        with pytest.raises(BenchError, match=told):
            cart(tmp_path, "1 0 0", {"effect": effect, **EACH[effect]})


def test_without_a_joint_an_effect_is_in_all_that_can_have_it():
    for robot, passive in (("five_bar", 2), ("delta", 12)):
        count = len(bare_machine(robot).dofs)
        given = build_machine(
            scenario(
                robot,
                [
                    {"effect": "viscous_friction", "Fv": 0.1},
                    {"effect": "passive_viscous_friction", "Fv": 0.1},
                ],
            )
        )
        names = [effect.name for effect in given.hidden]
        assert names == ["viscous_friction"] * count + ["passive_viscous_friction"] * passive
        damped = np.count_nonzero(given.models[None].dof_damping)
        assert damped == count + passive
