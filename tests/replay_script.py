"""An exported MJCF beside a recording, with nothing but mujoco and numpy: FILE.xml RECORDING.csv BAND_IN_HZ."""

import sys

import mujoco
import numpy as np

m = mujoco.MjModel.from_xml_path(sys.argv[1])
log = np.genfromtxt(sys.argv[2], delimiter=",", names=True, deletechars="")
joints = [m.joint(m.actuator_trnid[i, 0]) for i in range(m.nu)]
at, dof = [j.qposadr[0] for j in joints], [j.dofadr[0] for j in joints]
position, current = (np.array([log[f"{x}.{j.name}"] for j in joints]).T for x in ("position", "current"))
m.opt.timestep = h = np.mean(np.diff(log["time"]))
f, band = np.fft.rfftfreq(len(log), h)[:, None], float(sys.argv[3])


def low(
    x, cut, order=0
):  # the derivative of x (N, n) below a frequency; it ends as it starts, at rest at home
    return np.fft.irfft(np.fft.rfft(x, axis=0) * (f < cut) * (2j * np.pi * f) ** order, len(x), axis=0)


def acceleration(currents):
    d.ctrl[:] = currents
    mujoco.mj_forward(m, d)
    return d.qacc[dof].copy()


d, u, twin = mujoco.MjData(m), np.zeros(m.nu), np.zeros_like(current)
mujoco.mj_resetDataKeyframe(m, d, 0)
q, v, a = (low(position, 2 * band, k) for k in range(3))
needed = np.linalg.inv([acceleration(50 * e) - acceleration(-50 * e) for e in np.eye(m.nu)]).T * 100
for k in range(len(q)):  # what is asked of the motors for the recorded acceleration, and a stiff controller's
    u = u + needed @ (a[k] + 3600 * (q[k] - d.qpos[at]) + 120 * (v[k] - d.qvel[dof]) - acceleration(u))
    twin[k] = d.ctrl[:] = u
    mujoco.mj_step(m, d)
seen = (np.minimum(log["time"], log["time"][::-1]) > 0.5)[:, None]  # not where it settles, nor stands still
seen = seen & (np.abs(v) > 0.1 * v.std(axis=0))
off, whole = (np.linalg.norm(low(x, band)[seen]) for x in (current - twin, current))
sys.stdout.write(f"{off / whole}\n")
