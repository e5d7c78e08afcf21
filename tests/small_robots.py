"""Small robots that have what the built-in ones lack: welds, slides, ball joints, skewed bodies."""

from bench.dataset.robot import load_robot

# A platform welded to a rail; joints off their bodies' origins, reference positions, skewed bodies.
WELDED = """<mujoco>
  <compiler angle="radian"/>
  <worldbody>
    <body name="turret" pos=".1 .2 .3" quat="0.9 .1 .2 .3">
      <joint name="turn" axis="0 1 0.2" pos=".05 .02 0" ref="0.3" range="-0.7 1.3"/>
      <joint name="rail" type="slide" axis="1 1 0" range="-0.2 0.2" ref="0.05"/>
      <geom size=".1" pos=".1 0 0"/>
      <body name="bracket" pos=".1 .1 .1" quat="1 .2 .1 .4"><geom size=".07" pos="0 .1 0"/></body>
    </body>
    <body name="platform" pos=".5 0 .3" quat=".9 0 .4 .2">
      <freejoint name="floating"/>
      <geom type="box" size=".1 .03 .2" pos=".1 .02 .1"/>
      <site name="tool" pos="0 0 .1"/>
    </body>
  </worldbody>
  <equality>{equality}</equality>
</mujoco>
"""

# A crank, a ball joint, a rod with a universal joint at its end, and a rocker: one loop in space, one motor.
SPATIAL = """<mujoco>
  <compiler angle="radian"/>
  <worldbody>
    <body name="crank">
      <joint name="crank" axis="0 1 0" range="-0.4 0.4"/>
      <geom type="capsule" fromto="0 0 0 0 0 .2" size=".02"/>
      <body name="rod" pos="0 0 .2">
        <joint name="ball" type="ball"/>
        <geom type="capsule" fromto="0 0 0 .5 .1 .05" size=".02"/>
        <body name="cross" pos=".5 .1 .05">
          <joint name="cross_1" axis="0 0 1"/>
          <joint name="cross_2" axis="1 0 .2"/>
          <geom type="box" size=".03 .02 .01" pos="0 .01 0"/>
        </body>
      </body>
    </body>
    <body name="rocker" pos=".5 .1 -.1">
      <joint name="rocker" axis=".1 1 .2"/>
      <geom type="capsule" fromto="0 0 0 0 0 .15" size=".02"/>
    </body>
  </worldbody>
  <equality><weld name="loop" body1="cross" body2="rocker"/></equality>
</mujoco>
"""

SERIAL = """<mujoco>
  <worldbody>
    <body name="upper">
      <joint name="shoulder" axis="0 0 1" armature=".1"/>
      <geom type="capsule" fromto="0 0 0 .3 0 0" size=".02"/>
      <body name="fore" pos=".3 0 0">
        <joint name="elbow" axis="0 1 0"/>
        <geom type="capsule" fromto="0 0 0 .3 .02 0" size=".02"/>
      </body>
    </body>
  </worldbody>
</mujoco>
"""

PLAIN = '<weld name="hold" body1="turret" body2="platform"/>'
OTHER_WELDS = {
    "by_bodies": PLAIN,
    "scaled": '<weld name="hold" body1="turret" body2="platform" torquescale="2.5"/>',
    "swapped": '<weld name="hold" body1="platform" body2="bracket"/>',
    "to_a_fixed_body": '<weld name="hold" body1="bracket" body2="platform" anchor=".1 .2 .3"/>',
}


def write_robot(folder, mjcf, joints, tool=None):
    folder.mkdir()
    (folder / "robot.xml").write_text(mjcf)
    text = 'name = "robot"\nmodel = "robot.xml"\n'
    for joint, unit in joints.items():
        text += f'[[actuators]]\njoint = "{joint}"\ngain = 2.0\ngain_unit = "{unit}"\n'
    (folder / "robot.toml").write_text(text + (f'[tool]\nsite = "{tool}"\n' if tool else ""))
    return load_robot(folder)


def welded(folder, equality=PLAIN):
    joints = {"turn": "N*m/A", "rail": "N/A"}
    return write_robot(folder, WELDED.format(equality=equality), joints, "tool")


def spatial(folder):
    return write_robot(folder, SPATIAL, {"crank": "N*m/A"})
