"""Growth of the cost of identify and diagnose with samples, motors, and the size of the catalogue.

Processor time in one run, the exponent of a power law for each series; a figure and the numbers are in results/speed.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from time import process_time

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure as Drawing
from matplotlib.ticker import LogLocator

from bench.basics.figure_style import STYLE
from bench.basics.files.atomic import write_json_atomically
from bench.basics.versions import versions
from bench.benchmarks.speed.figures import SpeedFigure
from bench.benchmarks.speed.long_log import write_long_dataset
from bench.dataset.dataset import Dataset, load_dataset
from bench.diagnosis.with_catalogue import diagnose_with_catalogue
from bench.document.figures.write import write_figure
from bench.effects import CATALOGUE
from bench.identification.identify import identify
from bench.identification.prepare import prepare
from bench.identification.problem import Problem, problem_of

RESULT = Path("results/speed/growth.json")
PICTURE = Path("results/speed/growth.png")
SAMPLES = (10_000, 20_000, 40_000, 80_000, 160_000)
SAME = 20_000  # samples if something else grows
RATE = 1000.0  # Hz
ROBOT = "five_bar"
ROBOTS = {1: "emps", 2: "five_bar", 3: "three_rrr", 6: "stewart"}
"""By number of motors."""
EFFECTS = (4, 8, 16, len(CATALOGUE))
FILTERS = {"decimation": 20, "position_cutoff": 100.0, "border": (60, 60)}  # the same for all
REPEATS = 3  # of quick calculations; the shortest counts
QUICK = 2.0  # s
LINEAR = 1.1  # largest exponent in samples

Work = Callable[[Dataset], object]
WORKS: Mapping[str, Work] = {
    "identify": lambda dataset: identify(prepare(problem_of(dataset, filters=FILTERS))),
    "diagnose": lambda dataset: diagnose_with_catalogue(problem_of(dataset, filters=FILTERS)),
}


@dataclass(frozen=True)
class Growth:
    """Processor time, s, of one command against a size. of: what the size counts."""

    command: str
    of: str
    sizes: tuple[int, ...]
    seconds: tuple[float, ...]

    @property
    def exponent(self) -> float:
        """The exponent of the power law of time over size, fitted to logarithms."""
        return float(np.polyfit(np.log(self.sizes), np.log(self.seconds), 1)[0])


def measure() -> Iterator[Growth]:
    """Measure all series, in order."""
    with TemporaryDirectory() as name:
        folder = Path(name)

        def dataset(robot: str, samples: int) -> Dataset:
            place = folder / f"{robot}_{samples}"
            if not place.exists():
                write_long_dataset(place, samples / RATE / 2, robot)
            return load_dataset(place)

        for command, work in WORKS.items():
            work(dataset(ROBOT, SAMPLES[0]))  # warm-up: caches of the robot and the program
            seconds = tuple(_seconds(dataset(ROBOT, size), work) for size in SAMPLES)
            yield Growth(command, "samples", SAMPLES, seconds)
            seconds = tuple(_seconds(dataset(robot, SAME), work) for robot in ROBOTS.values())
            yield Growth(command, "motors", tuple(ROBOTS), seconds)
        seconds = tuple(_seconds(dataset(ROBOT, SAME), _diagnose_among(size)) for size in EFFECTS)
        yield Growth("diagnose", "effects in the catalogue", EFFECTS, seconds)


def _diagnose_among(size: int) -> Work:
    """A diagnosis with the first `size` effects of the catalogue."""
    part = dict(list(CATALOGUE.items())[:size])
    return lambda dataset: diagnose_with_catalogue(Problem(dataset, part, filters=FILTERS))


def _seconds(dataset: Dataset, work: Work) -> float:
    """Processor seconds; the shortest of `REPEATS` unless one takes longer than `QUICK`."""
    least = np.inf
    for _ in range(REPEATS):
        start = process_time()
        work(dataset)
        least = min(least, process_time() - start)
        if least > QUICK:
            break
    return float(least)


def growth_figure(series: Sequence[Growth]) -> Drawing:
    """Processor time against size, one panel for each kind of size, with the exponents."""
    things = list(dict.fromkeys(growth.of for growth in series))
    with mpl.rc_context(STYLE):
        drawing = Drawing(figsize=(4.0 * len(things), 3.2), layout="constrained")
        for axes, thing in zip(drawing.subplots(1, len(things), squeeze=False)[0], things, strict=True):
            shown = [growth for growth in series if growth.of == thing]
            for growth in shown:
                label = f"{growth.command}: {growth.exponent:.2f}"
                color = f"C{list(WORKS).index(growth.command)}"
                axes.loglog(growth.sizes, growth.seconds, "o-", color=color, label=label)
            sizes = shown[0].sizes
            axes.set_xticks(sizes, labels=[f"{size:,}".replace(",", "\u202f") for size in sizes])
            axes.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
            axes.yaxis.set_major_formatter("{x:g}")
            axes.minorticks_off()
            axes.set_xlabel(thing)
            axes.legend(title="exponent", frameon=False)
        drawing.axes[0].set_ylabel("processor time [s]")
    return drawing


def growth_figures() -> list[SpeedFigure]:
    """Exponents of the cost; also writes its figure and numbers."""
    series = list(measure())
    keep(series)
    limits = {"samples": LINEAR}
    return [
        SpeedFigure(f"{grown.command} against {grown.of}, exponent", grown.exponent, "", limits.get(grown.of))
        for grown in series
    ]


def keep(series: Sequence[Growth]) -> None:
    """Write the numbers and the figure."""
    rows = [{**asdict(growth), "exponent": growth.exponent, **versions().columns()} for growth in series]
    write_json_atomically(RESULT, rows)
    write_figure(PICTURE, growth_figure(series), dpi=120)
