"""Which motion brings an effect out, in a few words."""

from collections.abc import Sequence

SHOWN_BY = {
    "viscous_friction": "move fast and slowly",
    "asymmetric_viscous_friction": "move fast in both directions",
    "coulomb_friction": "reverse slowly",
    "constant_offset": "move slowly in both directions",
    "stribeck_friction": "reverse slowly",
    "quadratic_drag": "move as fast as allowed",
    "load_dependent_friction": "carry a second payload",
    "position_dependent_friction": "move slowly over the whole range",
    "presliding_hysteresis": "reverse slowly, in small strokes",
    "thermal_friction_drift": "start cold and record for longer",
    "passive_viscous_friction": "move one motor alone, fast",
    "passive_coulomb_friction": "move one motor alone, slowly",
    "rotor_inertia": "carry a second payload",
    "cogging_torque": "turn slowly, without a payload",
    "torque_ripple": "turn slowly, with and without a payload",
    "gain_saturation": "carry a second payload, or accelerate harder",
    "current_delay": "reverse fast",
    "current_loop_lag": "reverse fast",
    "drive_flexibility": "reverse fast, with a heavy payload",
    "backlash": "go where the motor's torque changes its sign",
    "joint_spring": "move slowly over the whole range",
    "base_tilt": "move slowly over the whole range",
    "platform_force": "move slowly over the whole range, without a payload",
    "payload_mass_error": "carry a second payload",
    "geometric_error": "move over the whole range",
    "encoder_offset": "move slowly over the whole range",
}
"""For each effect of the catalogue, the motion in which it differs most from the others."""
ANY = "move over the whole range, fast and slowly"


def telling_motions(effects: Sequence[str]) -> list[str]:
    """What to do to tell these effects apart, without repetitions."""
    return list(dict.fromkeys(SHOWN_BY.get(name, ANY) for name in effects))
