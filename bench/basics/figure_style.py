"""The style of all matplotlib figures."""

from typing import Any

DPI = 120
# Any: matplotlib's type lists every key by name.
STYLE: Any = {
    "font.size": 10.0,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": "#E6E9ED",
    "grid.linewidth": 0.6,
    "axes.edgecolor": "#8A929C",
    "axes.labelcolor": "#3A424C",
    "xtick.color": "#4A525C",
    "ytick.color": "#4A525C",
    "axes.titlesize": 10.5,
    "axes.titlelocation": "left",
}
