"""The tables of "how far to trust it", from the files under results: nothing is copied by hand."""

import json
from collections import Counter
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import mkdocs_gen_files
import numpy as np
import pyarrow.parquet as pq

from bench.benchmarks.trust.evaluation import read_evaluation
from bench.benchmarks.trust.page import front
from bench.document.markdown.tables import rows_in_markdown
from bench.identification.estimators import ESTIMATORS
from bench.studies.trial.markdown import MAIN, target_cells
from bench.studies.trial.summary import TrialSummary, summarised
from bench.studies.trial.target import Attained, Share, Target, TargetFigure
from bench.studies.trial.unknown_page import unknown_table

SEEDS = ("five_bar", "delta", "robots", "dualv")
METRICS = ("gain_error", "validate_error_over_noise_floor", "gain_within")
GAIN_GOALS = {"five_bar": 0.001, "delta": 0.004}
GAIN_GOAL = 0.003  # of the other robots
FLOOR = 1.1
COVERAGE = (0.90, 0.98)
ENCODER_BITS = 20
CLEAN = {"five_bar": 0.0002, "delta": 0.001}
"""Scenarios without noise, and what `tests/test_identify.py` allows them."""
SHOWN = MAIN | {
    TargetFigure.ONE_UNDECIDED,
    TargetFigure.TWO_UNDECIDED,
    TargetFigure.THREE_UNDECIDED,
    TargetFigure.OUTSIDE_LAW,
}
UNKNOWN = "_unknown"  # behind the robot of a trial of laws that no catalogue has
APART = "apart"  # the folder of cases that were looked at for their figures alone
NOTHING = "nothing"  # the folder of machines with nothing hidden, in each of which laws were searched
NO_CASE = "–"
RESULTS = Path(__file__).resolve().parents[2] / "results"


def trials(folder: Path = RESULTS / "trial") -> str:
    """The table of every robot with cases."""
    rows = {
        path.stem: pq.read_table(path).to_pylist()
        for path in sorted(folder.glob("*.parquet"))
        if not path.stem.endswith(UNKNOWN)
    }
    return trial_table(
        {robot: summarised(robot, of) for robot, of in rows.items()},
        {robot: commits_of(of) for robot, of in rows.items()},
        linked=folder.name != APART,
    )


def unknown_laws() -> str:
    """What was found of laws that no catalogue has, robot by robot, and in the sets that were kept apart."""
    found, commits = {}, {}
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
            commits[head] = commits_of(rows)
    first = next(iter(found.values()))
    heads = ["", *found, "goal"]
    lines = [
        [
            figure,
            *(
                f"{of['reached'][i]} {of['cases'][i]}".replace(" of ", "&nbsp;of&nbsp;")
                if of["reached"][i] != NO_CASE
                else ""
                for of in found.values()
            ),
            first["goal"][i],
        ]
        for i, figure in enumerate(first["figure"])
        if any(of["reached"][i] != NO_CASE for of in found.values())
    ]
    lines.append(["commits of the cases", *commits.values(), ""])
    return rows_in_markdown(heads, lines)


def trial_table(
    summaries: Mapping[str, TrialSummary], commits: Mapping[str, str], *, linked: bool = True
) -> str:
    """The figures of all trials side by side, with what they must be, and the commits of their cases.

    linked: each robot to the page of its trial.
    """
    targets = {
        robot: {one.figure: one for one in of.targets if one.reached is not None}
        for robot, of in summaries.items()
    }
    rows = []
    for figure in (one for one in TargetFigure if one in SHOWN):
        of = [targets[robot].get(figure) for robot in targets]
        first = next((one for one in of if one is not None), None)
        if first is not None:
            rows.append([target_cells(first)[0], *map(_reached, of), _bound(first)])
    rows.append(["commits of the cases", *(commits[robot] for robot in summaries), ""])
    names = [f"[{robot}](trust/trial_{robot}.md)" if linked else robot for robot in summaries]
    return rows_in_markdown(["", *names, "must be"], rows)


def _reached(target: Target | None) -> str:
    """What was reached, of how many; marked where it is not what it must be."""
    if target is None:
        return ""
    _, shown, *_ = target_cells(target)
    mark = {Attained.NO: "✗ ", Attained.TOO_FEW: "? "}.get(target.kept, "") if target.reached is False else ""
    text = f"{mark}{shown}".replace(" ", "&nbsp;")
    text = f"**{text}**" if mark else text
    return text if target.share is None else f"{text} {target.share.count}&nbsp;of&nbsp;{target.share.of}"


def _bound(target: Target) -> str:
    """Such as "≥ 95 %"."""
    unit = "&nbsp;%" if target.share else ""
    least, most = (
        None if one is None else f"{100.0 * one:.0f}" if target.share else f"{one:g}"
        for one in (target.least, target.most)
    )
    if least and most:
        return f"{least} to {most}{unit}"
    return f"≥&nbsp;{least}{unit}" if least else f"≤&nbsp;{most}{unit}" if most else ""


def commits_of(rows: Iterable[Mapping[str, Any]]) -> str:
    """The commits of the program that wrote some rows, shortened, the one of most rows first."""
    counts = Counter(row["commit"] for row in rows if row.get("commit"))
    return " ".join(f"`{commit[:7]}`" for commit, _ in counts.most_common()) or "not kept"


def gains_table() -> str:
    """Errors and coverage of the gains, a column a robot."""
    runs: dict[str, list[dict[str, Any]]] = {}
    for name in SEEDS:
        table = pq.read_table(RESULTS / "montecarlo" / f"{name}_seeds.parquet")
        for row in table.select(["scenario", "commit", *METRICS]).to_pylist():
            runs.setdefault(row["scenario"], []).append(row)
    error, over, within = ({robot: [r[name] for r in of] for robot, of in runs.items()} for name in METRICS)
    goals = {robot: GAIN_GOALS.get(robot, GAIN_GOAL) for robot in runs}
    medians = {robot: float(np.median(of)) for robot, of in error.items()}
    rows = [
        ("seeds", *(str(len(of)) for of in runs.values()), ""),
        (
            "largest gain error, median",
            *(marked(percent(value), not_kept=value > goals[robot]) for robot, value in medians.items()),
            "as below",
        ),
        ("– must be at most", *(percent(goal) for goal in goals.values()), ""),
        ("– 95th percentile", *(percent(np.percentile(of, 95)) for of in error.values()), ""),
        (
            "error not fitted, over the noise floor: median",
            *(marked(f"{np.median(of):.3g}", not_kept=np.median(of) > FLOOR) for of in over.values()),
            f"≤&nbsp;{FLOOR:g}",
        ),
        ("95 % intervals that contain the truth", *map(_coverage, within.values()), _bound(_held(1.0, 1))),
        ("commit", *map(commits_of, runs.values()), ""),
    ]
    return rows_in_markdown(("", *runs, "must be"), rows)


def marked(text: str, *, not_kept: bool) -> str:
    """In bold behind a cross where it is not what it must be."""
    return f"**✗&nbsp;{text}**" if not_kept else text


def _held(value: float, seeds: int) -> Target:
    """A coverage, where the gains of a seed count once: their errors go together."""
    return Target(TargetFigure.INTERVALS, value, *COVERAGE, Share(round(value * seeds), seeds))


def _coverage(within: list[float]) -> str:
    target = _held(float(np.mean(within)), len(within))
    text = percent(target.value)
    if target.reached:
        return text
    return f"**?&nbsp;{text}**" if target.kept is Attained.TOO_FEW else f"**✗&nbsp;{text}**"


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
    table_text = rows_in_markdown(("current noise", *(f"`{one}`" for one in methods)), lines)
    return f"{table_text}\n\n*`bench sweep estimators`, commit {commits_of(rows)}.*"


def clean_table() -> str:
    """The reference scenarios without noise: what their one seed gives."""
    rows: list[tuple[str, ...]] = []
    for robot, most in CLEAN.items():
        path = RESULTS / "reference" / f"{robot}_clean.json"
        (line,) = json.loads(path.read_text(encoding="utf-8"))["lines"].values()
        (gain,), (gap,) = line["gain_error"], line["loop_gap"]
        commit = json.loads(path.read_text(encoding="utf-8"))["program"]["commit"]
        gain_text = marked(percent(gain), not_kept=gain > most)
        rows.append((robot, gain_text, percent(most), f"{1e6 * gap:.2g}&nbsp;µm", f"`{commit[:7]}`"))
    heads = ("", "largest gain error", "must be at most", "largest opening of a loop", "commit")
    return rows_in_markdown(heads, rows)


def peers_table() -> str:
    """The same problem by other programs: the five-bar without friction."""
    kept = json.loads((RESULTS / "peers" / "peers.json").read_text(encoding="utf-8"))
    rows = [
        (
            one["solver"],
            str(one["seeds"]),
            f"{one['seconds']:.2g}&nbsp;s",
            percent(one["gain_error"]),
            percent(one["gain_within"]),
        )
        for one in kept["scores"]
        if one["robot"] == "five_bar" and not one["friction"] and one["mass_error"] is not None
    ]
    table = rows_in_markdown(("", "seeds", "time", "gain error", "intervals that contain the gain"), rows)
    return f"{table}\n\n*`make peers`, commit {commits_of([kept])}.*"


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
    kept = json.loads((RESULTS / "estimators" / f"{robot}.json").read_text(encoding="utf-8"))
    rows, lines = kept["rows"], []
    for case in dict.fromkeys(row["case"] for row in rows):
        of = {row["method"]: row for row in rows if row["case"] == case}
        lines.append((case, *(_cell(of[method]) for method in ESTIMATORS)))
    table = rows_in_markdown(("", *(f"`{method}`" for method in ESTIMATORS)), lines)
    return f"{table}\n\n*`python -m bench.studies.estimators`, commit {commits_of([kept])}.*"


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
            f"On {len(rows)} machines `{path.stem}` with nothing hidden and a search for laws in each, a law was "
            f"named {laws.count} times and an effect {named.count} times (95 % interval up to "
            f"{100.0 * laws.interval[1]:.1f} %): "
            f"`bench trial {path.stem} --kinds nothing --seeds {len(rows) // 10} --discover`."
        )
    return "\n".join(said)


def speed_table() -> str:
    """Every figure of speed as it was last measured, with its commit."""
    last: dict[str, tuple[str, str]] = {}
    for line in (RESULTS / "speed" / "history.jsonl").read_text(encoding="utf-8").splitlines():
        record = json.loads(line)
        for name, value in record["figures"].items():
            unit = record["units"][name]  # empty for an exponent, which has none
            last[name] = (f"{value:.3g}&nbsp;{unit}".removesuffix("&nbsp;"), record["commit"])
    rows = [(name, value, f"`{commit[:7]}`") for name, (value, commit) in last.items()]
    return rows_in_markdown(("", "measured", "commit"), rows)


def evaluation(path: Path = RESULTS / "trust" / "trust.parquet") -> str:
    """The table of `make trust`, and what goes wrong most often; empty before it has run."""
    if not path.is_file():
        return ""
    link = "[Every case, probabilities, intervals, stability and cost](trust/evaluation.md)."
    return "\n\n".join(block for block in (*front(read_evaluation(path)), link) if block)


def page(text: str) -> str:
    """The text with its tables in their places."""
    for place, table in (
        ("evaluation", evaluation()),
        ("trials", trials()),
        ("trials apart", trials(RESULTS / "trial" / APART)),
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
