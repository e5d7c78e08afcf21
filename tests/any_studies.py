"""Strategies: whatever a check, a comparison, a plan or a replay may say."""

from dataclasses import asdict
from string import Formatter
from types import SimpleNamespace
from typing import Any, get_args, get_type_hints, is_typeddict

from hypothesis import strategies as st

from bench.excitation.discrimination.result import Discrimination, ImpossibleSign, MotionFacts
from bench.excitation.experiment.forecast import Enough, Expected, Forecast
from bench.excitation.experiment.open_limits import Kept
from bench.excitation.experiment.proof import Unproven
from bench.export.replay.causes import Contacts, PossibleBodies, SoftLoops
from bench.identification.finding import Code
from bench.residuals.look_alikes import QUESTION, LookAlike
from bench.residuals.opposing_motion import Change, Opposing
from bench.residuals.periods import SpectralLine
from bench.residuals.profile import VARIABLES, Dependence
from bench.residuals.regions import Concentration, RegionKind, RegionPlace
from bench.residuals.residuals import MotorErrors, WhereItFails
from bench.robot_check.contacts import GeomPair
from bench.robot_check.outcome import Check, CheckCode
from bench.robot_check.report import Amplification, Singularity
from bench.robot_check.words import DERIVED, TERMS, WORDS
from tests.any_values import effects, errors, findings, findings_of, names, numbers, sizes, some, units

few = some(names)

# --- where a model fails ------------------------------------------------------------------------------------

_BOUNDS = {RegionKind.MIDDLE_POSITION: 2}
_BOUNDED = ("LOW", "HIGH", "MIDDLE")
places = st.sampled_from(list(RegionKind)).flatmap(
    lambda part: st.builds(
        RegionPlace,
        st.just(part),
        st.tuples(*[numbers] * (_BOUNDS.get(part, 1) if part.name.startswith(_BOUNDED) else 0)),
        units,
        names,
    )
)
_opposing = st.builds(Opposing, names, names, numbers, sizes, errors)
_positive = sizes.filter(lambda value: value > 0.0)
motors = st.builds(
    MotorErrors,
    joint=names,
    units=st.tuples(st.sampled_from(["A", "V", "N*m"]), st.sampled_from(["rad", "m"])),
    error=sizes,
    noise=sizes,
    by_recording=st.dictionaries(names, st.tuples(sizes, sizes), max_size=2),
    autocorrelation_time=sizes,
    above_noise=st.booleans(),
    concentrations=some(
        st.builds(Concentration, names, places, sizes, sizes, numbers, st.booleans()), most=2
    ),
    dependences=some(
        st.builds(
            Dependence,
            names,
            st.sampled_from(VARIABLES),
            numbers,
            numbers,
            numbers,
            numbers,
            numbers,
            st.booleans(),
        ),
        most=2,
    ),
    lines=some(
        st.builds(
            SpectralLine, names, st.sampled_from(["time", "position"]), _positive, numbers, sizes, _positive
        ),
        most=2,
    ),
    changes=some(st.builds(Change, st.sampled_from(["warm-up", "load"]), _opposing, _opposing), most=2),
    warm_up=st.tuples(_opposing, _opposing),
    by_load=some(_opposing, most=2),
    alike=some(st.builds(LookAlike, st.sampled_from(list(QUESTION)), some(effects, 0, 6)), most=2),
)
failures = st.builds(WhereItFails, names, st.lists(motors, max_size=2).map(tuple))

# --- checks of a robot: the values of a code are the arguments of its sentence ------------------------------

_OF_TYPE: dict[Any, st.SearchStrategy[Any]] = {
    float: numbers,
    int: st.integers(0, 99),
    str: names,
    bool: st.booleans(),
    Any: names,
}


def _of_type(kind: Any) -> st.SearchStrategy[Any]:
    if kind in _OF_TYPE:
        return _OF_TYPE[kind]
    if is_typeddict(kind):
        return st.fixed_dictionaries(
            {field: _of_type(value) for field, value in get_type_hints(kind).items()}
        )
    arguments = get_args(kind)
    if type(None) in arguments:
        return st.none() | _of_type(arguments[0])
    if len(arguments) == 2:  # a mapping
        return st.dictionaries(_of_type(arguments[0]), _of_type(arguments[1]), max_size=3)
    return st.lists(_of_type(arguments[0]), max_size=3)


_DERIVED_FROM: dict[str | None, dict[str, Any]] = {
    "agree": {"difference": float},
    "few_joints": {"joints": list[str]},
    "few_keyframes": {"keyframes": list[str]},
    "source": {"given": int | None, "positions": int},
    "closing": {"closed_qpos": list[float]},
    "why_open": {"fixed_gaps": dict[str, list[float]]},
    "at": {"positions": dict[str, float], "units": dict[str, str]},
}


def _of_template(words: str) -> dict[str, Any]:
    """The types of a template's values: numbers have a format, lists of names one of words."""
    fields = [(field, spec) for _, field, spec, _ in Formatter().parse(words) if field is not None]
    named = {"quoted": list[str], "": str, "# joint": int, "# force": int}
    hints = {field: named.get(spec, float) for field, spec in fields if field not in DERIVED}
    if "bodies" in hints:
        hints["bodies"] = list[str]
    for field, _ in fields:
        hints |= _DERIVED_FROM.get(field, {})
    return hints


_two = st.tuples(names, names)
geom_pairs = st.builds(GeomPair, _two, _two, _two, st.booleans())


def checks_of(code: CheckCode) -> st.SearchStrategy[Check]:
    words = WORDS[code]
    hints = _of_template(words) if isinstance(words, str) else get_type_hints(words[1])
    hints.pop("return", None)
    values = {
        each: _of_type(kind)
        for each, kind in hints.items()
        if each != "joints" or code is not CheckCode.JOINTS_LOCKED
    }
    if "pairs" in values:
        values["pairs"] = st.lists(geom_pairs.map(asdict), min_size=1, max_size=6)
    if "term" in values:
        values["term"] = st.sampled_from(sorted(TERMS))
    if code is CheckCode.JOINTS_LOCKED:
        held = st.fixed_dictionaries({"value": numbers, "unit": st.sampled_from(["rad", "m"])})
        values["joints"] = st.dictionaries(names, held, max_size=3)
    return st.builds(Check, st.just(code), st.just("note"), st.fixed_dictionaries(values))


_error = sizes | st.just(float("inf"))
causes = st.one_of(
    st.builds(Contacts, st.lists(geom_pairs, min_size=1, max_size=6).map(tuple), _error),
    st.builds(SoftLoops, sizes, st.tuples(sizes, sizes), st.tuples(sizes, sizes, sizes), _error),
    st.builds(PossibleBodies, sizes, sizes),
)

_at = st.dictionaries(names, numbers, max_size=2)
singularities = st.builds(
    Singularity,
    numbers,
    numbers,
    st.builds(
        Amplification, **{name: _of_type(kind) for name, kind in get_type_hints(Amplification).items()}
    ),
    st.integers(0, 9),
    numbers,
    _at,
    st.just({}),
    st.none() | _at,
    st.none() | _at,
    some(names, 0, 6),
)

# --- experiments --------------------------------------------------------------------------------------------

_expected = st.builds(
    Expected,
    names,
    st.sampled_from(["gain", "parameter", "payload", "effect"]),
    units,
    numbers,
    errors,
    _positive,
)
enough = st.builds(Enough, sizes, errors, errors, errors)
forecasts = st.builds(
    Forecast,
    st.lists(_expected, min_size=1, max_size=4).map(tuple),
    some(some(names, 1, 3), most=2),
    st.booleans(),
    st.none() | enough,
)
unproven = st.builds(
    Unproven, st.sampled_from(list(Kept)), st.just("") | names, errors, st.booleans(), st.just("") | names
)


def plans_of(told: Forecast) -> st.SearchStrategy[Any]:
    """What a plan's sentences look at, of a plan with these unknowns."""
    built = st.builds
    array = SimpleNamespace
    proof = built(array, given_way=some(unproven, most=1))
    recordings = st.lists(st.tuples(names, proof), min_size=1, max_size=2)
    noise = built(
        array,
        current=st.none() | st.just(1.0),
        ratio=sizes,
        recorded=st.booleans(),
        encoder=built(array, any=st.booleans().map(lambda value: lambda: value)),
        rate=sizes,
    )
    return recordings.flatmap(
        lambda some_recordings: built(
            array,
            aim=built(array, criterion=st.sampled_from(["worst", "d-optimal"])),
            targets=some(st.sampled_from(range(len(told.unknowns))), 1),
            value=sizes,
            random=st.just({}) | st.fixed_dictionaries({"median": sizes, "best": sizes}),
            before=errors,
            search=built(array, loads=st.lists(st.none() | names, min_size=1, max_size=2)),
            room=built(array, assumed=few, unranged=few, boxes=few, torque=sizes),
            nominal=built(
                array,
                noise=noise,
                source=names,
                gains_fitted=st.booleans(),
                scale=st.none() | findings_of(Code.GAINS_NOT_FIXED),
                doubts=st.just(()) | st.tuples(findings),
                model=built(array, geometry=built(array, closed=st.booleans())),
            ),
            names=st.just(tuple(name for name, _ in some_recordings)),
            proofs=st.just(tuple(each for _, each in some_recordings)),
            recordings=st.just(
                tuple(
                    SimpleNamespace(name=name, use="validate", proven=each) for name, each in some_recordings
                )
            ),
        )
    )


# --- telling two effects apart ------------------------------------------------------------------------------

_requests = st.sampled_from(["viscous_friction", "current_delay:left", "mine", "coulomb_friction:a b"])
_facts = st.builds(MotionFacts, numbers, numbers, sizes, sizes, sizes, sizes)
_answer = st.builds(SimpleNamespace, nats=sizes, autocorrelation_time=_positive, count=st.integers(1, 9))


def _question(request: str) -> st.SearchStrategy[Any]:
    recording = st.builds(SimpleNamespace, payload=st.none() | names)
    measured = st.lists(st.builds(SimpleNamespace, recording=recording), max_size=2)
    prepared = st.builds(SimpleNamespace, measured=measured)
    truth = st.builds(SimpleNamespace, request=st.just(request), prepared=prepared)
    return st.builds(SimpleNamespace, truth=truth, given_nats=sizes)


@st.composite
def discriminations(draw: Any) -> Discrimination:
    pair = draw(some(_requests, 2, 2))
    asked = draw(some(st.sampled_from(pair), 0, 2))
    questions = tuple(draw(_question(request)) for request in asked)
    motion = draw(
        st.none()
        | st.builds(
            SimpleNamespace,
            trajectory=st.builds(SimpleNamespace, duration=sizes),
            payload=st.none() | names,
            answers=st.tuples(*[_answer] * len(questions)),
        )
    )
    joints = {joint: draw(st.sampled_from(["N*m/A", "N/A"])) for joint in draw(some(names, 1, 2))}
    facts = st.fixed_dictionaries(dict.fromkeys(joints, _facts))
    return Discrimination(
        robot=draw(names),
        effects=pair,
        error_over_noise=draw(sizes),
        shown=draw(st.dictionaries(st.sampled_from(pair), numbers, max_size=2)),
        nothing=draw(st.booleans()),
        joints=joints,
        absorbed=tuple(name for name in pair if name not in asked),
        imitated=draw(some(st.sampled_from(pair), 0, 1)),
        questions=questions,
        given_seconds=draw(sizes),
        held_out_rows=draw(st.integers(0, 9)),
        motion=motion,
        recorded=draw(facts),
        planned=draw(facts),
        second=draw(st.none() | st.tuples(sizes, sizes)),
        wider=draw(st.none() | st.tuples(sizes, sizes)),
        impossible=draw(some(st.builds(ImpossibleSign, effects, names, st.just("") | names), most=2)),
    )
