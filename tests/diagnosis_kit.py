"""A diagnosis made by hand."""

from dataclasses import replace

from bench.dataset.dataset import Dataset
from bench.diagnosis.reason import Because, Reason
from bench.diagnosis.result import Diagnosis, EffectVerdict, LadderStep, Remainder, Unexplained
from tests.shown import identification_of

VISCOUS = EffectVerdict(
    effect="viscous_friction",
    verdict="missing",
    error_before=0.1,
    error_after=0.01,
    evidence=812.4,
    actuators=("left",),
    alternatives=(),
    size={"left": 0.33},
    why=Reason(Because.EXPLAINS),
)
OTHERS = (
    replace(
        VISCOUS,
        effect="current_delay",
        verdict="indistinguishable",
        evidence=2.0,
        actuators=(),
        alternatives=("viscous_friction",),
        size={},
        why=Reason(Because.AS_GOOD),
    ),
    *(
        replace(
            VISCOUS,
            effect=name,
            verdict="not supported",
            evidence=-float(i),
            actuators=(),
            size={},
            why=Reason(Because.GAINS_NOTHING),
        )
        for i, name in enumerate(
            ("backlash", "base_tilt", "cogging_torque", "geometric_error", "joint_spring", "torque_ripple")
        )
    ),
    replace(
        VISCOUS,
        effect="rotor_inertia",
        verdict="absorbed",
        evidence=0.0,
        actuators=(),
        size={},
        why=Reason(Because.TAKEN_UP),
    ),
)
CLEAR = Unexplained(Remainder.NOISE, 0.01, 0.0098, ())


def found_diagnosis(dataset: Dataset) -> Diagnosis:
    """Viscous friction is missing at one motor of a five-bar."""
    before, after = identification_of(dataset), identification_of(dataset, effects=True)
    moved = {**after.drive_gains, "left": replace(after.drive_gains["left"], value=3.63)}
    return Diagnosis(
        robot="five_bar",
        held_out=0.0,
        missing=("viscous_friction",),
        ladder=(LadderStep((), 0.11, 0.12), LadderStep(("viscous_friction",), 0.0099, 0.01)),
        ranking=(VISCOUS, *OTHERS),
        unexplained=CLEAR,
        before=before,
        after=replace(after, drive_gains=moved),
    )
