"""The semidefinite programs of `bench.export.physical`, written for cvxpy and solved by Clarabel.

Unknowns are Q of every body, P = L Q L' with L L' the prior's pseudo-inertia, so that all are about one, and the
rotors' inertias.
"""

import warnings
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from scipy.linalg import block_diag

from bench.basics.errors import BenchError
from bench.export.bodies import BodyEquations, from_scaled, pseudo_inertia

LEAST = 1e-4  # of the prior: minimum for every body
MOST = 1e3  # times the prior: maximum, since the nearest bodies may be infinitely heavy
AT_LIMIT = 1e-4  # of the largest multiplier of any condition: with a smaller one it is not active
SMALLEST = 1e-12  # of the largest eigenvalue of a correlation: below it a direction counts as exactly known
ROTOR = 1e-2  # weight of a rotor for which there is no prior, against a body's entries: inertia is the link's first
SETTINGS: tuple[Mapping[str, float], ...] = (
    {},
    {"max_step_fraction": 0.9},
    {"static_regularization_constant": 1e-7},
)
"""Of Clarabel: default, with shorter steps from the limits, with better conditioned equations."""
VIOLATED = 1e-5  # tolerance of a condition: less than any body keeps of its prior

Reached = tuple[list[np.ndarray], np.ndarray]  # standard parameters of every body, inertias of rotors


@dataclass(frozen=True)
class Nearest:
    """Distance of the nearest real bodies from the estimate, in standard errors.

    freedom: the number of independent active conditions. estimated (nz,): their base and payload parameters.
    """

    distance: float
    freedom: int
    estimated: np.ndarray


class Programs:
    """The programs of one set of equations."""

    def __init__(self, equations: BodyEquations) -> None:
        self.equations = equations
        roots = [np.linalg.cholesky(pseudo_inertia(body.prior)) for body in equations.bodies]
        self._columns = [from_scaled(root) for root in roots]  # (10, 16) each
        rotors = np.abs(equations.rotors)
        self._moving = np.flatnonzero(rotors.any(axis=0))  # rotors in the estimate
        self._unit = self._rotor_units()

    def _rotor_units(self) -> np.ndarray:
        """Unit of each rotor's inertia, kg m2 or kg: its prior, or the bodies' inertia at its motor."""
        prior, share = self.equations.rotor_prior, np.abs(self.equations.rotors)
        size = np.abs(self.equations.estimated)
        shown = np.array([size[share[:, j] > 0.0].max(initial=0.0) for j in range(share.shape[1])])
        return np.where(prior > 0.0, prior, np.where(shown > 0.0, shown, 1.0))

    @cached_property
    def _cvxpy(self) -> Any:
        try:
            import cvxpy  # noqa: PLC0415 - a second to import, and optional
        except ModuleNotFoundError as error:
            raise BenchError(
                f"physical parameters need {error.name}: pip install 'parabench[export]'"
            ) from None
        return cvxpy

    @cached_property
    def _map(self) -> np.ndarray:
        """(nz, 16 bodies + rotors): from unknowns to estimated parameters."""
        parts = [body.rows @ m for body, m in zip(self.equations.bodies, self._columns, strict=True)]
        parts.append(self.equations.rotors[:, self._moving] * self._unit[self._moving])
        return np.hstack(parts)

    @cached_property
    def _held(self) -> tuple[np.ndarray, np.ndarray]:
        """Equations of single bodies (k, unknowns) and right sides (k,), each row of unit length."""
        bodies = self.equations.bodies
        blocks = [body.held @ m for body, m in zip(bodies, self._columns, strict=True)]
        rows = np.hstack((block_diag(*blocks), np.zeros((sum(map(len, blocks)), len(self._moving)))))
        given = np.concatenate([body.to for body in bodies])
        length = np.linalg.norm(rows, axis=1)
        return rows / length[:, None], given / length

    @cached_property
    def _whitening(self) -> np.ndarray:
        """(k, nz): estimated parameters in standard errors."""
        free = np.flatnonzero(~self.equations.fixed & (np.diag(self.equations.covariance) > 0.0))
        if not len(free):
            return np.zeros((0, len(self.equations.fixed)))
        covariance = self.equations.covariance[np.ix_(free, free)]
        std = np.sqrt(np.diag(covariance))
        values, vectors = np.linalg.eigh(covariance / np.outer(std, std))
        values = np.maximum(values, SMALLEST * values[-1])
        white = np.zeros((len(free), len(self.equations.fixed)))
        white[:, free] = (vectors / np.sqrt(values)).T / std
        return white

    @cached_property
    def _steepness(self) -> float:
        """Most standard errors per unit of the unknowns."""
        return max(1.0, float(np.linalg.norm(self._whitening @ self._map, axis=1).max(initial=0.0)))

    def _unknowns(self) -> tuple[list[Any], Any, Any]:
        cp = self._cvxpy
        bodies = [cp.Variable((4, 4), symmetric=True) for _ in self.equations.bodies]
        rotors = cp.Variable(len(self._moving)) if len(self._moving) else None
        listed = [cp.vec(body, order="C") for body in bodies]
        return bodies, rotors, cp.hstack([*listed, rotors] if rotors is not None else listed)

    def nearest(self, without: int | None = None) -> Nearest:
        """The real bodies nearest to the estimate; without: a body that need not be real."""
        cp = self._cvxpy
        bodies, rotors, x = self._unknowns()
        real = [body >> LEAST * np.eye(4) for i, body in enumerate(bodies) if i != without]
        real += [] if rotors is None else [rotors >= 0.0]
        finite = [body << MOST * np.eye(4) for body in bodies]
        finite += [] if rotors is None else [rotors <= MOST]
        off = self._off(x, 1.0 / self._steepness)
        problem = cp.Problem(cp.Minimize(cp.norm(off)), [*real, *finite, *self._held_conditions(x)])
        if not self._solved(problem):
            raise self.not_found()
        estimated = self._map @ x.value
        distance = float(np.linalg.norm(self._whitening @ (estimated - self.equations.estimated)))
        duals = [condition.dual_value for condition in real]
        pressing = [  # multipliers of each condition by direction
            np.linalg.eigvalsh(0.5 * (dual + dual.T)) if dual.ndim == 2 else np.atleast_1d(dual)
            for dual in duals
        ]
        least = AT_LIMIT * max((float(values.max(initial=0.0)) for values in pressing), default=0.0)
        freedom = 0
        for dual, pressures in zip(duals, pressing, strict=True):
            rank = int((pressures > least).sum()) if least > 0.0 else 0
            freedom += rank * (rank + 1) // 2 if dual.ndim == 2 else rank
        return Nearest(distance, min(freedom, len(self._whitening)), np.asarray(estimated))

    def _off(self, x: Any, scale: float) -> Any:
        """Distance of the estimated parameters from the estimate, standard errors times `scale`, in each direction."""
        known = self._whitening
        return scale * (known @ self._map) @ x - scale * known @ self.equations.estimated

    def drawn_to_prior(self, distance: float) -> Reached | None:
        """Of all bodies within `distance` standard errors of the estimate, those nearest to the prior.

        distance: zero to reproduce the estimate. None if there are no such bodies.
        """
        cp = self._cvxpy
        bodies, rotors, x = self._unknowns()
        if distance > 0.0:
            scale = 1.0 / max(distance, self._steepness)
            met = cp.norm(self._off(x, scale)) <= scale * distance
        else:
            length = np.linalg.norm(self._map, axis=1)
            length[length == 0.0] = 1.0
            met = (self._map / length[:, None]) @ x == self.equations.estimated / length
        conditions = [met, *self._held_conditions(x)]
        far = sum(cp.trace(body) - cp.log_det(body) for body in bodies)
        if rotors is not None:
            conditions.append(rotors >= 0.0)
            given = self.equations.rotor_prior[self._moving] > 0.0
            for i, has_prior in enumerate(given):
                far = far + (rotors[i] - cp.log(rotors[i]) if has_prior else ROTOR * rotors[i])
        problem = cp.Problem(cp.Minimize(far), conditions)
        return self._split(x.value) if self._solved(problem) else None

    def moved_onto(self, reached: Reached) -> Reached | None:
        """The bodies moved by the least distance onto the estimate, to rounding; None if no longer real."""
        parameters, rotors = reached
        bodies = self.equations.bodies
        columns = [from_scaled(np.linalg.cholesky(pseudo_inertia(parameter))) for parameter in parameters]
        held = block_diag(*(body.held @ basis for body, basis in zip(bodies, columns, strict=True)))
        rows = [body.rows @ basis for body, basis in zip(bodies, columns, strict=True)]
        whole = np.vstack((np.hstack(rows), held))
        missing = [body.to - body.held @ values for body, values in zip(bodies, parameters, strict=True)]
        off = np.concatenate((self.equations.estimated - self.estimated_of(parameters, rotors), *missing))
        length = np.linalg.norm(whole, axis=1)
        length[length == 0.0] = 1.0
        step = np.linalg.lstsq(whole / length[:, None], off / length, rcond=1e-12)[0].reshape(-1, 16)
        moved = [p + basis @ s for p, basis, s in zip(parameters, columns, step, strict=True)]
        if min(np.linalg.eigvalsh(pseudo_inertia(entry))[0] for entry in moved) <= 0.0:
            return None
        return moved, rotors

    def estimated_of(self, parameters: list[np.ndarray], rotors: np.ndarray) -> np.ndarray:
        """The estimated parameters (nz,) of bodies and rotors."""
        bodies = zip(self.equations.bodies, parameters, strict=True)
        return np.asarray(sum(body.rows @ values for body, values in bodies) + self.equations.rotors @ rotors)

    def _held_conditions(self, x: Any) -> list[Any]:
        rows, given = self._held
        conditions = [rows @ x == given] if len(rows) else []
        exactly = np.flatnonzero(self.equations.fixed)
        if len(exactly):
            conditions.append(self._map[exactly] @ x == self.equations.estimated[exactly])
        return conditions

    def _split(self, x: np.ndarray) -> Reached:
        count = len(self.equations.bodies)
        entries = x[: 16 * count].reshape(count, 16)
        parameters = [m @ column for m, column in zip(self._columns, entries, strict=True)]
        rotors = np.zeros(self.equations.rotors.shape[1])
        rotors[self._moving] = np.maximum(x[16 * count :], 0.0) * self._unit[self._moving]
        return parameters, rotors

    def not_found(self) -> BenchError:
        """That no real bodies were found, and what the user can do."""
        if self.equations.fixed.any():
            why = "the model omits base parameters; identify without --essential"
        else:
            why = (
                "the data determine its parameters too unequally; declare more of the payload, or add recordings that "
                "load the motors more (bench excite --after)"
            )
        return BenchError(f"no physically possible bodies were found for this model: {why}")

    def _solved(self, problem: Any) -> bool:
        """Solve it, with safer settings if the solver fails; any solution must keep its conditions."""
        cp = self._cvxpy
        for settings in SETTINGS:
            try:
                with warnings.catch_warnings():
                    warnings.simplefilter(
                        "ignore", UserWarning
                    )  # of an inaccurate solution: it is checked below
                    problem.solve(solver=cp.CLARABEL, **settings)
            except cp.error.SolverError:
                continue
            if problem.status in ("optimal", "optimal_inaccurate"):
                violations = [float(np.max(constraint.violation())) for constraint in problem.constraints]
                if max(violations) <= VIOLATED:
                    return True
        return False
