"""Small mechanisms with what robots may have and the built-in ones lack, all assembled at qpos0."""

from pathlib import Path

import numpy as np

from bench.dataset.catalogue import built_in_robots
from bench.dataset.robot import Robot, load_robot
from bench.model.geometry import Geometry, read_geometry

HEAD = """
<mujoco>
  <compiler angle="radian" autolimits="true"/>
  <option gravity="0.4 -0.9 -9.7"><flag contact="disable"/></option>
  <default><geom type="box" size=".08 .03 .05" density="2500"/></default>
"""

# A five-bar in a tilted plane: repeated equations that no axis is aligned with, joints with an offset,
# bodies without a joint above and below, a connect given by an anchor.
TILTED = """
  <worldbody>
    <body name="frame" pos="0.1 -0.2 0.5" euler="0.4 -0.7 0.3">
      <body name="left_crank" pos="-0.1 0 0"><joint name="left" axis="0 0 1" ref="0.3"/>
        <geom pos="0.05 0.02 0.03" euler="0.3 0.2 0.1"/>
        <body name="left_rod" pos="-0.12 0.16 0"><joint name="left_elbow" axis="0 0 1" ref="-0.2"/>
          <geom pos="0.1 0.12 0.01" euler="0.1 -0.2 0.5"/>
          <body name="weight" pos="0.02 0.01 0.1" euler="1 2 3"><geom pos="0.03 0.02 0.01"/></body>
          <site name="tool" pos="0.22 0.24 0.03" euler="0.3 0.6 -0.2"/></body></body>
      <body name="right_crank" pos="0.15 0 0"><joint name="right" axis="0 0 1"/>
        <geom pos="0.04 0.06 -0.02" euler="0.2 0.2 -0.1"/>
        <body name="right_rod" pos="0.1 0.17 0"><joint name="right_elbow" axis="0 0 1" ref="0.5"/>
          <geom pos="-0.1 0.1 -0.02" euler="-0.4 0.3 0.2"/></body></body>
    </body>
  </worldbody>
  <equality><connect name="tips" body1="left_rod" body2="right_rod" anchor="0.22 0.24 0"/></equality>
"""

# A four-bar on a turntable, which moves both sides of the weld between the halves of its coupler.
WELDED = """
  <worldbody>
    <body name="table"><joint name="turn" axis="0.1 0.2 1"/><geom euler="0.1 0.1 0.4" pos="0.1 0 0"/>
      <body name="crank" pos="0 0 0.1"><joint name="crank" axis="0 1 0"/><geom pos="0.01 0.02 0.1"/>
        <body name="coupler_a" pos="0 0 0.2"><joint name="pin_a" axis="0 1 0"/><geom pos="0.1 0 0.02"/></body>
      </body>
      <body name="rocker" pos="0.4 0 0.1"><joint name="rocker" axis="0 1 0" ref="0.2"/>
        <geom pos="0.02 0 0.1"/>
        <body name="coupler_b" pos="0.05 0 0.25" euler="0 0.5 0"><joint name="pin_b" axis="0 1 0"/>
          <geom pos="-0.1 0.03 0.02"/></body>
      </body>
    </body>
  </worldbody>
  <equality><weld name="coupler" body1="coupler_a" body2="coupler_b" anchor="0.1 0.02 0.03"/></equality>
"""

# A crank that drives a slide through a rod: a ball joint, axes that are not aligned, two hinges in one body
# at different points, a weld given by sites.
BALL = """
  <worldbody>
    <body name="crank"><joint name="crank" axis="0.3 1 0.2"/><geom pos="0.1 0.02 0.05" euler="0.1 0.3 0"/>
      <body name="rod" pos="0.2 0 0.1"><joint name="ball" type="ball" pos="0.01 0.02 -0.01"/>
        <geom pos="0.25 0.01 0.02" euler="0.3 0.1 0.2"/>
        <site name="rod_end" pos="0.5 0.1 0" euler="0.2 0.1 0.4"/></body></body>
    <body name="slider" pos="0.8 0.1 0"><joint name="slide" type="slide" axis="1 0.2 0.1"/>
      <geom pos="0.02 0.03 0.01"/>
      <body name="knuckle" pos="0 0 0.1">
        <joint name="pitch" axis="0 1 0" pos="0.01 0 0.02"/>
        <joint name="yaw" axis="0.1 0.2 1" pos="0 0.03 0"/>
        <geom pos="0.01 0.02 0.05" euler="0.4 0.1 0.9"/>
        <site name="grip" pos="-0.1 0 0" euler="0.2 0.1 0.4"/></body></body>
  </worldbody>
  <equality><weld name="grip" site1="rod_end" site2="grip"/></equality>
"""

# A free body carried by a slide and a hinge: several roots, a weld to a free joint.
CARRIED = """
  <worldbody>
    <body name="carriage" pos="0 0.1 0"><joint name="x" type="slide" axis="0.6 0 0.8" ref="0.05"/><geom/>
      <body name="arm" pos="0.1 0 0"><joint name="swing" axis="0 1 1"/><geom pos="0.1 0.03 0"/></body></body>
    <body name="load" pos="0.35 0.15 0.02" euler="0.3 0.5 0.7"><freejoint name="load"/>
      <geom pos="0.02 0.03 0.04" euler="1 0.5 0.2"/>
      <site name="tool" pos="0.1 0 0.05" euler="0.1 0.2 0.3"/></body>
  </worldbody>
  <equality><weld name="held" body1="load" body2="arm"/></equality>
"""

# No loop at all: a branched tree, every joint driven, one axis all but aligned.
SERIAL = """
  <worldbody>
    <body name="base" pos="0.1 0.2 0.3" euler="0.2 0 0.4"><joint name="a" axis="1 2 3" ref="-0.4"/>
      <geom pos="0.1 0 0.1" euler="0.4 0.4 0.1"/>
      <body name="wrist" pos="0.2 0.1 0"><joint name="b" axis="0 1 0" pos="0.02 0 0"/>
        <joint name="c" axis="0 3e-8 -1" pos="0 0.03 0" ref="0.1"/><geom pos="0.05 0.02 0"/></body>
      <body name="finger" pos="0 0 0.2"><joint name="d" type="slide" axis="0 -1 0.5" ref="0.02"/>
        <geom pos="0.03 0.02 0.05"/><site name="tool" pos="0.1 0 0.05" euler="0.1 0.2 0.3"/></body></body>
  </worldbody>
"""

# A follower that a gear of changing ratio drives, behind a serial arm; a joint that an equality holds.
GEARED = """
  <worldbody>
    <body name="base"><joint name="a" axis="0.1 1 0.2" ref="0.2"/><geom pos="0.1 0 0.1"/>
      <body name="link" pos="0.2 0.1 0"><joint name="b" axis="0 1 0.3"/><geom pos="0.05 0.02 0"/>
        <body name="follower" pos="0.2 0 0.05"><joint name="c" axis="1 0.1 0" ref="-0.3"/>
          <geom pos="0.04 0.06 0.02" euler="0.2 0.1 0.4"/>
          <body name="held" pos="0.1 0 0"><joint name="d" type="slide" axis="0 1 0"/><geom euler="0.5 0 0.2"/></body>
          <site name="tool" pos="0.1 0 0.05"/></body></body></body>
  </worldbody>
  <equality><joint name="cam" joint1="c" joint2="b" polycoef="0 0.5 0.3 -0.1 0.05"/>
    <joint name="clamp" joint1="d" polycoef="0 0 0 0 0"/></equality>
"""

# A differential: the second drum, on the base, turns with both joints of the arm.
BELTED = """
  <worldbody>
    <body name="drum" pos="0 0.3 0"><joint name="drum" axis="0 1 0" ref="0.1"/><geom pos="0.01 0 0.02"/></body>
    <body name="upper"><joint name="shoulder" axis="0 1 0"/><geom pos="0.1 0 0.02"/>
      <body name="fore" pos="0.3 0 0"><joint name="elbow" axis="0 1 0.2" ref="-0.4"/>
        <geom pos="0.1 0.01 0.03"/><site name="tool" pos="0.2 0 0"/></body></body>
  </worldbody>
  <tendon>
    <fixed name="pulled"><joint joint="drum" coef="1"/></fixed>
    <fixed name="turning"><joint joint="shoulder" coef="0.5"/><joint joint="elbow" coef="2"/></fixed>
  </tendon>
  <equality><tendon name="belt" tendon1="pulled" tendon2="turning"/></equality>
"""

MECHANISMS = {
    "ball": (BALL, ("crank",), None),
    "belted": (BELTED, ("shoulder", "drum"), "tool"),
    "carried": (CARRIED, ("swing", "x"), "tool"),
    "geared": (GEARED, ("b", "a"), "tool"),
    "serial": (SERIAL, ("c", "a", "d", "b"), "tool"),
    "tilted": (TILTED, ("right", "left"), "tool"),
    "welded": (WELDED, ("crank", "turn"), None),
}
SLIDES = ("x", "d", "slide")
NAMES = (*built_in_robots(), *MECHANISMS)
LOOPED = tuple(
    name
    for name in NAMES
    if (name != "serial" if name in MECHANISMS else read_geometry(load_robot(name)).closed)
)


def write_robot(folder: Path, body: str, motors: tuple[str, ...], tool: str | None = None) -> Robot:
    """A robot of one's own: the MJCF's inner part, the driven joints, the tool site."""
    (folder / "robot.xml").write_text(f"{HEAD}{body}</mujoco>")
    lines = ['name = "mechanism"', 'model = "robot.xml"']
    for motor in motors:
        unit = "N/A" if motor in SLIDES else "N*m/A"
        lines += ["[[actuators]]", f'joint = "{motor}"', "gain = 2.0", f'gain_unit = "{unit}"']
    if tool:
        lines += ["[tool]", f'site = "{tool}"']
    (folder / "robot.toml").write_text("\n".join(lines))
    return load_robot(folder)


def robot_named(name: str, folder: Path) -> Robot:
    """A built-in robot, or one of the mechanisms above written into the folder."""
    return write_robot(folder, *MECHANISMS[name]) if name in MECHANISMS else load_robot(name)


def movement(
    geometry: Geometry, samples: int = 2001, duration: float = 2.0, size: float = 0.15
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Smooth time (N,), positions as logged, velocities and accelerations (N, n) around home, exact."""
    time = np.linspace(0.0, duration, samples)
    slide = np.array([joint.v.start for joint in geometry.joints if joint.kind == "slide"])
    home = geometry.home[geometry.active_configuration] + geometry.active_offset
    n = len(home)
    amplitude = size * np.where(np.isin(geometry.active, slide), 0.3, 1.0) * np.linspace(1.0, 0.7, n)
    rate, phase = 2.0 * np.pi * np.linspace(0.5, 0.9, n), np.linspace(0.0, 2.0, n)
    angle = rate * time[:, None] + phase
    return (
        time,
        home + amplitude * (np.sin(angle) - np.sin(phase)),
        amplitude * rate * np.cos(angle),
        -amplitude * rate**2 * np.sin(angle),
    )


def random_open_poses(geometry: Geometry, count: int, seed: int = 5) -> np.ndarray:
    """Configurations (nq, count) of the opened tree, loops ignored."""
    random = np.random.default_rng(seed)
    q = random.normal(size=(geometry.nq, count))
    for joint in geometry.joints:
        if joint.kind in ("ball", "free"):
            part = q[joint.q.stop - 4 : joint.q.stop]
            part /= np.linalg.norm(part, axis=0)
    return q


def to_mujoco(geometry: Geometry, q: np.ndarray) -> np.ndarray:
    """MuJoCo's positions (nq,) at a configuration: joint offsets added, quaternions w x y z."""
    qpos = q.copy()
    for joint in geometry.joints:
        if joint.kind in ("hinge", "slide"):
            qpos[joint.q] += joint.offset
        else:
            qpos[joint.q.stop - 4 : joint.q.stop] = np.roll(q[joint.q.stop - 4 : joint.q.stop], 1)
    return qpos
