"""The serial arm with FIGAROH: drive gains and base parameters by its total least squares on currents.

FIGAROH has no closed loops. It identifies gains from an unloaded and a loaded movement and the mass of the payload. Its
functions filter, differentiate, build and reduce the regressor, and solve; SciPy decimates, as in its examples. The
cut-off is the one that this program chose.
"""

import tempfile
import time
from importlib import import_module
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
from scipy.signal import decimate

from bench.benchmarks.peers.parabench import Answer
from bench.benchmarks.peers.problems import PeerProblem
from bench.truth.dataset import as_dataset

# available only in the environment of `make peers`
tools: Any = import_module("figaroh.identification.identification_tools")
parameters: Any = import_module("figaroh.identification.parameter")
decomposition: Any = import_module("figaroh.tools.qrdecomposition")
regressor: Any = import_module("figaroh.tools.regressor")
robots: Any = import_module("figaroh.tools.robot")

ITS_CUTOFF = (
    4.0  # `low_pass_filter_data` divides by the sampling rate instead of by half of it, and halves the result
)
ORDER = 4


def solve(problem: PeerProblem, cutoff: float, decimation: int) -> Answer:
    """Gains from the two recordings. cutoff: of the positions' filter, Hz; one sample in `decimation` is fitted."""
    dataset = as_dataset(problem.simulation)
    payload = next(iter(dataset.payloads.values()))
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "arm.urdf"
        path.write_text(_urdf(problem), encoding="utf-8")
        robot = robots.Robot(str(path), folder)
    n = robot.model.nv
    settings = {
        "ts": 1.0 / dataset.recordings[0].rate,
        "cut_off_frequency_butterworth": ITS_CUTOFF * cutoff,
        "has_friction": False,
        "has_actuator_inertia": False,
        "has_joint_offset": False,
        "is_joint_torques": True,
        "is_external_wrench": False,
        "force_torque": None,
        "act_idxv": list(range(n)),
        "mass_load": payload.mass,
        "which_body_loaded": n - 1,
    }
    start = time.process_time()
    full, currents = [], []
    for recording in dataset.recordings:
        filtered = tools.low_pass_filter_data(recording.position, settings, ORDER)
        q, dq, ddq = tools.calculate_first_second_order_differentiation(robot.model, filtered, settings)
        border = (len(recording.position) - len(filtered)) // 2
        rows = regressor.build_regressor_basic(robot, q, dq, ddq, settings).reshape(n, len(q), -1)
        full.append(np.concatenate([decimate(row, decimation, axis=0) for row in rows]))
        measured = recording.current[border : border + len(q)]
        currents.append(np.concatenate([decimate(measured[:, i], decimation) for i in range(n)]))
    names = parameters.get_standard_parameters(robot.model)
    stacked = np.concatenate(full)
    eliminated, remaining = regressor.get_index_eliminate(stacked, names, 1e-6)
    reduced = regressor.build_regressor_reduced(stacked, eliminated)
    indices, _ = decomposition.QRDecomposer()._identify_base_parameters(reduced, remaining)  # noqa: SLF001 - has no public name
    without, loaded = np.split(decomposition.build_baseRegressor(reduced, indices), 2)
    settings["nb_samples"] = len(full[0]) // n
    solution = regressor.build_total_regressor_current(
        without, loaded, _mass_last(full[1]), *currents, dict.fromkeys(range(9)), settings
    )[1]
    seconds = time.process_time() - start
    gains = np.abs(solution[len(indices) : len(indices) + n])
    return Answer("FIGAROH, payload's mass alone", seconds, gains, None, None, None)


def _mass_last(rows: np.ndarray) -> np.ndarray:
    """The columns with each body's mass last, the order that `build_total_regressor_current` assumes."""
    order = [10 * body + k for body in range(rows.shape[1] // 10) for k in (*range(1, 10), 0)]
    return rows[:, order]


def _urdf(problem: PeerProblem) -> str:
    """The arm as URDF, from its compiled model; hinges in a chain, frames at the joints."""
    model = problem.simulation.machine.models[None]
    links = ['<link name="world"/>']
    joints = []
    parent = "world"
    for name in problem.simulation.robot.joints:
        joint = model.joint(name)
        body = model.body(joint.bodyid[0])
        rotation = np.zeros(9)
        mujoco.mju_quat2Mat(rotation, body.iquat)
        turned = rotation.reshape(3, 3)
        inertia = turned @ np.diag(body.inertia) @ turned.T
        entries = {"ixx": (0, 0), "ixy": (0, 1), "ixz": (0, 2), "iyy": (1, 1), "iyz": (1, 2), "izz": (2, 2)}
        values = " ".join(f'{key}="{inertia[at]:.12g}"' for key, at in entries.items())
        links.append(
            f'<link name="{body.name}"><inertial><origin xyz="{_text(body.ipos)}"/>'
            f'<mass value="{body.mass[0]:.12g}"/><inertia {values}/></inertial></link>'
        )
        joints.append(
            f'<joint name="{name}" type="revolute"><parent link="{parent}"/><child link="{body.name}"/>'
            f'<origin xyz="{_text(body.pos)}"/><axis xyz="{_text(joint.axis)}"/>'
            f'<limit lower="-3.2" upper="3.2" effort="1000" velocity="100"/></joint>'
        )
        parent = body.name
    return f'<robot name="arm">{"".join(links)}{"".join(joints)}</robot>'


def _text(values: np.ndarray) -> str:
    return " ".join(f"{value:.12g}" for value in values)
