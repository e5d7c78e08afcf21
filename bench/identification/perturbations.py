"""Cheap small changes of motion, geometry and gravity, for a search over many effects.

The change of the observation matrix follows the motion smoothly and does not depend on the model's parameters. So it is
computed once per dataset, for all recordings together, at as few samples as the motion needs; each model then costs a
product with its parameters. A shift of an active joint counts to second order.
"""

from collections.abc import Hashable, Iterator, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from functools import cached_property, partial
from itertools import pairwise

import numpy as np

from bench.basics.errors import BenchError
from bench.basics.interpolation import cubic_spline
from bench.effects import RobotSignals, changes_torque
from bench.effects.motor_link_difference import motion_band
from bench.effects.row_cache import KeptRows, LeastAsked
from bench.effects.signals import OVERSAMPLING, UNCHANGED, Changed, JointReaction, Sparse
from bench.identification.effect_columns import PresentModel, combined_torque, needed_torque
from bench.identification.filtered import Measured
from bench.identification.observation_matrix import machine_rows
from bench.identification.perturbed_observation import (
    KEPT,
    SmallChange,
    geometry_key,
    motion_in,
    small_change,
)
from bench.identification.sparse_signals import sparse_gaps, sparse_joint
from bench.identification.tolerances import TOLERANCES
from bench.model.bounds import NODES
from bench.model.geometry import Geometry
from bench.model.model import IdentificationModel
from bench.model.motion import Motion, motion_near
from bench.signals.decimation import fit_band

NODES_IN_STEPS = 2.0  # of a wrong zero, see `EncoderOffset.nodes`, in steps of the derivatives
NOT_SHARED = ("passing", "noted", "sparse")  # fields that are not shared with signals of exact changes


class Nearby:
    """Observation matrices for motions and geometries near those of all recordings, at few samples.

    few: samples of every recording; part: their slice of all (K,). Matrices (K, n, nb + 10 + r) have the base
    parameters' columns, then those of a payload in the tool frame, zero without a tool, and of a unit torque of each
    redundant motor. rows: of effects that need no model, for every recording in a search.
    """

    def __init__(self, model: IdentificationModel, measured: Sequence[Measured]) -> None:
        self.few = tuple(_few_samples(measurement) for measurement in measured)
        ends = np.cumsum([0, *map(len, self.few)])
        self.part = tuple(slice(int(a), int(b)) for a, b in pairwise(ends))
        self._model = model
        every = list(zip(measured, self.few, strict=True))
        self._active = [
            np.concatenate([getattr(measurement, name)[few] for measurement, few in every])
            for name in ("position", "velocity", "acceleration")
        ]
        trees = [measurement.tree.at(few) for measurement, few in every]
        parts = ("time", "q", "v", "a", "jacobian")
        self._tree = Motion(*(np.concatenate([getattr(tree, name) for tree in trees]) for name in parts))
        self._kept = LeastAsked[SmallChange](TOLERANCES.memory.perturbation_bytes)
        self.rows = tuple(KeptRows() for _ in measured)
        self._barred: dict[Hashable, str] = {}
        self._sparse: dict[int, tuple[NearbySignals, RobotSignals]] = {}
        self._seen: tuple[PresentModel, tuple[RobotSignals, ...]] | None = None

    def shifted(self, order: int, motor: int) -> SmallChange:
        """Derivative of the matrix by an active position (order 0), velocity (1) or acceleration (2).

        Raises BenchError where the loops cannot be closed near the motion.
        """
        return self._differences(order, motor)[0]

    def bent(self, motor: int) -> SmallChange:
        """Second derivative of the matrix by an active position. Raises BenchError as `shifted` does."""
        return self._differences(0, motor)[1]

    def _differences(self, order: int, motor: int) -> list[SmallChange]:
        keys = [(order, motor, 1)] if order else [(order, motor, 1), (order, motor, 2)]
        kept = [self._kept.get(key) for key in keys]
        changes = [change for change in kept if change is not None]
        if len(changes) == len(keys):
            return changes
        motors = range(len(self._model.geometry.active)) if self._may_keep_all else [motor]
        steps = [self._step(order, index) for index in motors]
        moves = [
            (index, sign * step) for index, step in zip(motors, steps, strict=True) for sign in (1.0, -1.0)
        ]
        moved = self._moved(order, moves)
        for index, step in zip(motors, steps, strict=True):
            both = next(moved), next(moved)
            out_of_reach = [each for each in both if isinstance(each, BenchError)]
            if out_of_reach:
                if index == motor:
                    raise out_of_reach[0]
                continue
            more, less = map(np.asarray, both)
            differences = [small_change((more - less) / (2.0 * step))]
            if not order:
                differences.append(small_change((more + less - 2.0 * self._base_rows) / step**2))
            for (_, _, degree), change in zip(keys, differences, strict=True):
                self._kept.keep((order, index, degree), change, change.values.nbytes)
            if index == motor:
                changes = differences
        return changes

    @property
    def _may_keep_all(self) -> bool:
        """Whether all shifts fit into half of the memory for changes."""
        samples, n, columns = self._base_rows.shape
        return (
            4 * n * samples * n * columns * np.dtype(KEPT).itemsize < TOLERANCES.memory.perturbation_bytes / 2
        )

    def signals(self, present: PresentModel, seen: Sequence[RobotSignals]) -> tuple[RobotSignals, ...]:
        """The signals of every recording for effects in a search; seen: near the present model."""
        if self._seen is None or self._seen[0] is not present:
            self._seen = present, tuple(self._nearby(present, i, signals) for i, signals in enumerate(seen))
        return self._seen[1]

    def sparsely(self, seen: "NearbySignals") -> RobotSignals:
        """A recording at its coarse samples: the last is kept, as long as its model is used."""
        known = self._sparse.get(seen.index)
        if known is None or known[0] is not seen:
            known = self._sparse[seen.index] = seen, seen.at_coarse_samples()
        return known[1]

    def _nearby(self, present: PresentModel, index: int, seen: RobotSignals) -> RobotSignals:
        given = {
            field.name: getattr(seen, field.name)
            for field in fields(RobotSignals)
            if field.name not in NOT_SHARED
        }
        load = np.zeros(10) if seen.payload is None else present.payloads[seen.payload]
        parameters = np.concatenate((present.base, load))
        few = self.few[index]
        redundant_torque = seen.redundant_torque[few] if seen.redundant else None
        changes = any(changes_torque(instance.effect) for instance, _ in present.effects)
        if changes or any(seen.offsets.values()):  # the torque then needs smooth changes, too
            needed_at = needed_torque(lambda: near, present)
            given["joints"] = {
                name: replace(joint, needs=partial(needed_at, j))
                for j, (name, joint) in enumerate(seen.joints.items())
            }
        near = NearbySignals(
            **given,
            nearby=self,
            index=index,
            parameters=parameters,
            redundant_at_few=redundant_torque,
            knots=seen.time[few],
        )
        return near

    def turned(self, axis: int) -> SmallChange:
        """Change of the matrix by 1 m/s2 more gravity along a world axis."""
        geometry = self._model.geometry
        key = ("gravity", axis)
        change = self._kept.get(key)
        if change is None:
            more = replace(geometry, gravity=geometry.gravity + np.eye(3)[axis])
            change = small_change(machine_rows(self._model, more, self._tree) - self._base_rows)
            self._kept.keep(key, change, change.values.nbytes)
        return change

    def changed(self, geometry: Geometry) -> SmallChange:
        """Change of the matrix by other lengths. Raises BenchError if the loops cannot be closed with them."""
        return self.moved((0.0,) * len(geometry.active), geometry)

    def is_far(self, shift: np.ndarray) -> bool:
        """Whether a shift (3, K, n) is a constant one of positions, too large for derivatives."""
        if shift[1:].any() or np.any(shift[0] != shift[0, 0]):
            return False
        nodes = NODES_IN_STEPS * np.array([self._step(0, motor) for motor in range(shift.shape[2])])
        return bool(np.any(np.abs(shift[0, 0]) > TOLERANCES.shapes.expansion * nodes))

    def moved(self, shift: tuple[float, ...], geometry: Geometry | None = None) -> SmallChange:
        """Change of the matrix by a constant shift (n,) of the active positions, and other lengths. Raises BenchError
        if the loops cannot be closed with them.
        """
        other = self._model.geometry if geometry is None else geometry
        key = geometry_key(other) + np.array(shift).tobytes()
        if key in self._barred:
            raise BenchError(self._barred[key])
        change = self._kept.get(key)
        if change is None:
            try:
                q, v, a = self._active
                tree = motion_in(other, self._model.geometry, self._tree, q, v, a, np.array(shift))
            except BenchError as error:
                self._barred[key] = str(error)
                raise
            change = small_change(machine_rows(self._model, other, tree) - self._base_rows)
            self._kept.keep(key, change, change.values.nbytes)
        return change

    def machine_change(self, index: int, geometry: Geometry, shift: np.ndarray) -> np.ndarray:
        """Change (K, n, nb + 10 + r) of the matrix of a recording by other lengths and a constant shift (n,) of the
        active positions. Raises BenchError as `moved` does.
        """
        part = self.part[index]
        if geometry is not self._model.geometry or self.is_far(
            shift[None, None] * np.eye(3)[0][:, None, None]
        ):
            return self.moved(tuple(shift.tolist()), geometry).rows(part)
        change = np.zeros_like(self._base_rows[part])
        for motor, by in enumerate(shift.tolist()):
            if by:
                slope, bend = self._differences(0, motor)
                change += by * (slope.rows(part) + 0.5 * by * bend.rows(part))
        return change

    @cached_property
    def _base_rows(self) -> np.ndarray:
        return machine_rows(self._model, self._model.geometry, self._tree)

    def _step(self, order: int, motor: int) -> float:
        geometry = self._model.geometry
        if order:
            values = self._active[order][:, motor]
            share = TOLERANCES.motion.rate_share
            return share * float(np.sqrt((values**2).mean())) or share
        slides = {joint.v.start for joint in geometry.joints if joint.kind == "slide"}
        return TOLERANCES.motion.slide if int(geometry.active[motor]) in slides else TOLERANCES.motion.turn

    def _moved(self, order: int, moves: Sequence[tuple[int, float]]) -> Iterator[np.ndarray | BenchError]:
        """The matrix with one active position, velocity or acceleration shifted, for each (motor, step).

        Several are computed together, since much of the cost does not depend on the number of samples.
        """
        most = max(1, NODES.block // len(self._tree.time))
        for at in range(0, len(moves), most):
            some = moves[at : at + most]
            try:
                yield from self._together(order, some)
            except BenchError as error:
                if len(some) == 1:
                    yield error
                else:
                    for pair in some:
                        yield from self._moved(order, [pair])

    def _together(self, order: int, moves: Sequence[tuple[int, float]]) -> list[np.ndarray]:
        count, samples = len(moves), len(self._tree.time)
        moved = [np.tile(values, (count, 1)) for values in self._active]
        for k, (motor, step) in enumerate(moves):
            moved[order][k * samples : (k + 1) * samples, motor] += step
        tree = self._tree.at(np.tile(np.arange(samples), count))
        geometry = self._model.geometry
        return np.split(machine_rows(self._model, geometry, motion_near(geometry, tree, *moved)), count)


@dataclass(frozen=True, kw_only=True)
class NearbySignals(RobotSignals):
    """The signals of a recording for effects in a search: changes of the torque are small and smooth.

    nearby: of all recordings; index: of this one; parameters (nb + 10,): of the present model and of this recording's
    load; redundant_at_few (K, r): torque of redundant motors at the few samples, None without any; knots: their times,
    s.
    """

    expands = True

    nearby: Nearby
    index: int
    parameters: np.ndarray
    redundant_at_few: np.ndarray | None
    knots: np.ndarray

    @property
    def sparsely(self) -> RobotSignals:
        """See `RobotSignals`: at the coarse samples."""
        return self if self.sparse is not None else self.nearby.sparsely(self)

    def forget(self) -> None:
        """As `RobotSignals.forget`, at the coarse samples too."""
        super().forget()
        if self.sparsely is not self:
            self.sparsely.forget()

    def at_coarse_samples(self) -> RobotSignals:
        """The same at the coarse samples; itself if these are all or few."""
        every, length = self.every, len(self.time)
        if every == 1 or length < TOLERANCES.motion.sparse_samples * every:
            return self
        some = slice(None, None, every)
        gaps, shares = sparse_gaps(self.gaps, every, length)

        def torque(changed: Changed = UNCHANGED, every: int = 1) -> np.ndarray:
            return self.torque(changed, every * self.every)

        def joint_reaction(joint: str, every: int) -> JointReaction:
            return self.joint_reaction(joint, every * self.every)

        def in_joints() -> Mapping[str, np.ndarray]:
            return {name: torque[some] for name, torque in self.in_joints().items()}

        return replace(
            self,
            joints={name: sparse_joint(joint, every) for name, joint in self.joints.items()},
            redundant={name: sparse_joint(joint, every) for name, joint in self.redundant.items()},
            moved=lambda: self.tree.at(some),
            carried=lambda: self.payload_torque[some],
            torque=torque,
            joint_reaction=joint_reaction,
            in_joints=in_joints,
            at_links=lambda: self.at_links()[some],
            gaps=gaps,
            lasting=self.nearby.rows[self.index],
            passing=KeptRows(),
            noted={},
            sparse=Sparse(every, length, shares),
        )

    def coarse_change(
        self,
        shift: np.ndarray | None = None,
        *,
        gravity: np.ndarray | None = None,
        geometry: Geometry | None = None,
    ) -> np.ndarray:
        """As `RobotSignals.coarse_change`; a shift comes alone."""
        if shift is None:
            return self._smooth(self._change(gravity, geometry), self.coarse.time)
        if self.nearby.is_far(shift):
            moved = self.nearby.moved(tuple(shift[0, 0].tolist()))
            return self._smooth(self._torque(self._rows(moved)), self.coarse.time)
        change = np.zeros_like(self.coarse.torque)
        for order, motor in zip(*np.nonzero(np.einsum("okn,okn->on", shift, shift)), strict=True):
            values = shift[order, :, motor, None]
            slope, bend = self._slopes(int(order), int(motor))
            change += values * (slope + 0.5 * values * bend)
        return change

    def torque_change(
        self,
        shift: np.ndarray | None = None,
        *,
        gravity: np.ndarray | None = None,
        geometry: Geometry | None = None,
    ) -> np.ndarray:
        """As `RobotSignals.torque_change`; a shift comes alone."""
        if shift is None:
            return self._smooth(self._change(gravity, geometry), self.time)
        return self.refined(self.coarse_change(shift))

    def _change(self, gravity: np.ndarray | None, geometry: Geometry | None) -> np.ndarray:
        """Torque change by another gravity or geometry, at the few samples."""
        if geometry is not None:
            return self._torque(self._rows(self.nearby.changed(geometry)))
        more = np.zeros(3) if gravity is None else gravity - self.geometry.gravity
        nothing = np.zeros((len(self.knots), len(self.joints), len(self.parameters) + len(self.redundant)))
        turned = (by * self._rows(self.nearby.turned(axis)) for axis, by in enumerate(more) if by)
        return self._torque(sum(turned, nothing))

    def _slopes(self, order: int, motor: int) -> tuple[np.ndarray, np.ndarray | float]:
        """First and second derivatives (K, n) of the torque by a shift, at the coarse samples.

        Velocities and accelerations enter in proportion, or nearly so.
        """
        keys = ("slope", order, motor), ("bend", order, motor)
        if keys[0] not in self.noted:
            self.noted[keys[0]] = self._noted(self.nearby.shifted(order, motor))
            if not order:
                self.noted[keys[1]] = self._noted(self.nearby.bent(motor))
        return self.noted[keys[0]], self.noted.get(keys[1], 0.0)

    def _noted(self, change: SmallChange) -> np.ndarray:
        return self._smooth(self._torque(self._rows(change)), self.coarse.time)

    def _rows(self, change: SmallChange) -> np.ndarray:
        """The part for this recording in a change of all rows, at the few samples."""
        return change.rows(self.nearby.part[self.index])

    def _torque(self, rows: np.ndarray) -> np.ndarray:
        """Torque (K, n) of rows of this recording."""
        return combined_torque(rows, self.parameters, self.redundant_at_few)

    def _smooth(self, values: np.ndarray, time: np.ndarray) -> np.ndarray:
        if len(self.knots) == len(time):
            return values
        return cubic_spline(self.knots, values)(time)


def _few_samples(measured: Measured) -> np.ndarray:
    """Samples of a recording between which its motion is smooth, with the first and last.

    The effect of noise on a small change is far smaller than the change and is neglected.
    """
    rate, samples = measured.recording.rate, len(measured.time)
    band = fit_band(rate, measured.settings.decimation)
    coarse = max(1, int(rate / (OVERSAMPLING * band)))
    velocity = measured.velocity[::coarse]
    bounds = TOLERANCES.motion
    highest = max(motion_band(entry, coarse / rate, band, bounds.band_power) for entry in velocity.T)
    step = coarse * max(1, int(rate / (bounds.samples_in_period * highest) / coarse))
    return np.unique(np.append(np.arange(0, samples, step), samples - 1))
