"""Every code is rendered with every set of values that its type admits: no wording can cost an answer."""

import io
import json
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from rich.console import Console

from bench.basics.sentence import and_list, in_percent, or_list
from bench.cli.last_lines import after_diagnosis
from bench.diagnosis.as_json import diagnosis_json
from bench.diagnosis.dependence_words import from_run_to_run
from bench.diagnosis.law_words import law_sentences
from bench.diagnosis.reason import Because
from bench.diagnosis.reason_words import reason_sentence, unexplained_words
from bench.diagnosis.summary import reason, summary_of
from bench.document.markdown.tables import diagnosis_markdown, parameters_markdown, summary_markdown
from bench.document.terminal.diagnosis import diagnosis_report
from bench.document.terminal.identification import identification_report
from bench.effects import CATALOGUE
from bench.identification.finding import Code
from bench.identification.finding_words import note
from bench.identification.model_file import model_json
from bench.identification.wording import with_error
from bench.page.section_effects import ranking_section
from bench.page.section_run import limits_section
from bench.page.verdict import diagnosis_tiles, diagnosis_verdict, identification_tiles
from tests.any_values import (
    DATASET,
    EXAMPLE,
    ODD,
    diagnoses,
    differing_at,
    findings_of,
    identifications,
    laws,
    left,
    names,
    numbers,
    often,
    rarely,
    reasons_of,
    sizes,
    some,
    verdicts_at,
)


@often
@given(numbers, sizes, some(names))
def test_numbers_and_lists(value, std, some_names):
    assert with_error(value, std)
    assert all((in_percent(value), in_percent(None), and_list(some_names), or_list(some_names)))


@pytest.mark.parametrize("code", list(Code))
@rarely
@given(data=st.data())
def test_findings(code, data):
    said = note(data.draw(findings_of(code)))
    assert said


@pytest.mark.parametrize("because", list(Because))
@rarely
@given(data=st.data())
def test_reasons(because, data):
    verdict = data.draw(verdicts_at(ODD, reasons_of(because)))
    assert reason_sentence(verdict).endswith(".")


@often
@given(left)
def test_what_is_left(unexplained):
    assert unexplained_words(unexplained)


@often
@given(st.lists(laws, max_size=3))
def test_laws(discovered):
    assert len(law_sentences(discovered)) == len({law.law for law in discovered})


@often
@given(st.lists(differing_at(ODD), max_size=3).map(tuple), st.booleans())
def test_what_differs(differs, clear):
    said = from_run_to_run(differs, [each.request for each in differs[:1]], clear=clear)
    assert bool(said) == bool(differs)


@rarely
@given(identifications(EXAMPLE))
def test_identifications(result):
    json.dumps(model_json(result, DATASET.folder), allow_nan=False)
    identification_report(result, Console(file=io.StringIO(), width=80), verbose=True)
    summary_markdown(result)
    parameters_markdown(result)
    identification_tiles(result, 0.0)


@rarely
@given(diagnoses(EXAMPLE))
def test_diagnoses(diagnosis):
    assert summary_of(diagnosis).sentences
    assert all(reason(diagnosis, verdict) for verdict in diagnosis.ranking)
    json.dumps(diagnosis_json(diagnosis), allow_nan=False)
    diagnosis_report(diagnosis, Console(file=io.StringIO(), width=80), verbose=True)
    diagnosis_markdown(diagnosis)
    diagnosis_verdict(diagnosis)
    diagnosis_tiles(diagnosis)
    ranking_section(diagnosis, CATALOGUE)
    limits_section(diagnosis.after, diagnosis, DATASET, EXAMPLE.settings)
    after_diagnosis(diagnosis, Path("data set"), "bench diagnose", Path("model.json"))
