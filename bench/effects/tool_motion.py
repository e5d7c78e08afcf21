"""The tool's position, and the motor torques for a force there."""

import numpy as np

from bench.effects.signals import RobotSignals
from bench.model.geometry import Anchor, Geometry, Placement
from bench.model.kinematics import ancestors, end_of, end_point, frames_of, link_columns, link_of


def tool_motion(robot: RobotSignals) -> tuple[np.ndarray, np.ndarray]:
    """At the coarse samples: the tool's offset from home (K, 3) in m, and its Jacobian (K, 3, n).

    In the world's axes. The Jacobian is by the active velocities. For a robot without a tool, the origin of its free
    platform or last body is used.
    """
    geometry, tree = robot.geometry, robot.tree
    q = np.column_stack((geometry.home, tree.q[:: robot.every].T))
    anchor = tool_of(geometry)
    end = end_of(anchor)
    chain = ancestors(geometry, anchor.joint)
    links = {index: link_of(index, geometry.joints[index]) for index in chain}
    frames = frames_of(tuple(links.values()), q)
    point = end_point(frames, end)
    position = np.column_stack([np.broadcast_to(x, q.shape[1]) for x in point])
    by_motor = tree.jacobian[:: robot.every]
    jacobian = np.zeros((len(by_motor), 3, by_motor.shape[2]))
    for link in links.values():
        for index, linear, _ in link_columns(link, frames, point):
            for k, x in enumerate(linear):
                jacobian[:, k] += np.broadcast_to(x, q.shape[1])[1:, None] * by_motor[:, index]
    return position[1:] - position[0], jacobian


def tool_of(geometry: Geometry) -> Anchor:
    """The place of the tool or of its substitute."""
    if geometry.tool is not None:
        return geometry.tool
    free = [i for i, joint in enumerate(geometry.joints) if joint.kind == "free"]
    return Anchor(free[0] if free else len(geometry.joints) - 1, Placement(np.eye(3), np.zeros(3)))


def tool_speed(robot: RobotSignals) -> np.ndarray:
    """Speed of the tool (N,), m/s, as the motors move it."""
    _, jacobian = tool_motion(robot)
    velocity = np.einsum("kxn,kn->kx", jacobian, robot.coarse.velocity)
    return np.asarray(np.linalg.norm(robot.refined(velocity), axis=1))
