"""The atlas: a page for each effect, from the catalogue, `make atlas`, the trials and the measured machines."""

import inspect
import json
import re
import tomllib
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import mkdocs_gen_files
import pyarrow.parquet as pq

from bench.basics.sentence import in_percent
from bench.document.markdown.tables import rows_in_markdown
from bench.document.numbers import pretty_unit
from bench.effects import CATALOGUE, Effect
from bench.effects.display_names import begun, spoken
from bench.effects.effect import EffectParameter, ShapeParameter
from bench.residuals.look_alikes import QUESTION
from bench.studies.sweep.journal import names_in
from bench.studies.trial.summary import LARGE, first_named

RESULTS = Path(__file__).resolve().parents[2] / "results"
SIZES = tomllib.loads(
    (Path(__file__).resolve().parents[1] / "atlas" / "sizes.toml").read_text(encoding="utf-8")
)
"""Published sizes of effects."""

PLACES = {
    "actuator": "a motor",
    "passive": "a joint without a motor",
    "bearing": "a joint without a motor whose force follows from the motion",
    "body": "a body",
    "payload": "a payload",
    "robot": "the robot as a whole",
}
Numbers = Mapping[str, Any]
UNITS_OF_TRUTH = {
    ("backlash", "play"): "rad",
    ("geometric_error", "error"): "m",
    ("payload_mass_error", "error"): "kg",
    **{
        (effect, name): unit
        for effect in ("backlash", "drive_flexibility")
        for name, unit in (("stiffness", "N*m/rad"), ("damping", "N*m*s/rad"), ("rotor_inertia", "kg*m^2"))
    },
    **{(effect, "period"): "rad" for effect in ("cogging_torque", "torque_ripple", "transmission_error")},
    **{(effect, "q0"): "rad" for effect in ("joint_spring", "passive_spring")},
    **{("base_tilt", name): "rad" for name in ("about_x", "about_y")},
    ("hysteretic_cable", "reach"): "rad",
    ("platform_force", "fx"): "N",
    ("presliding_hysteresis", "stiffness"): "N*m/rad",
}
"""Of parameters that the simulated machine names otherwise than the model, at hinges: in `truth/hidden/laws`."""


def page(effect: Effect, drawn: Numbers, robots: Numbers, trials: Mapping[str, Sequence[Numbers]]) -> str:
    """Law, look, confusions, robots, measured sizes, and the command that adds it."""
    parts = [
        f"[Atlas of effects](index.md)\n\n# {begun(effect.name)}",
        law(effect),
        look(effect.name, drawn),
        confused(effect, trials),
        shown_by_robots(effect.name, robots),
        measured(effect.name),
        command(effect),
    ]
    text = "\n\n".join(part for part in parts if part) + "\n"
    return re.sub(r"(?<=\d) %", "&nbsp;%", text)


def law(effect: Effect) -> str:
    """The law with its symbols, where it holds, its source, and its parameters with units."""
    rows = [(f"`{one.name}`", units(one)) for one in effect.parameters]
    rows += [(f"`{one.name}`", f"{units(one)}, estimated by search") for one in effect.shape]
    quoted = f"> {effect.law}\n>\n> {effect.symbols}\n\n" if effect.law else ""
    first, _, rest = inspect.cleandoc(type(effect).__doc__ or "").partition("\n\n")
    about = rest if rest and said_by(first, effect.law) else f"{first}\n\n{rest}"
    table = rows_in_markdown(("parameter", "unit at a hinge or a slide"), rows)
    return f"{quoted}{about}\n\nIt sits at {PLACES[effect.place]}.\n\n{table}"


def said_by(sentence: str, law: str) -> bool:
    """Whether the words of a sentence, formulas aside, all stand in the law."""
    words = set(re.findall(r"[a-z]{3,}", law.lower()))
    return set(re.findall(r"[a-z]{3,}", sentence.lower())) - {"tau", "tanh", "exp"} <= words


def units(one: EffectParameter | ShapeParameter) -> str:
    """Its unit at a hinge, and at a slide where it is another."""
    both = dict.fromkeys(pretty_unit(one.unit_at(rotates) or "1") for rotates in (True, False))
    return " or ".join(both)


def sized(effect: str, name: str, value: float) -> str:
    """A parameter of the simulated machine with its value and its unit; the joints of the five-bar are hinges."""
    law = CATALOGUE[effect]
    own = {one.name: one.unit_at(True) for one in (*law.parameters, *law.shape)}
    unit = own[name] if name in own else UNITS_OF_TRUTH[effect, name]
    return f"{name} = {value:g} {pretty_unit(unit)}" if unit not in ("", "1") else f"{name} = {value:g}"


def look(name: str, drawn: Numbers) -> str:
    """The figure of a model without the effect, what `bench compare` says, and what the fit makes of it."""
    hidden = drawn.get("effects", {}).get(name)
    if hidden is None:
        return ""
    about = drawn["about"]
    what = ", ".join(
        f"{spoken(one['effect'])}"
        + (f" at {one['joint']}" if "joint" in one else "")
        + f" ({', '.join(sized(one['effect'], key, one[key]) for key in one if key not in ('effect', 'joint'))})"
        for one in hidden["hidden"]
    )
    said = "\n".join(f"> - {sentence}" for sentence in hidden["says"]) or (
        "> - nothing: the error is at the noise floor"
        if not hidden["above_noise"]
        else "> - no single variable that it follows far beyond chance"
    )
    gains = ", ".join(
        f"{joint} {100 * off:+.2f} % (with it {100 * hidden['gains_off']['with'][joint]:+.2f} %)"
        for joint, off in hidden["gains_off"]["without"].items()
    )
    return (
        "## What it looks like\n\n"
        f"Hidden in the five-bar: {what}. Its torque is {in_percent(hidden['share'])} of the motor's (RMS over RMS). "
        f"Error of motor {hidden['motor']} in a model without it: {in_percent(hidden['error'])} of the current; "
        f"noise floor {in_percent(hidden['noise'])}.\n\n"
        f"[![Errors of a model without {spoken(name)}]({name}.png)]({name}.png)\n\n"
        f"`bench compare` says:\n\n{said}\n\n"
        f"Effect on the fit: the drive gains are off by {gains}.\n\n"
        f"*Seed {about['seed']}, {about['seconds']:g} s per recording; commit {about['commit']}: `make atlas`.*"
    )


def confused(effect: Effect, trials: Mapping[str, Sequence[Numbers]]) -> str:
    """What was named in the blind trials where this effect alone was hidden, and what tells them apart."""
    rows, others = [], Counter[str]()
    for robot, all_rows in trials.items():
        cases = [
            row
            for row in all_rows
            if row["status"] == "ok"
            and row["kind"] == "one"
            and row["hidden"] == effect.name
            and not row["absorbed"]
        ]
        large = [row for row in cases if row["least_own_error_over_floor"] >= LARGE]
        if not large:
            continue
        first = Counter(first_named(row) for row in large)
        instead = {name: count for name, count in first.items() if name != effect.name}
        listed = Counter(name for row in large for name in listed_beside(row, effect.name))
        others.update({name: n for name, n in instead.items() if name in CATALOGUE})
        others.update(listed)
        rows.append(
            (robot, f"{first[effect.name]} of {len(large)}", counted(instead) or "–", counted(listed) or "–")
        )
    if not rows:
        text = "No trial hid it alone with an error of three times the noise floor or more."
        return f"## With what it is confused\n\n{text}\n\nTo see it, {effect.shown_by}."
    table = rows_in_markdown(("robot", "named first", "named instead", "undecided between it and"), rows)
    motions = "\n".join(
        f"- from [{spoken(name)}]({name}.md): {effect.shown_by}; {CATALOGUE[name].shown_by}"
        for name, _ in others.most_common(4)
    )
    apart = f"\n\nTo see it, {effect.shown_by}."
    if motions:
        apart += f"\n\nTo tell them apart (`bench discriminate` designs the motion):\n\n{motions}"
    note = (
        f"[Blind trials](../trust.md), cases in which its error is at least {LARGE:g} times the noise floor. "
        "A case that is undecided between several effects counts for each of them, and may also count as named first."
    )
    return f"## With what it is confused\n\n{note}\n\n{table}{apart}"


def listed_beside(row: Numbers, name: str) -> list[str]:
    """What the verdicts of a case name openly beside the hidden effect, each once."""
    found: set[str] = set()
    for one in json.loads(row["verdicts"]):
        group = {one["effect"], *one["alternatives"]}
        if one["verdict"] == "indistinguishable" and name in group:
            found |= group - {name}
    return sorted(found)


def counted(names: Mapping[str, int]) -> str:
    """Such as "viscous friction 2, backlash 1"."""
    return ", ".join(
        f"{spoken(name)} {count}" for name, count in sorted(names.items(), key=lambda one: -one[1])
    )


def shown_by_robots(name: str, robots: Numbers) -> str:
    """Which built-in robots can show it, which take it up, and which have no place for it."""
    if not robots:
        return ""
    by: dict[str, list[str]] = {"can show it": [], "absorb it": [], "have no place for it": []}
    for robot, one in robots["robots"].items():
        kind = (
            "can show it"
            if name in one["shows"]
            else "absorb it"
            if name in one["absorbed"]
            else "have no place for it"
        )
        by[kind].append(robot)
    rows = [(kind, ", ".join(names)) for kind, names in by.items() if names]
    return (
        "## Which robots can show it\n\n"
        "Computed with the motions and payloads of each robot's scenario (`make atlas`, commit "
        f"`{robots['about']['commit'][:7]}`). If a robot absorbs it, the "
        "parameters of the model absorb the effect, and no data of that kind can distinguish them.\n\n"
        + rows_in_markdown(("robots that", ""), rows)
    )


def measured(name: str) -> str:
    """Its sizes on measured machines beside what is known of them, what was found there, and what is published."""
    rows, verdicts = [], []
    for path in sorted((RESULTS / "measured").glob("*.json")):
        runs = json.loads(path.read_text(encoding="utf-8"))["runs"]
        for one in runs[0]["rows"]:
            if one["quantity"].partition(" ")[0] == name:
                known = "–" if one["known"] is None else f"{one['known']:g}"
                value = f"{one['value']:.4g} ± {one['std']:.2g} {pretty_unit(one['unit'])}"
                rows.append((path.stem, one["place"], one["quantity"].partition(" ")[2], value, known))
        for run in runs:
            gains = [row for row in run["rows"] if row["quantity"] == "drive_gain"]
            units_at = {row["place"]: row["unit"].partition("/")[0] for row in gains}
            for one in run["found"]:
                if one["effect"] != name:
                    continue
                line = f"- `bench {run['command']}` reports it as {one['verdict']}, at {', '.join(one['places'])}"
                verdicts.append(f"{line}{sizes_of(one, units_at)}")
    published = [
        f"- {one['machine']}: {one['size']} ([{one['source']}]({one['address']}))."
        for one in SIZES.get(name, ())
    ]
    parts = [rows_in_markdown(("machine", "at", "parameter", "identified", "known"), rows)] if rows else []
    parts += ["\n".join(lines) for lines in (verdicts, published) if lines]
    if rows or verdicts:
        parts.append("Logs and sources of the known values: [measured machines](../measured.md).")
    if not parts:
        none = "None of the [measured machines](../measured.md) has shown it"
        parts = [f"{none}, and no published size with a readable source is known."]
    return "\n\n".join(("## On real machines", *parts))


def sizes_of(found: Numbers, units_at: Mapping[str, str]) -> str:
    """What a diagnosis found at each motor: its parameters, and its torque, RMS. units_at: of torques, by motor.

    Records of earlier programs have neither.
    """
    told = []
    for place in found["places"]:
        values = [
            f"{one['name']} = {one['value']:.3g}"
            + ("" if one["std"] is None else f" ± {one['std']:.1g}")
            + f" {pretty_unit(one['unit'])}".replace(" 1", "").rstrip()
            for one in found.get("parameters", ())
            if one["place"] == place and one["value"] is not None
        ]
        if place in found.get("size", {}):
            values.append(f"{found['size'][place]:.3g} {pretty_unit(units_at[place])} RMS")
        if values:
            told.append(f"{place} {', '.join(values)}")
    return "".join(f"\n    - {one}" for one in told)


def command(effect: Effect) -> str:
    """How it is added to a model."""
    everywhere = f"bench identify DATASET --with {effect.name}\n"
    if effect.place == "robot":
        return f"## Add it\n\n```sh\n{everywhere}```"
    return (
        "## Add it\n\nEverywhere, or at one place:\n\n```sh\n"
        f"{everywhere}bench identify DATASET --with {effect.name}:PLACE\n```"
    )


def seen_table(drawn: Numbers) -> str:
    """Shares of the squared error that follow each variable, a row an effect."""
    effects = drawn.get("effects", {})
    if not effects:
        return ""
    variables = list(next(iter(effects.values()))["follows"])
    rows = []
    for name, one in effects.items():
        cells = {key: f"{100 * share:.0f} %" for key, share in one["follows"].items()}
        if one["above_noise"]:
            best = max(one["follows"], key=one["follows"].get)
            cells[best] = f"**{cells[best]}**"
        else:
            cells = dict.fromkeys(cells, "–")
        over = f"{one['error'] / one['noise']:.1f}"
        rows.append((f"[{spoken(name)}]({name}.md)", over, *(cells[key] for key in variables)))
    return rows_in_markdown(("effect", "error over noise", *variables), rows)


def key_table(question: int) -> str:
    """What the answers to a question of the key lead to, the plainest law first; effects that look alike in one row."""
    found: dict[str, list[str]] = {}
    for effect in sorted(
        CATALOGUE.values(), key=lambda one: (len(one.parameters) + len(one.shape), one.name)
    ):
        for look, words in zip(effect.seen, effect.in_key, strict=True):
            if words and QUESTION[look] == question:
                found.setdefault(words, []).append(f"[{spoken(effect.name)}]({effect.name}.md)")
    return "\n".join(f"    | {words} | {', '.join(links)} |" for words, links in found.items())


def outside_table(trials: Mapping[str, Sequence[Numbers]]) -> str:
    """What was said of machines with an effect that no model here knows, large enough to be seen."""
    rows = []
    for robot, all_rows in trials.items():
        large = [
            row
            for row in all_rows
            if row["status"] == "ok"
            and row["kind"] == "outside"
            and row["least_own_error_over_floor"] >= LARGE
        ]
        for name in sorted({row["hidden"] for row in large}):
            of = [row for row in large if row["hidden"] == name]
            told = sum(bool(row["unexplained"]) for row in of)
            wrong = Counter(name for row in of for name in names_in(row["wrong"]))
            rows.append((spoken(name), robot, f"{told} of {len(of)}", counted(wrong) or "–"))
    table = rows_in_markdown(("hidden", "robot", "said to be unexplained", "named wrongly for sure"), rows)
    searched = any("laws" in row for all_rows in trials.values() for row in all_rows)
    return table if searched else f"{table}\n\nThese trials were run without a search for laws."


def read(path: Path) -> dict[str, Any]:
    """JSON of `make atlas`."""
    return dict(json.loads(path.read_text(encoding="utf-8")))


UNKNOWN = "_unknown"  # behind the robot of a trial of laws that no catalogue has

seen, shown = read(RESULTS / "atlas" / "effects.json"), read(RESULTS / "atlas" / "robots.json")
tried = {
    path.stem: pq.read_table(path).to_pylist()
    for path in sorted((RESULTS / "trial").glob("*.parquet"))
    if not path.stem.endswith(UNKNOWN) and "missing" in pq.read_schema(path).names
}
for effect_name, found in sorted(CATALOGUE.items()):
    with mkdocs_gen_files.open(f"atlas/{effect_name}.md", "w") as written:
        written.write(page(found, seen, shown, tried))
with mkdocs_gen_files.open("atlas/index.md", "r") as key:
    text = key.read()
with mkdocs_gen_files.open("atlas/index.md", "w") as written:
    for number in sorted(set(QUESTION.values())):
        text = text.replace(f"    <!-- key {number} -->", key_table(number))
    text = text.replace("<!-- seen -->", seen_table(seen)).replace("<!-- outside -->", outside_table(tried))
    written.write(text)
