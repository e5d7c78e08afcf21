"""What a diagnosis makes of hidden effects that are known."""

from __future__ import annotations

from bench.diagnosis.discovery.find import find_missing_effects
from bench.identification.prepare import Prepared
from bench.identification.problem import problem_of
from bench.truth.machine import true_gains
from bench.truth.simulate import Simulation


def diagnosis_metrics(simulation: Simulation, prepared: Prepared) -> dict[str, float | str]:
    """Effects missed and invented, the identified names, and the gain error of the model with them.

    An effect that the data cannot tell from the true one counts as identified.
    """
    modelled = tuple(dict.fromkeys(instance.request for instance in prepared.effects))
    problem = problem_of(prepared.dataset, modelled, filters=prepared.settings)
    diagnosis = find_missing_effects(problem, discover=False)  # effects of the catalogue are what counts
    hidden = {effect.name for effect in simulation.machine.hidden} - {
        instance.effect.name for instance in prepared.effects
    }
    alternatives = {verdict.effect: {verdict.effect, *verdict.alternatives} for verdict in diagnosis.ranking}
    missed = [name for name in hidden if not any(name in alternatives[other] for other in diagnosis.missing)]
    invented = [name for name in diagnosis.missing if not alternatives[name] & hidden]
    gains = diagnosis.after.drive_gains.values()
    errors = [
        abs(gain.value / truth - 1.0)
        for gain, truth in zip(gains, true_gains(simulation.scenario), strict=True)
    ]
    return {
        "diagnosis.missed": float(len(missed)),
        "diagnosis.invented": float(len(invented)),
        "diagnosis.missing": " + ".join(diagnosis.missing) or "none",
        "diagnosis.gain_error": max(errors),
        "diagnosis.unexplained": float(diagnosis.unexplained.significant),
    }
