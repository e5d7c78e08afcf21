"""The atlas's figures and numbers, `make atlas`: what a model without an effect leaves, drawn from one machine.

Every effect is hidden in the same five-bar with the same movements, gains and noise, with the largest size that the
trial hides. The model is told nothing of it (of what an effect needs beside it, it is told). Written to results/atlas:
EFFECT.png, effects.json, and robots.json with what each built-in robot's own parameters take up.
"""

import io
import json
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure
from PIL import Image

from bench.basics.figure_style import STYLE
from bench.basics.files.atomic import atomic_path, write_text_atomically
from bench.basics.versions import versions
from bench.dataset.catalogue import built_in_robots, built_in_scenarios
from bench.diagnosis.with_catalogue import diagnose_with_catalogue
from bench.document.charts.motor import motor_charts
from bench.document.figures.draw import draw
from bench.effects import CATALOGUE, places_in, select_effects
from bench.excitation.scenario import designer
from bench.identification.identify import fit
from bench.identification.prepare import prepare, with_effects
from bench.identification.problem import problem_of
from bench.identification.result import Identification
from bench.residuals.error_breakdown import error_breakdown
from bench.residuals.motor import Compared, MotorSeries, compared, relative_error_of, relative_noise
from bench.residuals.profile import Variable, profile, values_of
from bench.residuals.residuals import errors_by_motor
from bench.residuals.words import finding_sentences
from bench.scenario.scenario import resolve_trajectories
from bench.studies.sweep.accuracy import accuracy
from bench.studies.trial.cases import SHARES, SHARES_OF, Case, Hide
from bench.studies.trial.compatible import COMPANIONS
from bench.studies.trial.realise import hidden_places, realised, reference_scenario
from bench.studies.trial.setup import Setup, make_setup, where
from bench.truth.dataset import as_dataset
from bench.truth.hidden.reference import Reference
from bench.truth.simulate import Simulation, simulate

OUT = Path(__file__).resolve().parents[2] / "results" / "atlas"
ROBOT, DURATION = "five_bar", 12.0
NOISE, ENCODER_BITS, SEED = 0.005, 20, 1
FOLLOWED: tuple[Variable, ...] = ("direction", "velocity", "position", "acceleration", "current", "time")
SHOWN = ("velocity", "position", "acceleration", "current", "time", "reversals", "positions", "spectrum")
COLOURS = 48
MOST_SENTENCES = 3


def main(names: Sequence[str]) -> None:
    """Draw these effects, or all, and look at all robots."""
    setup = make_setup(ROBOT, duration=DURATION)
    trajectories = resolve_trajectories(reference_scenario(setup), designer)
    reference = Reference(simulate(reference_scenario(setup), trajectories, threads=1))
    path = OUT / "effects.json"
    kept = json.loads(path.read_text(encoding="utf-8"))["effects"] if names and path.exists() else {}
    for name in names or sorted(set(setup.catalogued)):
        case, simulation = realised(setup, _case(setup, name), reference, trajectories)
        kept[name] = _drawn(setup, case, simulation)
    about = {"robot": ROBOT, "seconds": DURATION, "noise": NOISE, "seed": SEED, **versions().columns()}
    _write(path, {"about": about, "effects": dict(sorted(kept.items()))})
    if not names:
        _write(OUT / "robots.json", {"about": versions().columns(), "robots": _robots()})


def _case(setup: Setup, effect: str) -> Case:
    """The effect at the first place of its kind, with the largest size that the trial hides."""
    at = where(effect)
    joints = {"machine": (), "passive": setup.passive, "link": tuple(setup.links)[:1]}.get(
        at, setup.motors[:1]
    )
    hide = Hide(effect, joints, SHARES_OF.get(effect, SHARES)[1])
    return Case("one", 0, (hide,), NOISE, ENCODER_BITS, SEED)


def _drawn(setup: Setup, case: Case, simulation: Simulation) -> dict[str, Any]:
    (hide,) = case.hides
    prepared = prepare(problem_of(as_dataset(simulation)))
    hidden = [
        {"effect": one.effect, **({"joint": one.joint} if one.joint else {}), **one.parameters}
        for one in simulation.scenario.settings.hidden
    ]
    places = places_in(prepared.model.geometry, list(setup.payloads))
    at = {f"{name}:{place}" if place else name: name for name, place, _ in hidden_places(setup, hidden)}
    beside = [one for one, name in at.items() if name in COMPANIONS.get(hide.effect, ())]
    without = fit(with_effects(prepared, select_effects(beside, places, CATALOGUE)))
    told = fit(with_effects(prepared, select_effects(list(at), places, CATALOGUE)))
    what = compared(prepared.dataset.robot, prepared.dataset.recordings, without.recordings, without.settings)
    joint = max(what.joints, key=lambda one: _over_noise(what.of(one)))
    series = what.of(joint)
    (motor,) = (one for one in errors_by_motor(what).motors if one.joint == joint)
    _save(_figure(what, joint), OUT / f"{hide.effect}.png")
    return {
        "hidden": hidden,
        "share": hide.share,
        "motor": joint,
        "error": motor.error,
        "noise": motor.noise,
        "above_noise": motor.above_noise,
        "follows": {one: _followed(series, one) for one in FOLLOWED},
        "lines": {one.over: [one.frequency, one.error_share] for one in motor.lines},
        "says": finding_sentences(motor)[:MOST_SENTENCES],
        "gains_off": {"without": _gains_off(simulation, without), "with": _gains_off(simulation, told)},
        "error_validate": {"without": without.error.validate, "with": told.error.validate},
    }


def _over_noise(series: Sequence[MotorSeries]) -> float:
    return (relative_error_of(series) or 0.0) / relative_noise(series)


def _followed(series: Sequence[MotorSeries], variable: Variable) -> float:
    """Share of the squared error that the means over a variable account for."""
    errors = np.concatenate([one.error for one in series])
    bins = profile(np.concatenate([values_of(one, variable) for one in series]), errors)
    taken = float(np.nansum(bins.count * np.nan_to_num(bins.mean) ** 2))
    return round(taken / float(errors @ errors), 4)


def _gains_off(simulation: Simulation, result: Identification) -> dict[str, float]:
    found = accuracy(simulation, result)
    return {joint: float(f"{found[f'gain_error.{joint}']:.4g}") for joint in result.drive_gains}


def _figure(what: Compared, joint: str) -> Figure:
    """Eight panels of the page that `bench compare` draws."""
    charts = motor_charts(error_breakdown(what, joint))
    with mpl.rc_context(STYLE | {"axes.labelsize": 9.0}):
        figure = Figure(figsize=(9.4, 7.0), dpi=120, layout="constrained")
        *axes, last = figure.subplots(3, 3).ravel()
        for place, name in zip(axes, SHOWN, strict=True):
            draw(place, charts[name])
        last.set_axis_off()
        last.legend(*axes[0].get_legend_handles_labels(), loc="center", frameon=False)
    return figure


def _save(figure: Figure, path: Path) -> None:
    """As PNG with few colours, which takes a third of the room."""
    whole = io.BytesIO()
    with mpl.rc_context(STYLE):
        figure.savefig(whole, format="png")
    few = Image.open(whole).convert("RGB").quantize(COLOURS, dither=Image.Dither.NONE)
    path.parent.mkdir(parents=True, exist_ok=True)
    with atomic_path(path) as partial:
        few.save(partial, format="png", optimize=True)


def _robots() -> dict[str, dict[str, list[str]]]:
    """What the parameters of each robot that has a scenario take up, and what has a place in it."""
    found = {}
    for name in sorted(set(built_in_robots()) & set(built_in_scenarios())):
        setup = make_setup(name, duration=DURATION)
        scenario = reference_scenario(setup)
        ranking = diagnose_with_catalogue(
            problem_of(as_dataset(simulate(scenario, resolve_trajectories(scenario, designer))))
        ).ranking
        found[name] = {
            "absorbed": sorted(one.effect for one in ranking if one.verdict == "absorbed"),
            "shows": sorted(one.effect for one in ranking if one.verdict != "absorbed"),
        }
    return found


def _write(path: Path, content: Mapping[str, Any]) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    write_text_atomically(path, json.dumps(content, indent=1, ensure_ascii=False) + "\n")


if __name__ == "__main__":
    main(sys.argv[1:])
