"""Effects that change the machine are compared when converged, where their tangents say little."""

from bench.diagnosis.base_model import added_names, base_model_of
from bench.diagnosis.candidates import propose
from bench.diagnosis.rounds import _best_machine, _converged, round_about, with_set
from bench.effects import CATALOGUE
from bench.identification.prepare import prepare
from bench.identification.problem import problem_of
from bench.truth.dataset import as_dataset
from tests.discover_kit import simulated

ZEROS = [{"effect": "encoder_offset", "joint": motor, "offset": 0.08} for motor in ("left", "right")]
MACHINES = {name: CATALOGUE[name] for name in ("encoder_offset", "geometric_error", "constant_offset")}


def test_wrong_zeros_take_the_place_of_lengths_that_imitate_them():
    base_model = base_model_of(prepare(problem_of(as_dataset(simulated(*ZEROS)))))
    proposals = propose(base_model.context(base_model.start), MACHINES)
    first = round_about(base_model, base_model.start, proposals, ())
    names = [proposal.name for proposal in proposals]
    lengths = _converged(base_model, with_set(first, [names.index("geometric_error")]))
    assert added_names(base_model, _best_machine(base_model, lengths, ()).model) == {"encoder_offset"}
    assert _best_machine(base_model, lengths, {"encoder_offset"}) is lengths
    zeros = _converged(base_model, with_set(first, [names.index("encoder_offset")]))
    assert _best_machine(base_model, zeros, ()) is zeros
