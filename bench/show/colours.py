"""One meaning, one colour: told apart by colour-blind eyes, on white paper and on the viewer's dark ground.

The hues are those of Okabe and Ito (2008), lightened where the ground is dark.
"""

from typing import NamedTuple


class Palette(NamedTuple):
    """Colours as #rrggbb."""

    measured: str
    modelled: str
    error: str
    band: str
    logged: str


ON_WHITE = Palette(measured="#0072B2", modelled="#C44E00", error="#A0306E", band="#D9A5C4", logged="#BFD7E6")
ON_DARK = Palette(measured="#56B4E9", modelled="#FFB000", error="#E78AC3", band="#F4C6E1", logged="#3C5A70")


def rgb(colour: str) -> tuple[int, int, int]:
    """Red, green and blue, 0 to 255, of "#rrggbb"."""
    return int(colour[1:3], 16), int(colour[3:5], 16), int(colour[5:7], 16)
