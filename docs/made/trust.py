"""The tables of "how far to trust it", from the files under results: nothing is copied by hand."""

import json
from pathlib import Path
from typing import Any

import mkdocs_gen_files
import numpy as np
import pyarrow.parquet as pq

from bench.document.markdown.tables import rows_in_markdown
from bench.identification.estimators import ESTIMATORS
from bench.studies.trial.markdown import MAIN, target_cells
from bench.studies.trial.summary import TrialSummary, summarised
from bench.studies.trial.target import Share, TargetFigure
from bench.studies.trial.unknown_page import unknown_table

SEEDS = ("five_bar", "delta", "robots", "dualv")
METRICS = ("gain_error", "validate_error_over_noise_floor", "gain_within")
GAIN_GOAL = "0.1 % five-bar, 0.4 % Delta, 0.3 % others"
ENCODER_BITS = 20
CLEAN = {"five_bar": 0.0002, "delta": 0.001}
"""Scenarios without noise, and what `tests/test_identify.py` allows them."""
SHOWN = MAIN | {TargetFigure.ONE_UNDECIDED, TargetFigure.TWO_UNDECIDED, TargetFigure.THREE_UNDECIDED}
UNKNOWN = "_unknown"  # behind the robot of a trial of laws that no catalogue has
APART = "apart"  # the folder of cases that were looked at for their figures alone
NOTHING = "nothing"  # the folder of machines with nothing hidden, in each of which laws were searched
RESULTS = Path(__file__).resolve().parents[2] / "results"


def trials() -> list[TrialSummary]:
    """Of every robot with a table of cases."""
    return [
        summarised(path.stem, pq.read_table(path).to_pylist())
        for path in sorted((RESULTS / "trial").glob("*.parquet"))
        if not path.stem.endswith(UNKNOWN)
    ]


def unknown_laws() -> str:
    """What was found of laws that no catalogue has, robot by robot, and in the sets that were kept apart."""
    found = {}
    for folder in (RESULTS / "trial", RESULTS / "trial" / APART):
        for path in sorted(folder.glob(f"*{UNKNOWN}.parquet")):
            rows = pq.read_table(path).to_pylist()
            laws = [row for row in rows if row["kind"] == "unknown"]
            table = unknown_table(laws, [row for row in rows if row["kind"] == "nothing"])
            robot = path.stem.removesuffix(UNKNOWN)
            head = (
                f"{robot}, {APART}" if folder.name == APART else f"[{robot}](trust/trial_{robot}{UNKNOWN}.md)"
            )
            found[head] = {column.header: column.cells for column in table.columns}
    first = next(iter(found.values()))
    heads = ["", *found, "goal"]
    lines = [
        [figure, *(f"{of['reached'][i]}: {of['cases'][i]}" for of in found.values()), first["goal"][i]]
        for i, figure in enumerate(first["figure"])
    ]
    return rows_in_markdown(heads, lines)


def trial_table(summaries: list[TrialSummary]) -> str:
    """The figures of all trials side by side, with what they must be."""
    cells = {
        one.robot: {t.figure: target_cells(t) for t in one.targets if t.reached is not None}
        for one in summaries
    }
    figures = list(dict.fromkeys(figure for of in cells.values() for figure in of if figure in SHOWN))
    rows = []
    for figure in figures:
        (name, _, must, *_) = next(of[figure] for of in cells.values() if figure in of)
        reached = [_with_cases(of[figure]) if figure in of else "" for of in cells.values()]
        rows.append([name, *reached, must])
    heads = ["", *(f"[{robot}](trust/trial_{robot}.md)" for robot in cells), "must be"]
    return rows_in_markdown(heads, rows)


def _with_cases(cells: tuple[object, ...]) -> str:
    _, reached, _, _, cases, _ = cells
    text = f"{reached} of {cases}" if cases else str(reached)
    return text.replace(" of ", " of&nbsp;").replace(" %", "&nbsp;%")


def gains_table() -> str:
    """Errors and coverage of the gains, a column a robot."""
    tables = [pq.read_table(RESULTS / "montecarlo" / f"{name}_seeds.parquet") for name in SEEDS]
    runs: dict[str, dict[str, list[float]]] = {}
    for table in tables:
        for row in table.select(["scenario", *METRICS]).to_pylist():
            of = runs.setdefault(row["scenario"], {name: [] for name in METRICS})
            for name in METRICS:
                of[name].append(row[name])
    error, over, within = METRICS
    rows: list[tuple[str, list[str], str]] = [
        ("seeds", [str(len(of[error])) for of in runs.values()], ""),
        ("largest gain error, median", [percent(np.median(of[error])) for of in runs.values()], GAIN_GOAL),
        ("the same, 95th percentile", [percent(np.percentile(of[error], 95)) for of in runs.values()], ""),
        (
            "error not fitted, over the noise floor",
            [f"{np.median(of[over]):.3g}" for of in runs.values()],
            "1.1",
        ),
        (
            "95 % intervals that hold the truth",
            [percent(np.mean(of[within])) for of in runs.values()],
            "90–98 %",
        ),
    ]
    return rows_in_markdown(("", *runs, "at most"), [(name, *cells, most) for name, cells, most in rows])


def estimators_table() -> str:
    """Median gain error and coverage of every estimator, by the noise of the current."""
    table = pq.read_table(RESULTS / "montecarlo" / "estimators.parquet").to_pylist()
    rows = [row for row in table if row["sensors.encoder_bits"] == ENCODER_BITS]
    methods = list(dict.fromkeys(row["method"] for row in rows))
    lines = []
    for noise in sorted({row["sensors.current_noise_ratio"] for row in rows}):
        cells = []
        for method in methods:
            of = [r for r in rows if (r["method"], r["sensors.current_noise_ratio"]) == (method, noise)]
            within = 100 * float(np.mean([row["gain_within"] for row in of]))
            cells.append(f"{percent(np.median([row['gain_error'] for row in of]))} ({within:.0f}&nbsp;%)")
        lines.append((f"{100 * noise:g} %", *cells))
    return rows_in_markdown(("current noise", *(f"`{one}`" for one in methods)), lines)


def clean_table() -> str:
    """The reference scenarios without noise: what their one seed gives."""
    rows: list[tuple[str, ...]] = []
    for robot, most in CLEAN.items():
        path = RESULTS / "reference" / f"{robot}_clean.json"
        (line,) = json.loads(path.read_text(encoding="utf-8"))["lines"].values()
        (gain,), (gap,) = line["gain_error"], line["loop_gap"]
        rows.append((robot, percent(gain), percent(most), f"{1e6 * gap:.2g}&nbsp;µm"))
    return rows_in_markdown(("", "largest gain error", "at most", "largest opening of a loop"), rows)


def peers_table() -> str:
    """The same problem by other programs: the five-bar without friction."""
    scores = json.loads((RESULTS / "peers" / "peers.json").read_text(encoding="utf-8"))["scores"]
    rows = [
        (
            one["solver"],
            str(one["seeds"]),
            f"{one['seconds']:.2g}&nbsp;s",
            percent(one["gain_error"]),
            percent(one["gain_within"]),
        )
        for one in scores
        if one["robot"] == "five_bar" and not one["friction"] and one["mass_error"] is not None
    ]
    return rows_in_markdown(("", "seeds", "time", "gain error", "intervals that hold the gain"), rows)


def published_table() -> str:
    """EMPS as it was published, from what the command on the page wrote, to the digits of the paper."""
    model = json.loads((RESULTS / "measured" / "published" / "emps.json").read_text(encoding="utf-8"))
    (mass,) = model["parameters"]
    found = {"M": mass} | {
        next(iter(at["axis"])): next(iter(at["axis"].values())) for at in model["effect_parameters"].values()
    }
    rows = [
        (f"{name} [{one['unit'].replace('*', '·')}]", _digits(one["value"]), _digits(one["std"]))
        for name, one in found.items()
    ]
    rows += [
        ("condition number", _digits(model["condition"]), ""),
        ("error [%]", _digits(100 * model["error"]["identify"]), ""),
    ]
    return rows_in_markdown(("", "estimate", "standard error"), rows)


def _digits(value: float) -> str:
    return f"{value:.4f}".replace("-", "−")


def cases_table(robot: str) -> str:
    """Median of the largest gain error and coverage of every estimator, case by case."""
    rows = json.loads((RESULTS / "estimators" / f"{robot}.json").read_text(encoding="utf-8"))["rows"]
    lines = []
    for case in dict.fromkeys(row["case"] for row in rows):
        of = {row["method"]: row for row in rows if row["case"] == case}
        lines.append((case, *(_cell(of[method]) for method in ESTIMATORS)))
    return rows_in_markdown(("", *(f"`{method}`" for method in ESTIMATORS)), lines)


def _cell(row: dict[str, Any]) -> str:
    if row["error"] is None or row["error"] != row["error"]:
        return "refused"
    error = 100 * row["error"]
    told = "over 100" if error > 100.0 else f"{error:.2g}" if error < 10.0 else f"{error:.0f}"
    return f"{told}&nbsp;% ({100 * row['within']:.0f}&nbsp;%)"


def percent(share: float) -> str:
    """In percent, three figures; not to be broken."""
    return f"{100 * float(share):.3g}&nbsp;%"


def laws_of_nothing() -> str:
    """How often a law or an effect was claimed where nothing is hidden, and laws were searched all the same."""
    said = []
    for path in sorted((RESULTS / "trial" / NOTHING).glob("*.parquet")):
        rows = [row for row in pq.read_table(path).to_pylist() if row["kind"] == "nothing"]
        laws, named = (Share(sum(bool(row[name]) for row in rows), len(rows)) for name in ("laws", "missing"))
        said.append(
            f"On {len(rows)} machines `{path.stem}` with nothing hidden, laws searched in each of them, a law was "
            f"claimed {laws.count} times and an effect {named.count} times (95 % interval up to "
            f"{100.0 * laws.interval[1]:.1f} %): "
            f"`bench trial {path.stem} --kinds nothing --seeds {len(rows) // 10} --discover`."
        )
    return "\n".join(said)


def speed_table() -> str:
    """Every figure of speed as it was last measured, with its commit."""
    last: dict[str, tuple[float, str]] = {}
    for line in (RESULTS / "speed" / "history.jsonl").read_text(encoding="utf-8").splitlines():
        record = json.loads(line)
        last |= {name: (value, record["commit"]) for name, value in record["figures"].items()}
    rows = [(name, f"{value:.3g}", commit) for name, (value, commit) in last.items()]
    return rows_in_markdown(("", "measured", "commit"), rows)


def page(text: str) -> str:
    """The text with its tables in their places."""
    for place, table in (
        ("trials", trial_table(trials())),
        ("unknown laws", unknown_laws()),
        ("laws of nothing", laws_of_nothing()),
        ("gains", gains_table()),
        ("clean", clean_table()),
        ("peers", peers_table()),
        ("speed", speed_table()),
        ("estimators", estimators_table()),
        ("cases", cases_table("five_bar")),
        ("emps", published_table()),
    ):
        text = text.replace(f"<!-- {place} -->", table)
    return text


with mkdocs_gen_files.open("trust.md", "r") as read:
    whole = page(read.read())
with mkdocs_gen_files.open("trust.md", "w") as written:
    written.write(whole)
