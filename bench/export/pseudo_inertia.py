"""Standard parameters of a body as its pseudo-inertia, which is positive definite for every body of real mass.

P = [[S, h], [h', m]] with S = tr(I)/2 1 - I, about any frame: I (3, 3) its inertia there, h its first moments and
m its mass. P is positive definite if and only if some distribution of positive density has these parameters
(Wensing, Kim and Slotine, "Linear matrix inequalities for physically consistent inertial parameter identification",
IEEE Robotics and Automation Letters 3(1), 2018). Parameters as in `bench.model.regressor`.
"""

import numpy as np


def pseudo_inertia(parameters: np.ndarray) -> np.ndarray:
    """P (4, 4) of standard parameters (10,)."""
    mass, first = parameters[0], parameters[1:4]
    inertia = inertia_matrix(parameters)
    matrix = np.empty((4, 4))
    matrix[:3, :3] = 0.5 * np.trace(inertia) * np.eye(3) - inertia
    matrix[:3, 3] = matrix[3, :3] = first
    matrix[3, 3] = mass
    return matrix


def inertia_matrix(parameters: np.ndarray) -> np.ndarray:
    """I (3, 3) of standard parameters (10,), about their frame, kg m2."""
    xx, xy, yy, xz, yz, zz = parameters[4:]
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def standard_parameters(matrix: np.ndarray) -> np.ndarray:
    """Standard parameters (10,) of P (4, 4); linear in P."""
    square = matrix[:3, :3]
    inertia = np.trace(square) * np.eye(3) - square
    return np.concatenate(([matrix[3, 3]], matrix[:3, 3], inertia[[0, 0, 1, 0, 1, 2], [0, 1, 1, 2, 2, 2]]))


def from_scaled(root: np.ndarray) -> np.ndarray:
    """(10, 16): standard parameters for the entries, row by row, of symmetric Q with P = root Q root'."""
    columns = np.empty((10, 16))
    for place, unit in enumerate(np.eye(16)):
        entry = unit.reshape(4, 4)
        columns[:, place] = standard_parameters(root @ (0.5 * (entry + entry.T)) @ root.T)
    return columns


def about_center(parameters: np.ndarray) -> tuple[float, np.ndarray, np.ndarray]:
    """Mass kg, centre of mass (3,) m in the frame, and inertia (3, 3) kg m2 about that centre in the frame's axes.

    A body without mass has its centre at the origin.
    """
    mass = float(parameters[0])
    center = parameters[1:4] / mass if mass else np.zeros(3)
    square = float(center @ center) * np.eye(3) - np.outer(center, center)
    return mass, center, inertia_matrix(parameters) - mass * square
