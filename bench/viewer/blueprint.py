"""The viewer's layout: one tab for each recording of the dataset."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import rerun.blueprint as rrb
from rerun.components import Plane3D

from bench.viewer.content import Motor, ShownContent

SUMMARY, PARAMETERS = "/summary", "/parameters"
FOLLOWING, OPENING = "tool: actual path to reference path [mm]", "largest opening of a loop [µm]"
SMALLER = (FOLLOWING, OPENING)
MOTORS_IN_COLUMN = 2
MOST_LANES = 4  # of the state timeline that are visible at once
BACKGROUND = (16, 20, 27)
GRID = (120, 140, 165, 45)
FIT = 0.9  # distance of the eye, in diagonals of the box around the robot's motion


@dataclass(frozen=True)
class Scene:
    """How one recording of the dataset is shown.

    title: of its tab; errors: of the motors, as text; path: key to the colours and outlines; eye, target (3,) m:
    camera; low: height of the ground, m; texts: the entity above those of the summary and the parameters.
    """

    title: str
    content: ShownContent
    errors: tuple[str, ...]
    path: str
    eye: np.ndarray
    target: np.ndarray
    low: float
    texts: str = ""

    @property
    def root(self) -> str:
        """The entity above all data of the recording."""
        return self.content.root


def blueprint(scenes: Sequence[Scene], motors: Sequence[Motor]) -> rrb.Blueprint:
    """A tab for each recording, the first one open."""
    return _framed(rrb.Tabs(*(_tab(scene, motors) for scene in scenes), active_tab=0))


def side_by_side(
    groups: Sequence[tuple[str, Sequence[Scene]]], motors: Sequence[Motor], reach: np.ndarray
) -> rrb.Blueprint:
    """A tab for each group, its scenes side by side: robot above, errors below, then the text.

    reach (n,): the axes of each motor's errors extend from -reach to reach, drive units.
    """
    tabs = [
        rrb.Horizontal(
            *(_tabs(scene, motors, reach, first=not k) for k, scene in enumerate(scenes)), name=name
        )
        for name, scenes in groups
    ]
    return _framed(rrb.Tabs(*tabs, active_tab=0))


def eye_of(
    low: np.ndarray, high: np.ndarray, azimuth: float, elevation: float
) -> tuple[np.ndarray, np.ndarray]:
    """Eye and target (3,), m, for which the box low..high (3,) fills the view; angles in degrees, as in MuJoCo."""
    target = (low + high) / 2.0
    turn, rise = np.radians(azimuth), np.radians(elevation)
    ahead = np.array([np.cos(rise) * np.cos(turn), np.cos(rise) * np.sin(turn), np.sin(rise)])
    return target - FIT * float(np.linalg.norm(high - low)) * ahead, target


def _framed(views: rrb.Container) -> rrb.Blueprint:
    return rrb.Blueprint(
        views,
        rrb.BlueprintPanel(state="collapsed"),
        rrb.SelectionPanel(state="collapsed"),
        rrb.TimePanel(state="collapsed", timeline="time", play_state="playing", loop_mode="all"),
        auto_views=False,
        auto_layout=False,
    )


def _tab(scene: Scene, motors: Sequence[Motor]) -> rrb.Container:
    columns = -(-len(motors) // MOTORS_IN_COLUMN)
    lanes = min(len(motors) + 2, MOST_LANES)
    return rrb.Horizontal(
        rrb.Vertical(_robot(scene), _texts(scene), row_shares=[3, 2]),
        rrb.Vertical(
            rrb.Tabs(*_pages(scene, motors), active_tab=0),
            rrb.StateTimelineView(origin=f"{scene.root}/phases", name="phases"),
            row_shares=[20, 2.0 + 1.4 * lanes],
        ),
        column_shares=[4.0, 5.0 * columns**0.5],
        name=scene.title,
    )


def _pages(scene: Scene, motors: Sequence[Motor]) -> list[rrb.Container]:
    """The tabs next to the robot; the first one is open."""
    pages = []
    step, torque = "error after each added effect", "torque of effects"
    if scene.content.steps:
        views = [
            [_of_motor(scene, motor, "steps", f"{step} [{motor.current_unit}]", legend=not k)]
            for k, motor in enumerate(motors)
        ]
        pages.append(_in_columns(views, [1.0], step))
    views = [
        [
            _of_motor(scene, motor, "current", f"current [{motor.current_unit}]", legend=not k),
            _error(scene, motor, error),
        ]
        for k, (motor, error) in enumerate(zip(motors, scene.errors, strict=True))
    ]
    pages.append(_in_columns(views, [3.0, 2.0], "currents and errors"))
    if scene.content.has_torques:
        views = [
            [_of_motor(scene, motor, "torque", f"{torque} [{motor.effort_unit}]", legend=True)]
            for motor in motors
        ]
        pages.append(_in_columns(views, [1.0], torque))
    return [*pages, _tool(scene, motors)]


def _tabs(scene: Scene, motors: Sequence[Motor], reach: np.ndarray, *, first: bool) -> rrb.Container:
    errors = [
        _error(scene, motor, error, legend=first and not k, reach=float(reach[k]))
        for k, (motor, error) in enumerate(zip(motors, scene.errors, strict=True))
    ]
    return rrb.Vertical(
        _robot(replace(scene, path="")),
        *errors,
        rrb.TextDocumentView(origin=f"{scene.texts}{SUMMARY}", name="summary"),
        row_shares=[4.0, *[5.0 / len(errors)] * len(errors), 3.0],
        name=scene.title,
    )


def _error(
    scene: Scene, motor: Motor, error: str, *, legend: bool = False, reach: float | None = None
) -> rrb.View:
    name = f"error [{motor.current_unit}], {error} of the current"
    return _of_motor(scene, motor, "error", name, legend=legend, reach=reach)


def _robot(scene: Scene) -> rrb.View:
    return rrb.Spatial3DView(
        origin=f"{scene.root}/robot",
        name=f"{scene.title} · {scene.path}" if scene.path else scene.title,
        background=BACKGROUND,
        line_grid=rrb.LineGrid3D(
            visible=True, plane=Plane3D((0.0, 0.0, 1.0), scene.low), spacing=0.1, stroke_width=0.7, color=GRID
        ),
        eye_controls=rrb.EyeControls3D(
            position=scene.eye, look_target=scene.target, eye_up=(0.0, 0.0, 1.0), kind=rrb.Eye3DKind.Orbital
        ),
    )


def _texts(scene: Scene) -> rrb.Container:
    return rrb.Tabs(
        rrb.TextDocumentView(origin=f"{scene.texts}{SUMMARY}", name="summary"),
        rrb.TextDocumentView(origin=f"{scene.texts}{PARAMETERS}", name="parameters"),
        active_tab=0,
    )


def _of_motor(
    scene: Scene, motor: Motor, kind: str, name: str, *, legend: bool, reach: float | None = None
) -> rrb.View:
    """The plot of one motor's data below the entity `kind`."""
    return _plot(f"{scene.root}/{kind}/{motor.entity}", f"{motor.name}: {name}", legend=legend, reach=reach)


def _tool(scene: Scene, motors: Sequence[Motor]) -> rrb.Container:
    views: list[rrb.View] = []
    if scene.content.motion.tool_position is not None:
        views.append(_plot(f"{scene.root}/tool", "tool: actual path and reference [m]", legend=True))
    if scene.content.reference_path is not None:
        views.append(_plot(f"{scene.root}/following", FOLLOWING, legend=False))
    units = ", ".join(sorted({motor.position_unit for motor in motors}))
    views.append(
        rrb.TimeSeriesView(
            origin=scene.root,
            contents=[f"{scene.root}/position/**", f"{scene.root}/reference/**"],
            name=f"positions [{units}]",
            plot_legend=_legend(),
        )
    )
    if scene.content.motion.loop_gap.size:
        views.append(_plot(f"{scene.root}/loop_gap", OPENING, legend=True))
    shares = [2.0 if view.name in SMALLER else 3.0 for view in views]
    return rrb.Vertical(*views, row_shares=shares, name="tool, positions, loops")


def _in_columns(views: Sequence[Sequence[rrb.View]], shares: Sequence[float], name: str) -> rrb.Container:
    """The views of each motor one below another, at most `MOTORS_IN_COLUMN` motors in a column."""
    groups = [views[i : i + MOTORS_IN_COLUMN] for i in range(0, len(views), MOTORS_IN_COLUMN)]
    columns = [
        rrb.Vertical(
            *(view for column in group for view in column),
            row_shares=[*shares] * len(group),
            name=name if len(groups) == 1 else None,
        )
        for group in groups
    ]
    return columns[0] if len(columns) == 1 else rrb.Horizontal(*columns, name=name)


def _plot(origin: str, name: str, *, legend: bool, reach: float | None = None) -> rrb.View:
    shown = _legend() if legend else rrb.PlotLegend(visible=False)
    axis = None if reach is None else rrb.ScalarAxis(range=(-reach, reach))
    return rrb.TimeSeriesView(origin=origin, name=name, plot_legend=shown, axis_y=axis)


def _legend() -> rrb.PlotLegend:
    return rrb.PlotLegend(corner=rrb.Corner2D.RightTop)
