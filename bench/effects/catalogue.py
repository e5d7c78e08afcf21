"""The effects by name: a literal, sorted mapping, in step with the files of this folder and its README."""

from bench.effects.effect import Effect
from bench.effects.laws.asymmetric_viscous_friction import AsymmetricViscousFriction
from bench.effects.laws.backlash import Backlash
from bench.effects.laws.base_tilt import BaseTilt
from bench.effects.laws.cogging_torque import CoggingTorque
from bench.effects.laws.constant_offset import ConstantOffset
from bench.effects.laws.coulomb_friction import CoulombFriction
from bench.effects.laws.current_delay import CurrentDelay
from bench.effects.laws.current_loop_lag import CurrentLoopLag
from bench.effects.laws.drive_flexibility import DriveFlexibility
from bench.effects.laws.encoder_offset import EncoderOffset
from bench.effects.laws.gain_saturation import GainSaturation
from bench.effects.laws.geometric_error import GeometricError
from bench.effects.laws.hysteretic_cable import HystereticCable
from bench.effects.laws.joint_spring import JointSpring
from bench.effects.laws.load_dependent_friction import LoadDependentFriction
from bench.effects.laws.passive_coulomb_friction import PassiveCoulombFriction
from bench.effects.laws.passive_load_friction import PassiveLoadFriction
from bench.effects.laws.passive_rotor_inertia import PassiveRotorInertia
from bench.effects.laws.passive_spring import PassiveSpring
from bench.effects.laws.passive_viscous_friction import PassiveViscousFriction
from bench.effects.laws.payload_mass_error import PayloadMassError
from bench.effects.laws.platform_force import PlatformForce
from bench.effects.laws.position_dependent_friction import PositionDependentFriction
from bench.effects.laws.presliding_hysteresis import PreslidingHysteresis
from bench.effects.laws.quadratic_drag import QuadraticDrag
from bench.effects.laws.rotor_inertia import RotorInertia
from bench.effects.laws.shear_thinning_friction import ShearThinningFriction
from bench.effects.laws.stribeck_friction import StribeckFriction
from bench.effects.laws.thermal_friction_drift import ThermalFrictionDrift
from bench.effects.laws.tool_drag import ToolDrag
from bench.effects.laws.torque_ripple import TorqueRipple
from bench.effects.laws.transmission_error import TransmissionError
from bench.effects.laws.viscous_friction import ViscousFriction

CATALOGUE: dict[str, Effect] = {
    "asymmetric_viscous_friction": AsymmetricViscousFriction(),
    "backlash": Backlash(),
    "base_tilt": BaseTilt(),
    "cogging_torque": CoggingTorque(),
    "constant_offset": ConstantOffset(),
    "coulomb_friction": CoulombFriction(),
    "current_delay": CurrentDelay(),
    "current_loop_lag": CurrentLoopLag(),
    "drive_flexibility": DriveFlexibility(),
    "encoder_offset": EncoderOffset(),
    "gain_saturation": GainSaturation(),
    "geometric_error": GeometricError(),
    "hysteretic_cable": HystereticCable(),
    "joint_spring": JointSpring(),
    "load_dependent_friction": LoadDependentFriction(),
    "passive_coulomb_friction": PassiveCoulombFriction(),
    "passive_load_friction": PassiveLoadFriction(),
    "passive_rotor_inertia": PassiveRotorInertia(),
    "passive_spring": PassiveSpring(),
    "passive_viscous_friction": PassiveViscousFriction(),
    "payload_mass_error": PayloadMassError(),
    "platform_force": PlatformForce(),
    "position_dependent_friction": PositionDependentFriction(),
    "presliding_hysteresis": PreslidingHysteresis(),
    "quadratic_drag": QuadraticDrag(),
    "rotor_inertia": RotorInertia(),
    "shear_thinning_friction": ShearThinningFriction(),
    "stribeck_friction": StribeckFriction(),
    "thermal_friction_drift": ThermalFrictionDrift(),
    "tool_drag": ToolDrag(),
    "torque_ripple": TorqueRipple(),
    "transmission_error": TransmissionError(),
    "viscous_friction": ViscousFriction(),
}
