"""An exported MJCF beside a recording, with nothing but mujoco and numpy: FILE.xml RECORDING.csv BAND_IN_HZ."""

import sys

import mujoco
import numpy as np

m = mujoco.MjModel.from_xml_path(sys.argv[1])
d, log, band = (
    mujoco.MjData(m),
    np.genfromtxt(sys.argv[2], delimiter=",", names=True, deletechars=""),
    float(sys.argv[3]),
)
joints = [m.joint(m.actuator_trnid[i, 0]) for i in range(m.nu)]
at, dof = [j.qposadr[0] for j in joints], [j.dofadr[0] for j in joints]
position, current = ([log[f"{what}.{j.name}"] for j in joints] for what in ("position", "current"))
m.opt.timestep = h = np.mean(np.diff(log["time"]))


def low(x, cut, order=0):  # low-passed derivative of x (n, N), mirrored at both ends
    line = np.linspace(x[:, 0], x[:, -1], x.shape[1]).T
    f = np.fft.rfftfreq(2 * x.shape[1], h)
    y = (
        np.fft.rfft(np.concatenate((x - line, (line - x)[:, ::-1]), axis=1))
        * (f < cut)
        * (2j * np.pi * f) ** order
    )
    return (np.fft.irfft(y)[:, : x.shape[1]] + [line, np.gradient(line, h, axis=1), 0][order]).T


mujoco.mj_resetDataKeyframe(m, d, 0)
way = 0.5 - 0.5 * np.cos(
    np.linspace(0, np.pi, round(1 / h))
)  # one second from home to where the recording starts
x = np.concatenate(
    (d.qpos[at, None] + (np.array(position)[:, :1] - d.qpos[at, None]) * way, position), axis=1
)
q, v, a = (low(x, 2 * band, k) for k in range(3))
friction, m.dof_frictionloss[:] = m.dof_frictionloss.copy(), 0


def acceleration(currents):
    d.ctrl[:] = currents
    mujoco.mj_forward(m, d)
    return d.qacc[dof].copy()


needed, u, w = (
    np.linalg.inv([acceleration(e) - acceleration(0 * e) for e in np.eye(m.nu)]).T,
    np.zeros(m.nu),
    60,
)
m.dof_frictionloss[:] = friction
simulated = np.zeros_like(q)
for k in range(len(q)):
    u = u + needed @ (a[k] + w * w * (q[k] - d.qpos[at]) + 2 * w * (v[k] - d.qvel[dof]) - acceleration(u))
    simulated[k] = d.ctrl[:] = u
    mujoco.mj_step(m, d)
start, border = len(way), round(0.5 / h)
moving = np.abs(v) > 0.1 * np.sqrt(np.mean(v**2, axis=0))  # where dry friction has its size
measured, twin, moving = (
    part[border:-border]
    for part in (low(np.array(current), band), low(simulated[start:].T, band), moving[start:])
)
sys.stdout.write(f"{np.sqrt((((measured - twin) * moving) ** 2).sum() / ((measured * moving) ** 2).sum())}\n")
