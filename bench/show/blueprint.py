"""What the viewer shows when a recording is opened: one tab for each of the dataset's recordings."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import rerun.blueprint as rrb
from rerun.components import Plane3D

SUMMARY, PARAMETERS = "/summary", "/parameters"
MOTORS_IN_COLUMN = 3
BACKGROUND = (16, 20, 27)
GRID = (120, 140, 165, 45)
FIT = 0.9  # distance of the eye, in diagonals of the box that the robot stays in


@dataclass(frozen=True)
class Scene:
    """How one recording of the dataset appears.

    title names its tab; root is the entity below which all of it lies; errors are those of the motors, as
    text; eye and target (3,) m place the camera, low (m) the ground.
    """

    title: str
    root: str
    errors: tuple[str, ...]
    eye: np.ndarray
    target: np.ndarray
    low: float


@dataclass(frozen=True)
class Motor:
    """A driven joint: its name, its part of an entity path, the units of its current and its position."""

    name: str
    entity: str
    current_unit: str
    position_unit: str


def blueprint(scenes: Sequence[Scene], motors: Sequence[Motor]) -> rrb.Blueprint:
    """The views of all recordings, the first one in front."""
    return rrb.Blueprint(
        rrb.Tabs(*(_tab(scene, motors) for scene in scenes), active_tab=0),
        rrb.BlueprintPanel(state="collapsed"),
        rrb.SelectionPanel(state="collapsed"),
        rrb.TimePanel(state="collapsed", timeline="time", play_state="playing", loop_mode="all"),
        auto_views=False,
        auto_layout=False,
    )


def eye_of(
    low: np.ndarray, high: np.ndarray, azimuth: float, elevation: float
) -> tuple[np.ndarray, np.ndarray]:
    """Eye and target (3,) m so that the box low..high (3,) fills the view; degrees, as in MuJoCo."""
    target = (low + high) / 2.0
    turn, rise = np.radians(azimuth), np.radians(elevation)
    ahead = np.array([np.cos(rise) * np.cos(turn), np.cos(rise) * np.sin(turn), np.sin(rise)])
    return target - FIT * float(np.linalg.norm(high - low)) * ahead, target


def _tab(scene: Scene, motors: Sequence[Motor]) -> rrb.Container:
    pairs = list(zip(motors, scene.errors, strict=True))
    columns = [pairs[i : i + MOTORS_IN_COLUMN] for i in range(0, len(pairs), MOTORS_IN_COLUMN)]
    plots = [_plots(scene, column) for column in columns]
    return rrb.Horizontal(
        rrb.Vertical(_robot(scene), _texts(scene, motors), row_shares=[3, 2]),
        *plots,
        column_shares=[4.0] + [5.0 / len(plots) ** 0.5] * len(plots),
        name=scene.title,
    )


def _robot(scene: Scene) -> rrb.View:
    return rrb.Spatial3DView(
        origin=f"{scene.root}/robot",
        name="robot",
        background=BACKGROUND,
        line_grid=rrb.LineGrid3D(
            visible=True, plane=Plane3D((0.0, 0.0, 1.0), scene.low), spacing=0.1, stroke_width=0.7, color=GRID
        ),
        eye_controls=rrb.EyeControls3D(
            position=scene.eye, look_target=scene.target, eye_up=(0.0, 0.0, 1.0), kind=rrb.Eye3DKind.Orbital
        ),
    )


def _texts(scene: Scene, motors: Sequence[Motor]) -> rrb.Container:
    units = sorted({motor.position_unit for motor in motors})
    return rrb.Tabs(
        rrb.TextDocumentView(origin=SUMMARY, name="summary"),
        rrb.TextDocumentView(origin=PARAMETERS, name="parameters"),
        rrb.TimeSeriesView(
            origin=f"{scene.root}/position", name=f"positions [{', '.join(units)}]", plot_legend=_legend()
        ),
        active_tab=0,
    )


def _plots(scene: Scene, motors: Sequence[tuple[Motor, str]]) -> rrb.Container:
    views: list[rrb.View] = []
    for place, (motor, error) in enumerate(motors):
        unit = motor.current_unit
        views.append(
            rrb.TimeSeriesView(
                origin=f"{scene.root}/current/{motor.entity}",
                name=f"{motor.name}: current [{unit}]",
                plot_legend=_legend() if place == 0 else rrb.PlotLegend(visible=False),
            )
        )
        views.append(
            rrb.TimeSeriesView(
                origin=f"{scene.root}/error/{motor.entity}",
                name=f"{motor.name}: error [{unit}], {error} of the current",
                plot_legend=rrb.PlotLegend(visible=False),
            )
        )
    return rrb.Vertical(*views, row_shares=[3, 2] * len(motors))


def _legend() -> rrb.PlotLegend:
    return rrb.PlotLegend(corner=rrb.Corner2D.RightTop)
