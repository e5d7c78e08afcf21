"""Strategies: whatever value the types of an answer admit, the strange ones most often."""

import math
import sys
from dataclasses import replace
from typing import get_args

from hypothesis import HealthCheck, Phase, settings
from hypothesis import strategies as st

from bench.dataset.robot import load_robot
from bench.diagnosis.reason import Because, Doubt, Reason
from bench.diagnosis.result import (
    Diagnosis,
    Differing,
    Discovered,
    EffectVerdict,
    LadderStep,
    LawTerm,
    LooksAt,
    Remainder,
    Role,
    Superfluous,
    Unexplained,
    Unfinished,
    Verdict,
)
from bench.effects import CATALOGUE
from bench.identification.finding import Code, Finding, Unknown
from bench.identification.result import DriveGain, ErrorSummary, Parameter, Quantity
from bench.identification.scale import ScaleRemedy
from tests.shown import dataset_of, identification_of

often = settings(
    max_examples=60,
    derandomize=True,
    database=None,
    deadline=None,
    phases=(Phase.generate,),  # what fails is short enough as it is
    suppress_health_check=list(HealthCheck),
)
rarely = settings(often, max_examples=20)

DATASET = dataset_of(load_robot("five_bar"), duration=0.5)
EXAMPLE = identification_of(DATASET, effects=True)
"""Made by hand; what is drawn replaces its numbers."""

STRANGE = (0.0, -0.0, 5e-324, 1e-9, 0.0996, 1.0, -3.2, 1e3, sys.float_info.max, math.inf, -math.inf, math.nan)
ODD = (
    "left",
    "motor_1",
    "joint.x-1",
    "{}",
    "%s",
    "a b",
    "[bold]",
    "[/b]",
    "<i>&",
    "ß°→",
    "@",
    "x:y",
    "0",
    "\\",
    "'\"",
)

numbers = st.sampled_from(STRANGE) | st.floats()
sizes = st.sampled_from([value for value in STRANGE if not value < 0.0]) | st.floats(min_value=0.0)
names = st.sampled_from(ODD)
units = st.sampled_from(["N*m/A", "N/A", "N*m/V", "1", "A", "V", "kg*m^2", "N*m*s^2/rad", "m", "rad", ""])
effects = st.sampled_from(sorted(CATALOGUE)) | st.sampled_from(
    ["mine", "constant_offset:left@recording", "a_b"]
)
errors = st.none() | sizes
nominal = st.sampled_from([1e-9, 3.0, 1e9])  # a robot's file has no gain that is not positive
shares = st.floats(0.0, 1.0)
quantities = st.builds(Quantity, numbers, sizes, units)


def some(entries, least=0, most=4):
    return st.lists(entries, min_size=least, max_size=most, unique=True).map(tuple)


unknowns = st.builds(Unknown, st.sampled_from(["parameter", "gain", "effect"]), names, names, effects)

# --- findings: what each code carries ---------------------------------------------------------------------

_NONE = st.just(())
_ONE, _TWO = some(names, 1, 1), some(names, 2, 2)
_SOME = some(names, 1)
_REMEDIES = st.dictionaries(  # how many gains each set of remedies would fix
    some(st.sampled_from(list(ScaleRemedy)), 1).map("+".join), st.integers(0, 9).map(float)
)
_CARRIES = {  # names, numbers, whether it is of unknowns
    Code.GAIN_RUNAWAY: (_ONE, "value nominal", False),
    Code.PARAMETER_WITHOUT_DEVIATION: (_NONE, "value", True),
    Code.ROUNDING_DECIDES: (_NONE, "condition", False),
    Code.NOISE_DECIDES: (_ONE, "share other value", False),
    Code.UNITS_UNLIKE: (some(names, 2), "times", False),
    Code.CURRENT_REVERSED: (some(names, 1, 2), "before after", False),
    Code.POSITION_REVERSED: (_ONE, "before after current", False),
    Code.POSITIONS_SWAPPED: (_TWO, "before after current", False),
    Code.LOAD_UNDECLARED: (_ONE, "before after mass", False),
    Code.TIME_BASE: (_SOME, "factor step true", False),
    Code.COLUMNS_SWAPPED: (some(names, 2, 3), "error", False),
    Code.OTHER_LOAD: (
        st.tuples(names, names, st.just("") | names, st.just("") | names),
        "before after",
        False,
    ),
    Code.GAINS_ASSUMED_EQUAL: (_ONE, "drift move", False),
    Code.LOADS_EXCHANGED: (st.tuples(names, st.just("") | names), "", False),
    Code.PAYLOAD_HEAVY: (_ONE, "mass own", False),
    Code.NOT_REAL: (_ONE, "distance expected", False),
    Code.NOT_FROM_GAIN: (_NONE, "", True),
    Code.NOISE_LET_THROUGH: (_ONE, "share other value", False),
    Code.PAYLOAD_NOT_DECLARED: (_SOME, "", False),
    Code.GAINS_NOMINAL: (_NONE, "", False),
    Code.REDUNDANT: (_SOME, "", False),
    Code.RANK_DEFICIENT: (_NONE, "rank unknowns", False),
    Code.ILL_CONDITIONED: (_NONE, "condition", False),
    Code.TAKEN_UP: (_NONE, "", True),
    Code.HARDLY_APART: (_NONE, "wider", True),
    Code.NOT_SETTLED: (_NONE, "", True),
    Code.PERIODS_NOT_WHOLE: (st.tuples(effects, names), "periods std", False),
    Code.ROWS_REPEATED: (_SOME, "share", False),
    Code.BAND_NARROWED: (_NONE, "band rejected decimation", False),
    Code.BAND_MATTERS: (_NONE, "band decimation", False),
    Code.BAND_UNCHECKED: (_NONE, "band", False),
    Code.EXTRAPOLATED: (_NONE, "share", False),
    Code.JUDGED_BEYOND: (_SOME, "", False),
    Code.GAINS_A_THOUSAND: (_NONE, "", False),
    Code.GAINS_A_THOUSANDTH: (_NONE, "", False),
    Code.GAINS_ALIKE: (_SOME, "least most mass likely", True),
    Code.NO_MODEL_IS_BETTER: (_NONE, "error", False),
    Code.SIGN_REVERSED: (_ONE, "", False),
    Code.GAIN_NEGATIVE: (_ONE, "", False),
    Code.GAIN_FAR: (_ONE, "value nominal", False),
    Code.GAINS_NEGATIVE: (_NONE, "", False),
    Code.CLOSURE_CONTRADICTED: (_TWO, "difference mean travel", False),
    Code.VELOCITY_UNLIKE: (_TWO, "count off scale delay", False),
    Code.CHECKED_UNLIKE_FITTED: (some(names, 1, 2), "checked fitted", False),
    Code.CHECKED_HAS_OTHER_VALUES: (some(names, 1, 3), "checked fitted", False),
    Code.MOUNTED_OTHERWISE: (some(names, 4, 4), "first first_std second second_std", False),
    Code.PAYLOAD_IMPOSSIBLE: (_ONE, "least std", False),
    Code.PAYLOAD_TAKEN_AS_POINT: (_ONE, "least std", False),
    Code.PHYSICAL: (_NONE, "distance expected", False),
    Code.VELOCITY_TAKEN: (_SOME, "quieter", False),
    Code.STANDS_STILL: (_ONE, "", False),
    Code.NEVER_REVERSES: (_ONE, "", False),
    Code.POORLY_DETERMINED: (_NONE, "count of limit", False),
    Code.SHORT: (_SOME, "shortest cutoff settling needed", False),
    Code.BAD_STRETCH: (_TWO, "start end", False),
    Code.NO_VALUE_OF_ITS_OWN: (_SOME, "", True),
    Code.TOLD: (_ONE, "", False),
    Code.GAIN_NOT_DETERMINED: (_NONE, "times", True),
    Code.GAINS_NOT_WANTED: (_SOME, "", False),
    Code.PAYLOAD_NOT_WEIGHED: (_SOME, _REMEDIES, True),
    Code.GAINS_NOT_FIXED: (_SOME, _REMEDIES, True),
    Code.GAINS_FIXED_FOR_SOME: (_SOME, _REMEDIES, True),
}


def findings_of(code: Code):
    if code is Code.LOCKED:
        return st.dictionaries(names, numbers, min_size=1).flatmap(
            lambda locked: st.builds(
                Finding, st.just(code), st.just(tuple(locked)), st.just(()), st.just(locked), units
            )
        )
    carried, numbered, of_unknowns = _CARRIES[code]
    if isinstance(numbered, str):
        numbered = st.fixed_dictionaries(dict.fromkeys(numbered.split(), numbers))
    return st.builds(
        Finding, st.just(code), carried, some(unknowns, 1) if of_unknowns else st.just(()), numbered, units
    )


findings = st.sampled_from(list(Code)).flatmap(findings_of)

# --- diagnoses ----------------------------------------------------------------------------------------------

_REASON_NAMES = {
    Because.TAKEN_UP: some(names, 0, 1),
    Because.IMPOSSIBLE: some(names, 1, 2),
    Because.CANCELS: some(names, 1, 1),
    Because.TOO_SHORT: some(names, 1, 1),
}


def reasons_of(because: Because):
    named = _REASON_NAMES.get(because, some(names, 0, 2))
    return st.builds(Reason, st.just(because), named, some(st.sampled_from(list(Doubt))))


reasons = st.sampled_from(list(Because)).flatmap(reasons_of)


def verdicts_at(joints, why=reasons):
    at = some(st.sampled_from(joints))
    return st.builds(
        EffectVerdict,
        effect=effects,
        verdict=st.sampled_from(get_args(Verdict)),
        error_before=sizes,
        error_after=sizes,
        evidence=numbers,
        actuators=at,
        alternatives=some(effects, 0, 6),
        size=at.flatmap(lambda joints: st.fixed_dictionaries(dict.fromkeys(joints, sizes))),
        why=why,
        probability=st.none() | shares,
        places=st.fixed_dictionaries(dict.fromkeys(joints, shares)),
    )


left = st.builds(
    Unexplained,
    st.sampled_from(list(Remainder)),
    sizes,
    sizes,
    some(st.sampled_from(["position", "velocity", "time", "payload"])),
    sizes,
    errors,
)

_KINDS = ["position", "velocity", "acceleration", "load", "time", "tool_speed", "others_load"]
_looks = st.builds(
    LooksAt, st.sampled_from(_KINDS), st.sampled_from(["", *ODD]), st.sampled_from(get_args(Role))
)
_FORMULAS = ["1", "sign(v)*abs(a)", "hat(q, 0.0, 0.1, 0.2)", "v**2", "cos(7*q_left)", ""]
_terms = st.builds(LawTerm, st.sampled_from(_FORMULAS), numbers, sizes, units, some(_looks, 0, 3))
laws = st.builds(
    Discovered,
    place=names,
    law=st.sampled_from(["law", "law_left", "measured_left"]),
    terms=st.lists(_terms, min_size=1, max_size=3).map(tuple),
    numbers=st.dictionaries(names, quantities, max_size=2),
    identify=errors,
    validate=errors,
    without=errors,
    named=st.none() | effects,
    nearest=st.none() | st.tuples(effects, sizes),
    source=st.just(""),
    file=st.none() | names,
)


def differing_at(joints):
    return st.builds(
        Differing,
        effect=effects,
        joint=st.sampled_from(joints),
        values=st.dictionaries(names, quantities, min_size=1, max_size=3),
        evidence=numbers,
        error_before=sizes,
        error_after=sizes,
    )


def identifications(example):
    """Answers like one that was made by hand, with any gains, parameters, errors and findings."""
    joints = example.joints
    gains = st.builds(DriveGain, numbers, sizes, st.sampled_from(["N*m/A", "N/A", "1"]), nominal)
    parameters = st.builds(Parameter, numbers, sizes, units, names, names)
    by_joint = st.fixed_dictionaries(dict.fromkeys(joints, sizes))
    return st.builds(
        lambda **changed: _replaced(example, changed),
        drive_gains=st.fixed_dictionaries(dict.fromkeys(joints, gains)),
        gains_fitted=st.booleans(),
        parameters=st.lists(parameters, max_size=3).map(tuple),
        effects=some(effects, 0, 2),
        effect_parameters=st.dictionaries(
            effects,
            st.dictionaries(
                st.sampled_from([*joints, "robot"]),
                st.dictionaries(names, quantities, max_size=2),
                max_size=2,
            ),
            max_size=2,
        ),
        error=st.builds(
            ErrorSummary,
            errors,
            errors,
            by_joint,
            by_joint,
            st.dictionaries(names, sizes, min_size=1, max_size=2),
        ),
        recordings=some(st.sampled_from(range(len(example.recordings)))).map(
            lambda kept: tuple(example.recordings[i] for i in kept)
        ),
        rank=st.integers(0, 9),
        unknowns=st.integers(0, 9),
        condition=sizes,
        scaled_condition=sizes,
        left_out=some(names),
        findings=st.lists(findings, max_size=3).map(tuple),
    )


def _replaced(example, changed):
    return replace(example, **changed)


def diagnoses(example):
    joints = example.joints
    identified = identifications(example)
    steps = st.builds(LadderStep, some(effects, 0, 3), errors, errors)

    def whole(ranking):
        return st.builds(
            Diagnosis,
            robot=names,
            held_out=sizes,
            missing=st.just(()) | some(st.sampled_from([verdict.effect for verdict in ranking]))
            if ranking
            else st.just(()),
            ladder=st.lists(steps, min_size=1, max_size=3).map(tuple),
            ranking=st.just(ranking),
            unexplained=left,
            before=identified,
            after=identified,
            differs=st.lists(differing_at(joints), max_size=2).map(tuple),
            superfluous=st.lists(st.builds(Superfluous, effects, st.none() | effects), max_size=2).map(tuple),
            discovered=st.lists(laws, max_size=2).map(tuple),
            unfinished=some(st.sampled_from(list(Unfinished)), most=5),
            something_else=shares,
        )

    ranking = st.lists(verdicts_at(joints), max_size=3, unique_by=lambda verdict: verdict.effect).map(tuple)
    return ranking.flatmap(whole)
