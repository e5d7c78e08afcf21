"""Effects that the simulated machine can have and that its log does not tell, one file each."""

from collections.abc import Mapping

from bench.truth.hidden.acceleration_dependent_friction import AccelerationDependentFriction
from bench.truth.hidden.asymmetric_viscous_friction import AsymmetricViscousFriction
from bench.truth.hidden.backlash import Backlash
from bench.truth.hidden.base import HiddenEffect, JointEffect
from bench.truth.hidden.base_tilt import BaseTilt
from bench.truth.hidden.cogging_torque import CoggingTorque
from bench.truth.hidden.constant_offset import ConstantOffset
from bench.truth.hidden.coulomb_friction import CoulombFriction
from bench.truth.hidden.current_crosstalk import CurrentCrosstalk
from bench.truth.hidden.current_delay import CurrentDelay
from bench.truth.hidden.current_loop_lag import CurrentLoopLag
from bench.truth.hidden.drive_flexibility import DriveFlexibility
from bench.truth.hidden.encoder_offset import EncoderOffset
from bench.truth.hidden.gain_saturation import GainSaturation
from bench.truth.hidden.geometric_error import GeometricError
from bench.truth.hidden.hysteretic_cable import HystereticCable
from bench.truth.hidden.joint_spring import JointSpring
from bench.truth.hidden.load_dependent_friction import LoadDependentFriction
from bench.truth.hidden.passive_coulomb_friction import PassiveCoulombFriction
from bench.truth.hidden.passive_load_friction import PassiveLoadFriction
from bench.truth.hidden.passive_rotor_inertia import PassiveRotorInertia
from bench.truth.hidden.passive_spring import PassiveSpring
from bench.truth.hidden.passive_viscous_friction import PassiveViscousFriction
from bench.truth.hidden.payload_mass_error import PayloadMassError
from bench.truth.hidden.periodic_disturbance import PeriodicDisturbance
from bench.truth.hidden.platform_force import PlatformForce
from bench.truth.hidden.position_dependent_friction import PositionDependentFriction
from bench.truth.hidden.position_dependent_viscous_friction import PositionDependentViscousFriction
from bench.truth.hidden.presliding_hysteresis import PreslidingHysteresis
from bench.truth.hidden.product_law import ProductLaw
from bench.truth.hidden.quadratic_drag import QuadraticDrag
from bench.truth.hidden.rotor_inertia import RotorInertia
from bench.truth.hidden.shear_thinning_friction import ShearThinningFriction
from bench.truth.hidden.speed_dependent_gain import SpeedDependentGain
from bench.truth.hidden.stribeck_friction import StribeckFriction
from bench.truth.hidden.thermal_friction_drift import ThermalFrictionDrift
from bench.truth.hidden.tool_drag import ToolDrag
from bench.truth.hidden.torque_drift import TorqueDrift
from bench.truth.hidden.torque_ripple import TorqueRipple
from bench.truth.hidden.transmission_error import TransmissionError
from bench.truth.hidden.viscoelastic_cable import ViscoelasticCable
from bench.truth.hidden.viscous_friction import ViscousFriction

__all__ = ["HIDDEN_EFFECTS", "HiddenEffect", "JointEffect"]

HIDDEN_EFFECTS: Mapping[str, type[HiddenEffect]] = {
    "acceleration_dependent_friction": AccelerationDependentFriction,
    "asymmetric_viscous_friction": AsymmetricViscousFriction,
    "backlash": Backlash,
    "base_tilt": BaseTilt,
    "cogging_torque": CoggingTorque,
    "constant_offset": ConstantOffset,
    "coulomb_friction": CoulombFriction,
    "current_crosstalk": CurrentCrosstalk,
    "current_delay": CurrentDelay,
    "current_loop_lag": CurrentLoopLag,
    "drive_flexibility": DriveFlexibility,
    "encoder_offset": EncoderOffset,
    "gain_saturation": GainSaturation,
    "geometric_error": GeometricError,
    "hysteretic_cable": HystereticCable,
    "joint_spring": JointSpring,
    "load_dependent_friction": LoadDependentFriction,
    "passive_coulomb_friction": PassiveCoulombFriction,
    "passive_load_friction": PassiveLoadFriction,
    "passive_rotor_inertia": PassiveRotorInertia,
    "passive_spring": PassiveSpring,
    "passive_viscous_friction": PassiveViscousFriction,
    "payload_mass_error": PayloadMassError,
    "periodic_disturbance": PeriodicDisturbance,
    "platform_force": PlatformForce,
    "position_dependent_friction": PositionDependentFriction,
    "position_dependent_viscous_friction": PositionDependentViscousFriction,
    "presliding_hysteresis": PreslidingHysteresis,
    "product_law": ProductLaw,
    "quadratic_drag": QuadraticDrag,
    "rotor_inertia": RotorInertia,
    "shear_thinning_friction": ShearThinningFriction,
    "speed_dependent_gain": SpeedDependentGain,
    "stribeck_friction": StribeckFriction,
    "thermal_friction_drift": ThermalFrictionDrift,
    "tool_drag": ToolDrag,
    "torque_drift": TorqueDrift,
    "torque_ripple": TorqueRipple,
    "transmission_error": TransmissionError,
    "viscoelastic_cable": ViscoelasticCable,
    "viscous_friction": ViscousFriction,
}
"""Every effect by the name that a scenario uses, those outside the catalogue included (`in_catalogue`)."""
