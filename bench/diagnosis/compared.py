"""What differs from recording to recording, in the model that a search has identified."""

from dataclasses import replace

from bench.diagnosis.differs import differing
from bench.diagnosis.search_result import SearchResult
from bench.diagnosis.split_problem import SplitProblem
from bench.diagnosis.values_by_log import with_common_values


def compared(case: SplitProblem, finding: SearchResult) -> SearchResult:
    """With the effects that differ by recording in the identified model, or would differ, and the answer with these."""
    model = with_common_values(finding.model, case.start.effects)
    differs, differently = differing(model, case.problem.catalogue)
    return replace(finding, compared=True, differs=differs, differently=differently)
