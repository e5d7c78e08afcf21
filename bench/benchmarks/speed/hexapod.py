"""A Gough-Stewart platform, the largest parallel robot that is measured: six motors, six closed loops.

Legs of equal length between two hexagons. Each leg hangs on a universal joint of the base and pushes its rod, a
slide with a motor, against a ball joint of the platform, which is a free body: 6 · 3 + 6 = 24 tree degrees of
freedom, 6 once closed.
"""

from pathlib import Path

import numpy as np

LEGS = 6
BASE, PLATFORM = 0.40, 0.22  # m, radii of the joints
HALF_ANGLE = 0.2  # rad, between the joints of a pair and the middle of the pair
HEIGHT = 0.65  # m, of the platform above the base in the home pose
RETRACTED = 0.35  # m, from a rod's origin to its end, the ball joint

_LEG = """
    <body name="leg_{i}" pos="{foot}" quat="{turn}">
      <inertial pos="0 0 0.15" mass="2.0" diaginertia="0.02 0.02 0.003"/>
      <joint name="tilt_{i}" type="hinge" axis="1 0 0"/>
      <joint name="swing_{i}" type="hinge" axis="0 1 0"/>
      <body name="rod_{i}" pos="0 0 {inside}">
        <inertial pos="0 0 0.20" mass="1.2" diaginertia="0.015 0.015 0.001"/>
        <joint name="leg_{i}" type="slide" axis="0 0 1" range="-0.2 0.2" armature="4"/>
      </body>
    </body>"""

_MODEL = """<mujoco model="hexapod">
  <compiler angle="radian" autolimits="true" inertiafromgeom="false"/>
  <option timestep="0.00025" integrator="Euler" solver="Newton" jacobian="dense">
    <flag contact="disable"/>
  </option>
  <default>
    <equality solref="0.002 1" solimp="0.9999 0.99999 0.001"/>
  </default>
  <worldbody>{legs}
    <body name="platform" pos="0 0 {height}">
      <freejoint name="pose"/>
      <inertial pos="0.01 -0.005 0.02" mass="6.0" diaginertia="0.08 0.09 0.15"/>
      <site name="tool" pos="0 0 0.03"/>
    </body>
  </worldbody>
  <equality>{loops}
  </equality>
</mujoco>
"""

_ACTUATOR = """
[[actuators]]
joint = "leg_{i}"
gain = 40.0
gain_unit = "N/A"
"""


def write_hexapod(folder: Path) -> Path:
    """Write the robot's folder: its MJCF and robot.toml."""
    legs, loops = [], []
    for i in range(LEGS):
        foot, ball = _joint(i, BASE, 0.0, outer=False), _joint(i, PLATFORM, HEIGHT, outer=True)
        length = float(np.linalg.norm(ball - foot))
        numbers = {
            "foot": _text(foot),
            "turn": _text(_turn(ball - foot)),
            "inside": f"{length - RETRACTED:.9g}",
        }
        legs.append(_LEG.format(i=i + 1, **numbers))
        loops.append(f'\n    <connect body1="rod_{i + 1}" body2="platform" anchor="0 0 {RETRACTED}"/>')
    folder.mkdir(parents=True, exist_ok=True)
    model = _MODEL.format(legs="".join(legs), loops="".join(loops), height=HEIGHT)
    (folder / "hexapod.xml").write_text(model, encoding="utf-8")
    head = 'name = "hexapod"\nmodel = "hexapod.xml"\n'
    motors = "".join(_ACTUATOR.format(i=i + 1) for i in range(LEGS))
    (folder / "robot.toml").write_text(f'{head}{motors}\n[tool]\nsite = "tool"\n', encoding="utf-8")
    return folder


def _joint(i: int, radius: float, height: float, *, outer: bool) -> np.ndarray:
    """Position of a leg's joint: in pairs on the base, in pairs half a turn of a third away on the platform."""
    pair, side = divmod(i + 1, 2) if outer else divmod(i, 2)
    middle = 2.0 * np.pi * (pair + (-0.5 if outer else 0.0)) / 3.0
    angle = middle + (2 * side - 1) * HALF_ANGLE
    return np.array([radius * np.cos(angle), radius * np.sin(angle), height])


def _turn(direction: np.ndarray) -> np.ndarray:
    """Quaternion (w, x, y, z) that turns the z axis into a direction."""
    unit = direction / np.linalg.norm(direction)
    turn = np.array([1.0 + unit[2], -unit[1], unit[0], 0.0])
    return np.asarray(turn / np.linalg.norm(turn))


def _text(values: np.ndarray) -> str:
    return " ".join(f"{value:.9g}" for value in values)
