"""Colours, one for each meaning: distinguishable for colour-blind people, on white and on the viewer's dark background.

The hues are those of Okabe and Ito (2008), lighter for a dark background.
"""

from typing import NamedTuple

import numpy as np


class Palette(NamedTuple):
    """Colours as #rrggbb."""

    measured: str
    modelled: str
    error: str
    band: str
    logged: str


ON_WHITE = Palette(measured="#0072B2", modelled="#C44E00", error="#A0306E", band="#D9A5C4", logged="#BFD7E6")
ON_DARK = Palette(measured="#56B4E9", modelled="#FFB000", error="#E78AC3", band="#F4C6E1", logged="#3C5A70")


LADDER_ON_DARK = ("#F28C5A", "#E6D55A", "#7CC7A1", "#B7A3F0")
"""Errors of the models before the one that is shown, the first one first."""

FORWARDS_ON_DARK, BACKWARDS_ON_DARK, REVERSAL_ON_DARK, STILL_ON_DARK = (
    "#2C6FA3",
    "#A85A1C",
    "#E9DB4A",
    "#4B525C",
)
"""States of a joint's motion; text on them is white, but dark on the light one."""

SMALL_TO_LARGE = ("#5B4B9E", "#A9509E", "#E0666F", "#F7A64A", "#FBE96A")
"""A scale from small to large, with visible steps of lightness; even the smallest is visible on the background."""


def scale_colours(share: np.ndarray) -> np.ndarray:
    """Colours (N, 3), 0 to 255, of shares (N,) between 0 and 1 on `SMALL_TO_LARGE`; grey for NaN."""
    stops = np.array([rgb(colour) for colour in SMALL_TO_LARGE], dtype=float)
    at = np.clip(np.nan_to_num(share), 0.0, 1.0) * (len(stops) - 1)
    colours = np.stack([np.interp(at, np.arange(len(stops)), stops[:, k]) for k in range(3)], axis=1)
    colours[np.isnan(share)] = rgb(STILL_ON_DARK)
    return np.asarray(np.rint(colours), dtype=np.uint8)


def rgb(colour: str) -> tuple[int, int, int]:
    """Red, green and blue, 0 to 255, of "#rrggbb"."""
    return int(colour[1:3], 16), int(colour[3:5], 16), int(colour[5:7], 16)
