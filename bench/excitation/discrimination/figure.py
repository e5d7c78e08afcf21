"""The motion that separates two effects, and where along it the two models differ."""

from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from bench.basics.errors import BenchError
from bench.basics.figure_style import DPI, STYLE
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
            bands = ((recorded.low, recorded.high), (-recorded.speed, recorded.speed), (-1.0, 1.0))
            names = (f"{joint} [{length}]", f"{joint} [{length}/s]", f"{joint}, current [σ of noise]")
            for panel, band, name in zip(axes[j], bands, names, strict=True):
                panel.axhspan(*band, color=BAND, alpha=0.2, linewidth=0.0)
                panel.set_ylabel(name)
            for panel, kind in zip(axes[j], ("position", "velocity"), strict=False):
                panel.plot(table["time"], table[f"{kind}.{joint}"], color=MOVING, linewidth=1.1)
            for asked, answer, colour in zip(result.questions, result.motion.answers, COLOURS, strict=False):
                residual = answer.residual[:, j]
                known = np.where(residual == 0.0, np.nan, residual)  # no row at standstill
                label = f"if {spoken(asked.truth.request.replace(':', ' at '))} is the truth"
                axes[j, 2].plot(answer.time, known, color=colour, linewidth=1.0, label=label)
        for column, title in enumerate(("Position", "Velocity", "What the wrong model lacks")):
            axes[0, column].set_title(title)
            axes[-1, column].set_xlabel("time [s]")
            axes[-1, column].xaxis.set_major_locator(MaxNLocator(6, steps=[1, 2, 5, 10]))
        figure.align_ylabels()
        axes[0, 0].patches[0].set_label("recorded so far; at the right: the noise")
        handles = [axes[0, 0].patches[0], *axes[0, 2].get_lines()]
        figure.legend(handles=handles, loc="outside upper center", ncols=4, frameon=False)
    return figure


def write_discrimination_figure(path: Path, result: Discrimination) -> None:
    """Write `discrimination_figure` as a picture into a folder that `write_discrimination` completes."""
    discrimination_figure(result).savefig(path)
