"""The planned motions: positions, speeds and expected currents of every motor, with their limits."""

from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from bench.basics.figure_style import DPI, STYLE
from bench.basics.joint_units import drive_unit, units_of_gain
from bench.excitation.experiment.nominal import seen
from bench.excitation.experiment.plan import ExperimentPlan

COLOURS = ("#0072B2", "#D55E00", "#009E73")  # after Okabe and Ito
LIMIT = "#9AA0A6"


def plan_figure(plan: ExperimentPlan) -> Figure:
    """A row per motor: position, speed, current; dashed: limits."""
    robot, room = plan.robot, plan.room
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(11.5, 1.9 * len(robot.joints) + 1.0), dpi=DPI, layout="constrained")
        axes = figure.subplots(len(robot.joints), 3, sharex=True, squeeze=False)
        for name, load, trial, colour in zip(
            plan.names, plan.search.loads, plan.motions, COLOURS, strict=False
        ):
            time = plan.search.shape.times
            position, velocity, _ = trial.trajectory.evaluate(time)
            current = seen(plan.nominal, trial.motion, load).current
            for j in range(len(robot.joints)):
                for column, values in enumerate((position, velocity, current)):
                    axes[j, column].plot(time, values[:, j], color=colour, linewidth=1.1, label=name)
        for j, actuator in enumerate(robot.actuators):
            length = units_of_gain(actuator.gain_unit).position
            drive = drive_unit(actuator.gain_unit) or "N·m"
            _limits(axes[j, 0], (room.joint.low[j], room.joint.high[j]))
            _limits(axes[j, 1], (-room.velocity[j], room.velocity[j]))
            largest = room.torque[j] / plan.nominal.gains[j]
            _limits(axes[j, 2], (-largest, largest))
            for column, unit in enumerate((length, f"{length}/s", drive)):
                axes[j, column].set_ylabel(f"{actuator.joint} [{unit}]")
        for column, title in enumerate(("Position", "Velocity", "Current, expected")):
            axes[0, column].set_title(title)
            axes[-1, column].set_xlabel("time [s]")
        figure.align_ylabels()
        dashed = f"limits ({'ranges ' if room.unranged else ''}assumed)" if room.assumed else "limits"
        limit = Line2D([], [], color=LIMIT, linewidth=0.9, linestyle="--", label=dashed)
        handles = [*axes[0, 0].get_lines()[: len(plan.names)], limit]
        figure.legend(handles=handles, loc="outside upper center", ncols=len(handles), frameon=False)
    return figure


def _limits(axes: Axes, values: tuple[float, float]) -> None:
    for value in values:
        if np.isfinite(value):
            axes.axhline(value, color=LIMIT, linewidth=0.9, linestyle="--")


def write_plan_figure(path: Path, plan: ExperimentPlan) -> None:
    """Write `plan_figure` as a picture into a folder that `write_plan` completes."""
    plan_figure(plan).savefig(path)
