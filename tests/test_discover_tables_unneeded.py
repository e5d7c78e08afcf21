"""Tables of measured laws that a search need not go on with."""

from types import SimpleNamespace
from typing import Any

import pytest

from bench.diagnosis.discovery import with_laws


def test_a_table_that_is_not_in_the_best_set_is_searched_no_further(monkeypatch: pytest.MonkeyPatch):
    table: Any = SimpleNamespace(name="measured_left", instances=())
    base_model: Any = SimpleNamespace(start=SimpleNamespace(effects=()), with_instances=lambda _: "model")
    last = SimpleNamespace(proposals=[])
    finding: Any = SimpleNamespace(
        base_model=base_model, last=last, model=SimpleNamespace(effects=()), names=(), barred={}
    )
    left = SimpleNamespace(significant=True, much=True)
    plain = with_laws.AnswerWithLaws(finding, (), SimpleNamespace(unexplained=left))
    case: Any = SimpleNamespace(problem=SimpleNamespace(catalogue={}))
    monkeypatch.setattr(with_laws, "tabled_laws", lambda *_: [table])
    monkeypatch.setattr(with_laws, "_proposed", lambda *_: [])
    monkeypatch.setattr(with_laws, "round_from", lambda *_: SimpleNamespace(names={"coulomb_friction"}))
    monkeypatch.setattr(with_laws, "search_from", lambda *_: pytest.fail("nothing is to be searched"))
    assert with_laws._with_tables(case, plain, SimpleNamespace(phase=lambda _: None)) is plain
