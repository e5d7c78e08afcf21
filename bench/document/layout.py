"""Sizes of figures and tables, and how much they name."""

from dataclasses import dataclass


@dataclass(frozen=True)
class ScreenLayout:
    """Figures for the screen; inches, unless stated."""

    width: float = 11.0  # text of 10 points can be read where a page is shown as wide as a column of text
    motor: float = 1.75  # height of the axes of a motor
    label_at: float = -0.178  # place of a label, as a share of the axes' width
    recordings: int = 2  # next to each other
    letters: int = 17  # of a name next to a bar
    logarithmic: float = 5.0  # times its even part: with larger values an axis is logarithmic beyond
    points: int = 1200  # behind the means of one direction, and distant points; all rows count in the means
    distant: float = 3.0  # standard deviations of its bin, above which a row is always drawn
    reach: float = 1.6  # times what most errors are: axes end there
    percentile: float = 99.5  # of the errors: most of them
    decades: float = 300.0  # ratio of largest to smallest value, above which powers of ten are ticks enough
    bar: float = 0.36  # share of the room of a category, where two bars are next to each other
    bins: int = 24  # of a chart of errors over a variable
    histogram_bins: int = 41  # of the errors
    histogram: float = 5.0  # standard deviations of the noise that it covers, at least


@dataclass(frozen=True)
class PaperLayout:
    """Figures for publications; mm, unless stated."""

    inch: float = 25.4  # for sizes that matplotlib takes in inches
    dpi: int = 300  # of a picture
    panels: int = 3  # next to each other on two columns
    legend: float = 6.0  # height
    legend_letters: int = 50  # in one column next to the marks
    scale: float = 0.55  # of lines and marks, relative to a picture for the screen
    foot: float = 18.0  # of an axis with its label
    bar: float = 3.8  # for each bar
    parameter: float = 4.2  # for each parameter
    gain: float = 5.6  # for each gain with its nominal value
    errors: float = 26.0  # height of the errors of a motor
    ranking: int = 14  # effects of the ranking


@dataclass(frozen=True)
class TextLayout:
    """Tables in a terminal, and what a cell names; columns, unless stated."""

    alternatives: int = 4  # named in a cell
    certain: float = 0.95  # probability, above which a place is named without it
    probability: float = 0.01  # distance from 0 or 1, below which no digits are shown
    zero: float = 1e-6  # of an evidence in nats, of a share: a smaller one is rounding
    moved: int = 6  # parameters that are named
    unsupported: int = 4  # effects that the data do not support, shown with those that they do
    parameters: int = 12  # of those that change most
    exact: float = 1e-9  # m or rad: a larger gap is coloured
    gaps: tuple[int, ...] = (2, 1)  # between columns: the wider where there is room
    width: int = 100  # of a table by itself
    terms: int = 14  # below which a grouping says nothing
    bar: int = 30  # the longest
    least_bar: int = 8  # the shortest that is drawn


SCREEN = ScreenLayout()
PAPER = PaperLayout()
TEXT = TextLayout()
