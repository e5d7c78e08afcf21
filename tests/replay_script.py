"""An exported MJCF beside a recording, with nothing but mujoco and numpy: FILE.xml RECORDING.csv BAND_IN_HZ.

A stiff controller changes the currents until the twin has the recorded acceleration and stays on the recorded
motion. Motions end as they start, at rest at home; what is not moving, or where the twin still settles, does not count.
"""

import sys

import mujoco
import numpy as np

m, band = mujoco.MjModel.from_xml_path(sys.argv[1]), float(sys.argv[3])
d = mujoco.MjData(m)
mujoco.mj_resetDataKeyframe(m, d, 0)
log = np.genfromtxt(sys.argv[2], delimiter=",", names=True, deletechars="")
joints = [m.joint(j) for j in m.actuator_trnid[:, 0]]
at, dof = [j.qposadr[0] for j in joints], [j.dofadr[0] for j in joints]
position, current = (np.array([log[f"{x}.{j.name}"] for j in joints]).T for x in ("position", "current"))
m.opt.timestep = np.mean(np.diff(log["time"]))
f = np.fft.rfftfreq(len(log), m.opt.timestep)[:, None]


def low(x, cut, order=0):
    return np.fft.irfft(np.fft.rfft(x, axis=0) * (f < cut) * (2j * np.pi * f) ** order, len(x), axis=0)


q, v, a = (low(position, 2 * band, order) for order in range(3))
inertia = 0.7 * current.std(axis=0) / low(position, 2, 2).std(axis=0)
twin, current = np.zeros_like(current), low(current, band)
for k in range(len(q)):
    wanted = a[k] + 900 * (q[k] - d.qpos[at]) + 60 * (v[k] - d.qvel[dof])
    twin[k] = d.ctrl[:] = d.ctrl + inertia * (wanted - d.qacc[dof])
    mujoco.mj_step(m, d)
moving = (np.abs(v) > 0.1 * v.std(axis=0)) & (np.minimum(log["time"], log["time"][::-1]) > 0.5)[:, None]
sys.stdout.write(f"{np.linalg.norm((low(twin, band) - current)[moving] / np.linalg.norm(current[moving]))}\n")
