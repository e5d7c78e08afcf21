"""The opened tree as a Pinocchio model, built joint by joint from the geometry."""

import numpy as np
import pinocchio as pin

from bench.model.geometry import Geometry, Joint

AXES = np.eye(3)


def build_tree(geometry: Geometry) -> pin.Model:
    """Every leg a tree, the platform a free body, no inertia: only kinematics are asked of it.

    Joint i of the geometry is joint i + 1 of the model, with the same slices of q and v.
    """
    model = pin.Model()
    model.name = geometry.robot.name
    model.gravity.linear = geometry.gravity
    for joint in geometry.joints:
        placement = pin.SE3(joint.placement.rotation, joint.placement.translation)
        model.addJoint(joint.parent + 1, _joint_model(joint), placement, joint.name)
    return model


def _joint_model(joint: Joint) -> pin.JointModel:
    if joint.kind == "free":
        return pin.JointModelFreeFlyer()
    if joint.kind == "ball":
        return pin.JointModelSpherical()
    aligned = {
        "hinge": (pin.JointModelRX, pin.JointModelRY, pin.JointModelRZ),
        "slide": (pin.JointModelPX, pin.JointModelPY, pin.JointModelPZ),
    }[joint.kind]
    for axis, kind in zip(AXES, aligned, strict=True):
        if np.array_equal(joint.axis, axis):
            return kind()
    unaligned = pin.JointModelRevoluteUnaligned if joint.kind == "hinge" else pin.JointModelPrismaticUnaligned
    return unaligned(joint.axis)


def loop_constraints(geometry: Geometry, model: pin.Model) -> list[pin.ConstraintModel]:
    """The loop closures as Pinocchio's constraints, for cross-checks."""
    constraints = []
    for loop in geometry.loops:
        ends = []
        for anchor in (loop.first, loop.second):
            ends += [anchor.joint + 1, pin.SE3(anchor.placement.rotation, anchor.placement.translation)]
        kind = pin.PointAnchorConstraintModel if loop.kind == "connect" else pin.FrameAnchorConstraintModel
        constraints.append(kind(model, *ends))
    return constraints
