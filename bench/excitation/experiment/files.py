"""The experiment as files: for the controller, for a simulation, and for people."""

from collections.abc import Callable, Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from bench.basics.files.atomic import write_json_atomically, write_text_atomically
from bench.basics.files.toml_output import toml_header, toml_line
from bench.basics.plain_data import finite
from bench.basics.sentence import in_percent
from bench.dataset.catalogue import built_in_robots
from bench.dataset.payload import Payload
from bench.dataset.recording import write_table
from bench.excitation.bounds import FORECAST
from bench.excitation.discrimination.files import trajectory_table, written_whole
from bench.excitation.experiment.between_samples import extremes
from bench.excitation.experiment.forecast import Forecast
from bench.excitation.experiment.plan import ExperimentPlan
from bench.excitation.experiment.sentences import sentences
from bench.excitation.experiment.simulated import FIRST, SimulatedDrive
from bench.scenario.trajectory import FourierTrajectory

ANSWER, SCENARIO, SUMMARY, PICTURE, VIEW = (
    "answer.json",
    "scenario.toml",
    "README.md",
    "motions.png",
    "motions.rrd",
)

MARKS = (ANSWER, SCENARIO)  # without which a folder is not one of a plan
Draw = Callable[[Path, ExperimentPlan], None]


def write_plan(
    folder: str | Path,
    plan: ExperimentPlan,
    forecast: Forecast,
    drawn: Mapping[str, Draw],
    drive: SimulatedDrive = FIRST,
) -> list[Path]:
    """Write the folder completely or not at all, and return its files; replaces one of an earlier call.

    drawn: writers of pictures and recordings by file name. drive: of the scenario. Raises BenchError if the folder has
    other content, or cannot be written.
    """

    def write(partial: Path) -> None:
        for recording in plan.recordings:
            table = trajectory_table(recording.trajectory, list(plan.robot.joints), plan.nominal.noise.rate)
            write_table(partial / f"{recording.name}.csv", table)
            write_text_atomically(
                partial / f"{recording.name}.toml", _coefficients(plan, recording.trajectory)
            )
        write_text_atomically(partial / SCENARIO, scenario_text(plan, drive))
        for file, draw in drawn.items():
            draw(partial / file, plan)
        write_text_atomically(partial / SUMMARY, _readme(plan, forecast, tuple(drawn)))
        write_json_atomically(partial / ANSWER, plan_json(plan, forecast))

    return written_whole(folder, MARKS, write)


def plan_json(plan: ExperimentPlan, forecast: Forecast) -> dict[str, Any]:
    """The answer as plain data, ready for JSON."""
    answer = {
        "robot": plan.robot.name,
        "for": list(plan.aim.wanted),
        "criterion": plan.aim.criterion,
        "value": plan.value,
        "random": dict(plan.random),
        "before": plan.before,
        "seed": plan.aim.seed,
        "steps": plan.aim.steps,
        "unknowns": [
            {
                "name": expected.name,
                "kind": expected.kind,
                "unit": expected.unit,
                "nominal": expected.value,
                "std": expected.std,
                "relative_to": expected.size,
                "grouping": expected.grouping,
                "aimed_at": i in plan.targets,
            }
            for i, expected in enumerate(forecast.unknowns)
        ],
        "undetermined": [list(names) for names in forecast.together],
        "gain_accuracy": None
        if (enough := forecast.enough) is None
        else {
            "asked": enough.accuracy,
            **{key: getattr(enough, key) for key in ("expected", "seconds", "mass")},
        },
        "assumed": list(plan.room.assumed),
        "reach": {recording.name: _limits(plan, recording.trajectory) for recording in plan.recordings},
        "proofs": {
            recording.name: {
                **asdict(recording.proven.proof),
                "given_way": [asdict(unproven) for unproven in recording.proven.given_way],
            }
            for recording in plan.recordings
        },
        "recordings": {
            recording.name: {
                "use": recording.use,
                "payload": recording.payload,
                "trajectory": recording.trajectory.to_dict(),
            }
            for recording in plan.recordings
        },
        "summary": sentences(plan, forecast),
    }
    return dict(finite(answer))


def _limits(plan: ExperimentPlan, trajectory: FourierTrajectory) -> dict[str, Any]:
    """Proven maxima of a motion, also between samples, with their limits, by joint."""
    reach, room = extremes(trajectory), plan.room
    return {
        joint: {
            "position": [float(reach.low[j]), float(reach.high[j])],
            "position_limit": [float(room.joint.low[j]), float(room.joint.high[j])],
            "velocity": float(reach.velocity[j]),
            "velocity_limit": float(room.velocity[j]),
            "acceleration": float(reach.acceleration[j]),
            "acceleration_limit": float(room.acceleration[j]),
            "torque_limit": float(room.torque[j]),
        }
        for j, joint in enumerate(plan.robot.joints)
    }


def _coefficients(plan: ExperimentPlan, trajectory: FourierTrajectory) -> str:
    lines = [
        f"# Joints: {', '.join(plan.robot.joints)}.",
        "# q(t) = center + s(t) sum_k (a_k sin k w t + b_k cos k w t) with w = 2 pi base_frequency;",
        "# s rises in the first `ramp` seconds as 35x^4 - 84x^5 + 70x^6 - 20x^7 and falls in the last.",
    ]
    lines += [toml_line(key, value) for key, value in trajectory.to_dict().items()]
    return "\n".join(lines) + "\n"


def scenario_text(plan: ExperimentPlan, drive: SimulatedDrive = FIRST) -> str:
    """A scenario for `bench simulate`: the motions to fit and those to judge on, of a machine with this drive."""
    robot = plan.robot
    reference = robot.name if built_in_robots().get(robot.name) == robot.folder else str(robot.folder)
    lines = [
        toml_line("description", f"Planned by bench excite for {robot.name}"),
        toml_line("robot", reference),
        toml_line("seed", plan.aim.seed),
        toml_line("log_rate", plan.nominal.noise.rate),
        toml_line("step", drive.step_at(plan.nominal.noise.rate)),
        "",
        "[controller]  # stiff, so that the motion is the planned one",
        toml_line("natural_frequency", drive.natural_frequency),
        toml_line("feedforward", "acceleration"),
        "",
        "[sensors]",
        *_sensors(plan),
    ]
    for name, payload in plan.nominal.payloads.items():
        if name not in plan.search.loads:
            continue
        lines += ["", toml_header("payloads", name), *_payload(payload)]
    for recording in plan.recordings:
        lines += ["", "[[recordings]]", toml_line("name", recording.name), toml_line("use", recording.use)]
        lines += [] if recording.payload is None else [toml_line("payload", recording.payload)]
        lines.append(toml_line("trajectory_file", f"{recording.name}.toml"))
    return "\n".join(lines) + "\n"


def _sensors(plan: ExperimentPlan) -> list[str]:
    noise, joints = plan.nominal.noise, plan.robot.joints

    def by_joint(values: np.ndarray) -> dict[str, float]:
        return dict(zip(joints, values.tolist(), strict=True))

    lines = (
        [toml_line("current_noise_ratio", noise.ratio)]
        if noise.current is None
        else [toml_line("current_noise", by_joint(noise.current))]
    )
    if noise.encoder.any():
        lines.append(toml_line("encoder_resolution", by_joint(noise.encoder)))
    return lines


def _payload(payload: Payload) -> list[str]:
    """The declaration of a payload; if its centre is unknown, the simulated one is a point at the tool."""
    known = {key: getattr(payload, key) for key in ("mass", "center_of_mass")}
    known = {key: np.array(value).tolist() for key, value in known.items() if value is not None}
    lines = [toml_line(key, value) for key, value in known.items()]
    if payload.inertia is not None:
        lines.append(toml_line("inertia", payload.inertia.tolist()))
    if payload.center_of_mass is None or payload.inertia is None:
        lines.append(toml_line("declared", known))
    return lines


def _readme(plan: ExperimentPlan, forecast: Forecast, drawn: tuple[str, ...]) -> str:
    lines = [f"# {plan.robot.name}: motions to identify it with", ""]
    lines += [f"- {sentence}" for sentence in sentences(plan, forecast)]
    lines += [f"\n![The motions]({PICTURE})"] if PICTURE in drawn else []
    lines += ["", "| unknown | nominal | standard error | of its size |", "|---|---:|---:|---:|"]
    for expected in forecast.unknowns:
        value = "" if np.isnan(expected.value) else f"{expected.value:.4g}"
        std = "undetermined" if expected.std is None else f"{expected.std:.2g} {expected.unit}"
        share = "" if expected.std is None else in_percent(expected.relative, 2)
        lines.append(f"| {expected.name} | {value} | {std} | {share} |")
    least = in_percent(FORECAST.smallest_size, 2)
    lines += ["", f"Of its size: of the nominal value, or of {least} of the largest with that unit."]
    robot = plan.robot.name if plan.robot.name in built_in_robots() else "ROBOT"
    lines += ["", "## Record it", ""]
    lines.append(
        "Let the robot go home, then run each table (s; rad or m and rates) and log positions and currents."
    )
    lines += ["", "```sh"]
    for recording in plan.recordings:
        name, load = recording.name, recording.payload
        mass = None if load is None else plan.nominal.payloads[load].mass
        use = "" if recording.use == "identify" else f" --use {recording.use}"
        carried = "" if load is None else f" --payload {load} --payload-mass {mass!r}"
        lines.append(
            f"bench import log_{name}.csv --robot {robot} -o DATASET --name {name}.csv{use}{carried}"
        )
    lines += [
        "bench identify DATASET",
        "```",
        "",
        f"First in simulation: `bench simulate {SCENARIO} -o DATASET`.",
    ]
    return "\n".join(lines) + "\n"
