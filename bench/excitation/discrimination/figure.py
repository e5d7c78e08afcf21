"""The motion that separates two effects, and where along it the two models differ."""

from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from bench.basics.errors import BenchError
from bench.basics.figure_style import DPI, STYLE
from bench.basics.files.atomic import atomic_path
from bench.basics.joint_units import units_of_gain
from bench.effects.display_names import spoken
from bench.excitation.bounds import DISCRIMINATION
from bench.excitation.discrimination.files import trajectory_table
from bench.excitation.discrimination.result import Discrimination

COLOURS = ("#0072B2", "#D55E00")  # after Okabe and Ito
MOVING = "#3A424C"
BAND = "#9AA0A6"


def discrimination_figure(result: Discrimination) -> Figure:
    """A row per motor: position, speed, and what the other model cannot imitate, in noise deviations."""
    if result.motion is None:
        raise BenchError("there is no motion to draw")
    joints = list(result.joints)
    table = trajectory_table(result.motion.trajectory, joints, DISCRIMINATION.rate)
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(11.5, 2.1 * len(joints) + 1.0), dpi=DPI, layout="constrained")
        axes = figure.subplots(len(joints), 3, sharex=True, squeeze=False)
        for j, (joint, unit) in enumerate(result.joints.items()):
            length = units_of_gain(unit).position
            recorded = result.recorded[joint]
            for column, (kind, low, high) in enumerate(
                (("position", recorded.low, recorded.high), ("velocity", -recorded.speed, recorded.speed))
            ):
                panel = axes[j, column]
                panel.axhspan(
                    low,
                    high,
                    color=BAND,
                    alpha=0.2,
                    linewidth=0.0,
                    label="recorded so far; at the right: the noise",
                )
                panel.plot(table["time"], table[f"{kind}.{joint}"], color=MOVING, linewidth=1.1)
                panel.set_ylabel(f"{joint} [{length}{'/s' if column else ''}]")
            axes[j, 2].set_ylabel(f"{joint}, current [σ of noise]")
            axes[j, 2].axhspan(-1.0, 1.0, color=BAND, alpha=0.2, linewidth=0.0)
            for asked, answer, colour in zip(result.questions, result.motion.answers, COLOURS, strict=False):
                name = spoken(asked.truth.request.replace(":", " at "))
                axes[j, 2].plot(
                    answer.time,
                    np.where(
                        answer.residual[:, j] == 0.0, np.nan, answer.residual[:, j]
                    ),  # no row at standstill
                    color=colour,
                    linewidth=1.0,
                    label=f"if {name} is the truth",
                )
        for column, title in enumerate(("Position", "Velocity", "What the wrong model lacks")):
            axes[0, column].set_title(title)
            axes[-1, column].set_xlabel("time [s]")
            axes[-1, column].xaxis.set_major_locator(MaxNLocator(6, steps=[1, 2, 5, 10]))
        figure.align_ylabels()
        handles = [axes[0, 0].patches[0], *axes[0, 2].get_lines()]
        figure.legend(handles=handles, loc="outside upper center", ncols=4, frameon=False)
    return figure


def write_discrimination_figure(path: Path, result: Discrimination) -> None:
    """Write `discrimination_figure` as a picture, whole or not at all."""
    figure = discrimination_figure(result)
    with atomic_path(path) as partial:
        figure.savefig(partial)
