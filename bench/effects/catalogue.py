"""The effects by name: a literal, sorted mapping, in step with the files of this folder and its README."""

from bench.effects.asymmetric_viscous_friction import AsymmetricViscousFriction
from bench.effects.backlash import Backlash
from bench.effects.base_tilt import BaseTilt
from bench.effects.cogging_torque import CoggingTorque
from bench.effects.constant_offset import ConstantOffset
from bench.effects.coulomb_friction import CoulombFriction
from bench.effects.current_delay import CurrentDelay
from bench.effects.current_loop_lag import CurrentLoopLag
from bench.effects.drive_flexibility import DriveFlexibility
from bench.effects.effect import Effect
from bench.effects.encoder_offset import EncoderOffset
from bench.effects.gain_saturation import GainSaturation
from bench.effects.geometric_error import GeometricError
from bench.effects.joint_spring import JointSpring
from bench.effects.load_dependent_friction import LoadDependentFriction
from bench.effects.passive_coulomb_friction import PassiveCoulombFriction
from bench.effects.passive_spring import PassiveSpring
from bench.effects.passive_viscous_friction import PassiveViscousFriction
from bench.effects.payload_mass_error import PayloadMassError
from bench.effects.platform_force import PlatformForce
from bench.effects.position_dependent_friction import PositionDependentFriction
from bench.effects.presliding_hysteresis import PreslidingHysteresis
from bench.effects.quadratic_drag import QuadraticDrag
from bench.effects.rotor_inertia import RotorInertia
from bench.effects.stribeck_friction import StribeckFriction
from bench.effects.thermal_friction_drift import ThermalFrictionDrift
from bench.effects.torque_ripple import TorqueRipple
from bench.effects.transmission_error import TransmissionError
from bench.effects.viscous_friction import ViscousFriction

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
    "joint_spring": JointSpring(),
    "load_dependent_friction": LoadDependentFriction(),
    "passive_coulomb_friction": PassiveCoulombFriction(),
    "passive_spring": PassiveSpring(),
    "passive_viscous_friction": PassiveViscousFriction(),
    "payload_mass_error": PayloadMassError(),
    "platform_force": PlatformForce(),
    "position_dependent_friction": PositionDependentFriction(),
    "presliding_hysteresis": PreslidingHysteresis(),
    "quadratic_drag": QuadraticDrag(),
    "rotor_inertia": RotorInertia(),
    "stribeck_friction": StribeckFriction(),
    "thermal_friction_drift": ThermalFrictionDrift(),
    "torque_ripple": TorqueRipple(),
    "transmission_error": TransmissionError(),
    "viscous_friction": ViscousFriction(),
}
