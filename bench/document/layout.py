"""Sizes of figures and tables, and numbers of items in them."""

from dataclasses import dataclass


@dataclass(frozen=True)
class ScreenLayout:
    """Figures for the screen; inches, unless stated."""

    width: float = 11.0  # 10-point text stays legible in a figure shown as wide as a column of text
    motor: float = 1.75  # height of the axes of a motor
    label_at: float = -0.178  # position of a label, as a share of the axes' width
    recordings: int = 2  # side by side
    letters: int = 17  # of a name next to a bar
    logarithmic: float = 5.0  # times its linear part: with larger values an axis is logarithmic beyond it
    points: int = 1200  # drawn behind the means of one direction, plus distant ones; means are over all rows
    distant: float = 3.0  # standard deviations of its bin, above which a row is always drawn
    reach: float = 1.6  # times `percentile` of the errors: the end of an axis, unless all errors are smaller
    percentile: float = 99.5  # of the errors, for `reach`
    decades: float = 300.0  # ratio of largest to smallest value, above which only powers of ten have ticks
    bar: float = 0.36  # share of the height of a category, with two bars for each
    bins: int = 24  # of a chart of errors over a variable
    histogram_bins: int = 41  # of the errors
    histogram: float = 5.0  # standard deviations of the noise that it covers, at least


@dataclass(frozen=True)
class PaperLayout:
    """Figures for publications; mm, unless stated."""

    inch: float = 25.4  # for sizes that matplotlib takes in inches
    dpi: int = 300  # of a PNG
    panels: int = 3  # side by side on two columns
    legend: float = 6.0  # height
    legend_letters: int = 50  # in one row of the legend at one column's width
    scale: float = 0.55  # of lines and markers, relative to a figure for the screen
    foot: float = 18.0  # height of an axis with its label
    bar: float = 3.8  # height for each bar
    parameter: float = 4.2  # height for each parameter
    gain: float = 5.6  # height for each gain with its nominal value
    errors: float = 26.0  # height of the errors of a motor
    ranking: int = 14  # effects of the ranking


@dataclass(frozen=True)
class TextLayout:
    """Tables in a terminal, and the contents of cells; terminal columns, unless stated."""

    alternatives: int = 4  # listed in a cell
    certain: float = 0.95  # probability, from which a place is listed without its probability
    zero: float = 1e-6  # evidence in nats, or a share: a smaller one is rounding
    moved: int = 6  # parameters that are listed
    unsupported: int = 4  # effects that the data do not support, shown with the supported ones
    parameters: int = 12  # shown, those that change most
    exact: float = 1e-9  # m or rad: a larger gap is coloured
    gaps: tuple[int, ...] = (2, 1)  # between columns: the wider one if it fits
    width: int = 100  # default, of a table
    terms: int = 14  # below which a grouping is omitted
    bar: int = 30  # the longest
    least_bar: int = 8  # the shortest room for bars


SCREEN = ScreenLayout()
PAPER = PaperLayout()
TEXT = TextLayout()
