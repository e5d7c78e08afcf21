"""The tasks of a trial: simulate, diagnose, and compare the diagnosis with the truth."""

import json
from collections.abc import Sequence
from dataclasses import asdict
from functools import partial
from typing import Any

from bench.basics.errors import BenchError
from bench.basics.versions import versions
from bench.dataset.dataset import Dataset
from bench.diagnosis.discovery.find import find_missing_effects
from bench.diagnosis.result import Diagnosis
from bench.effects import CATALOGUE, places_in, select_effects
from bench.excitation.scenario import designer
from bench.identification.identify import fit
from bench.identification.prepare import Prepared, prepare, with_effects
from bench.identification.problem import problem_of
from bench.identification.result import Identification
from bench.scenario.scenario import resolve_trajectories
from bench.studies.sweep.accuracy import accuracy
from bench.studies.sweep.journal import FAILED, OK, Row, cell_of
from bench.studies.sweep.run_plan import Work
from bench.studies.sweep.work import Trajectories
from bench.studies.trial.cases import Case, TrialPlan
from bench.studies.trial.compatible import PARTS, expected
from bench.studies.trial.intervals import intervals, moving_alike
from bench.studies.trial.judge import Named, judgement_of, law_columns
from bench.studies.trial.realise import Entry, hidden_places, realised, reference_scenario
from bench.studies.trial.setup import Setup
from bench.studies.trial.unknown import LAW, named_parts
from bench.truth.dataset import as_dataset
from bench.truth.hidden.reference import Reference
from bench.truth.machine import true_gains
from bench.truth.simulate import Simulation, simulate

UNNAMED = ("outside", "unknown")
"""Kinds of cases whose first hidden effect is in no catalogue."""


def trial_trajectories(setup: Setup, _: None = None) -> Trajectories:
    """Design the trajectories of all cases, by recording name."""
    return resolve_trajectories(reference_scenario(setup), designer)


def undisturbed(setup: Setup, trajectories: Trajectories, _: None = None) -> Simulation:
    """Simulate the motions without hidden effects, the reference for sizes."""
    return simulate(reference_scenario(setup), trajectories, threads=1)


def case_rows(
    setup: Setup, case: Case, number: int, trajectories: Trajectories, reference: Simulation | None = None
) -> list[Row]:
    """Simulate one case and diagnose it: one row.

    reference: a simulation shared with other cases; with None, it is simulated.
    """
    without = reference or undisturbed(setup, trajectories)
    try:
        realised_case, simulation = realised(setup, case, Reference(without), trajectories)
        return [diagnosed_row(setup, realised_case, number, simulation)]
    except BenchError as error:
        return [failed_row(setup, case, number, str(error))]


def trial_work(plan: TrialPlan) -> Work:
    """The tasks of a trial."""
    setup = plan.setup
    return Work(
        design=lambda _run: partial(trial_trajectories, setup),
        motion=lambda _run, trajectories: partial(undisturbed, setup, trajectories),
        runs=lambda runs, trajectories: partial(
            case_rows, setup, plan.case(runs[0].number), runs[0].number, trajectories
        ),
        failed=lambda run, reason: failed_row(setup, plan.case(run.number), run.number, reason),
    )


def failed_row(setup: Setup, case: Case, number: int, reason: str) -> Row:
    """The row of a failed case."""
    return _case_columns(setup, case, number) | {"status": FAILED, "reason": " ".join(reason.split())}


def diagnosed_row(setup: Setup, case: Case, number: int, simulation: Simulation) -> Row:
    """Diagnose the dataset of a simulation, without access to the truth, and score the diagnosis."""
    dataset = as_dataset(simulation)
    diagnosis = find_missing_effects(problem_of(dataset), discover=setup.discover or None)
    hidden = [_plain_entry(hidden_effect) for hidden_effect in simulation.scenario.settings.hidden]
    known = [name for name in case.effects if name != LAW]
    informed, alone = _informed_fits(setup, dataset, hidden, known)
    floor = _floor(simulation, informed)
    error_ratios = {effect: _error(result) / floor for effect, result in alone.items()}
    if case.kind in UNNAMED:
        error_ratios[case.effects[0]] = _error(informed) / floor
    row = _case_columns(setup, case, number) | {"parameters": json.dumps(hidden)}
    row |= {f"own_error_over_floor.{i + 1}": error_ratios[effect] for i, effect in enumerate(case.effects)}
    row["least_own_error_over_floor"] = min((error_ratios[effect] for effect in case.effects), default=0.0)
    row |= _answer(case, diagnosis)
    row |= _accuracy(simulation, diagnosis, informed, floor)
    row["laws"] = len(diagnosis.discovered)
    if case.kind == "unknown":
        row |= law_columns(simulation, diagnosis, prepare(problem_of(dataset)))
    alike = moving_alike(simulation, setup.passive)
    row["intervals"] = json.dumps(intervals(setup, hidden, diagnosis.after, alike))
    row["intervals_told"] = json.dumps(intervals(setup, hidden, informed, alike))
    row["gains"] = json.dumps(_gains(simulation, diagnosis.after))
    stated = {verdict.effect: verdict.probability for verdict in diagnosis.ranking}
    row["probabilities"] = json.dumps({name: p for name, p in stated.items() if p is not None})
    return row | versions().columns()


def _case_columns(setup: Setup, case: Case, number: int) -> Row:
    return {
        "run": number,
        "drawn_from": cell_of(case.drawn_from),
        "status": OK,
        "reason": None,
        "scenario": setup.name,
        "seed": case.seed,
        "kind": case.kind,
        "hidden": cell_of(case.effects),
        "joints": cell_of(",".join(hide.joints) or "machine" for hide in case.hides),
        "shares": json.dumps([hide.share for hide in case.hides]),
        "current_noise_ratio": case.noise,
        "encoder_bits": case.encoder_bits,
    }


def _plain_entry(effect: Any) -> Entry:
    return {"effect": effect.effect, **({"joint": effect.joint} if effect.joint else {}), **effect.parameters}


def _informed_fits(
    setup: Setup, dataset: Dataset, hidden: Sequence[Entry], effects: Sequence[str]
) -> tuple[Identification, dict[str, Identification]]:
    """The fit of a model with the true effects at their places, and a fit without each of `effects`."""
    prepared = prepare(problem_of(dataset))
    wanted = {
        f"{effect}:{place}" if place else effect: effect for effect, place, _ in hidden_places(setup, hidden)
    }
    alone = {}
    for name in effects if wanted else ():
        gone = {name, *PARTS.get(name, ())}
        alone[name] = _fitted(prepared, [request for request, of in wanted.items() if of not in gone])
    return _fitted(prepared, list(wanted)), alone


def _fitted(prepared: Prepared, wanted: Sequence[str]) -> Identification:
    places = places_in(prepared.model.geometry, prepared.dataset.weighed)
    return fit(with_effects(prepared, select_effects(wanted, places, CATALOGUE)))


def _error(result: Identification) -> float:
    """Relative error on recordings that are not fitted, or on the fitted ones if there are no others."""
    return float("nan") if result.error.reported is None else result.error.reported


def _floor(simulation: Simulation, result: Identification) -> float:
    use = "identify" if result.error.validate is None else "validate"
    return accuracy(simulation, result)[f"noise_floor.{use}"]


def _answer(case: Case, diagnosis: Diagnosis) -> Row:
    by_name = {verdict.effect: verdict for verdict in diagnosis.ranking}
    wanted = [name for name in expected(case.effects) if name != LAW]  # it is in no catalogue
    verdicts = [
        {
            "effect": verdict.effect,
            "verdict": verdict.verdict,
            "evidence": round(verdict.evidence, 3),
            "probability": verdict.probability,
            "actuators": list(verdict.actuators),
            "alternatives": list(verdict.alternatives),
        }
        for name in (*diagnosis.missing, *(n for n in wanted if n not in diagnosis.missing))
        if (verdict := by_name.get(name)) is not None
    ]
    named = [Named(name, by_name[name].verdict, by_name[name].alternatives) for name in diagnosis.missing]
    drawn = case.effects[1:] if case.kind in UNNAMED else case.effects
    parts = [part for hide in case.hides for part in named_parts(dict(hide.numbers))]
    judgement = judgement_of(drawn, wanted, named, parts)
    absorbed = bool(case.effects) and all(
        by_name[name].verdict == "absorbed" for name in case.effects if name in by_name
    )
    return {
        "missing": cell_of(diagnosis.missing),
        "verdicts": json.dumps(verdicts),
        **asdict(judgement),
        "wrong": cell_of(judgement.wrong),
        "absorbed": absorbed and case.kind not in UNNAMED,
        "unexplained": diagnosis.unexplained.significant,
        "depends_on": ", ".join(diagnosis.unexplained.depends_on),
    }


def _gains(simulation: Simulation, result: Identification) -> list[dict[str, Any]]:
    """Estimate, standard error and truth of every drive gain."""
    truth = true_gains(simulation.scenario)
    return [
        {"joint": joint, "truth": float(true), "value": gain.value, "std": gain.std}
        for (joint, gain), true in zip(result.drive_gains.items(), truth, strict=True)
    ]


def _accuracy(simulation: Simulation, diagnosis: Diagnosis, informed: Identification, floor: float) -> Row:
    row: Row = {"noise_floor": floor, "noise_floor_estimated": diagnosis.unexplained.noise_floor}
    for name, result in (("before", diagnosis.before), ("after", diagnosis.after), ("told", informed)):
        row[f"error.{name}"] = _error(result)
        row[f"error_over_floor.{name}"] = _error(result) / _floor(simulation, result)
        row[f"gain_error.{name}"] = accuracy(simulation, result)["gain_error"]
    return row
