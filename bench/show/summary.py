"""An identification as Markdown, for the viewer's text panels."""

from collections.abc import Sequence

from bench.estimate.result import Identification, Quantity, relative_error
from bench.show.numbers import (
    GIVEN,
    USES,
    Truth,
    deviations_away,
    effect_key,
    flat_effects,
    gain_change,
    is_poor,
    percent,
    pretty_unit,
    relative_error_to,
    settings_lines,
    value_and_deviation,
)


def summary_markdown(result: Identification, truth: Truth | None = None) -> str:
    """Gains, errors, notes and settings: what to look at first."""
    joints = list(result.drive_gains)
    kept = "" if result.gains_fitted else " (nominal: not fitted)"
    parts = [_title(result), f"### Drive gains{kept}"]
    gains = [
        [
            joint,
            *_cells(gain),
            f"{gain.nominal:.6g}",
            percent(gain_change(gain), signed=True),
            *_truth_cells(gain, truth, joint),
        ]
        for joint, gain in result.drive_gains.items()
    ]
    headers = ["joint", "value", "unit", "rel. std", "nominal", "change"]
    parts.append(markdown_table(headers + _truth_headers(truth), gains))
    if result.effect_parameters:
        parts += ["### Effects", effects_markdown(result, truth)]
    parts += ["### Error of the modelled current", _errors(result, joints)]
    if result.notes:
        parts += ["### Notes", "\n".join(f"- {note}" for note in result.notes)]
    parts += ["### Fit", "\n".join(f"- {line}" for line in settings_lines(result))]
    return "\n\n".join(parts) + "\n"


def parameters_markdown(result: Identification, truth: Truth | None = None) -> str:
    """Every base and payload parameter with its grouping in full."""
    rows = [
        [f"**{one.name}**", *_cells(one), *_truth_cells(one, truth, one.name), one.grouping]
        for one in result.parameters
    ]
    headers = ["parameter", "value", "unit", "rel. std", *_truth_headers(truth), "stands for"]
    text = f"### Dynamic parameters\n\n{markdown_table(headers, rows)}\n"
    if result.left_out:
        text += f"\nLeft out, as the data do not need them: {', '.join(result.left_out)}.\n"
    return text


def effects_markdown(result: Identification, truth: Truth | None = None) -> str:
    """Parameters of the physical effects, a row each."""
    rows = [
        [effect, joint, name, *_cells(one), *_truth_cells(one, truth, effect_key(effect, joint, name))]
        for effect, joint, name, one in flat_effects(result)
    ]
    return markdown_table(
        ["effect", "joint", "parameter", "value", "unit", "rel. std", *_truth_headers(truth)], rows
    )


def _title(result: Identification) -> str:
    effects = ", ".join(result.effects) if result.effects else "rigid bodies only"
    return f"**{result.robot}**, estimator *{result.method}*, {effects}"


def _errors(result: Identification, joints: Sequence[str]) -> str:
    groups = [(one.name, USES[one.use], one.payload or "–", [one]) for one in result.recordings]
    for use, name in USES.items():
        chosen = [one for one in result.recordings if one.use == use]
        if len(chosen) > 1:
            groups.append((f"**all {name}**", "", "", chosen))
    rows = [
        [name, use, payload]
        + [percent(relative_error(chosen, j)) for j in range(len(joints))]
        + [percent(relative_error(chosen))]
        for name, use, payload, chosen in groups
    ]
    return markdown_table(["recording", "use", "payload", *joints, "all"], rows)


def _cells(quantity: Quantity) -> list[str]:
    value, std = value_and_deviation(quantity.value, quantity.std)
    text = value if std == GIVEN else f"{value} ± {std}"
    relative = percent(quantity.relative_std) if quantity.std else "–"
    return [text, pretty_unit(quantity.unit), f"**! {relative}**" if is_poor(quantity) else relative]


def _truth_headers(truth: Truth | None) -> list[str]:
    return ["truth", "off by", "in std"] if truth else []


def _truth_cells(quantity: Quantity, truth: Truth | None, key: str) -> list[str]:
    if not truth:
        return []
    if key not in truth:
        return ["", "", ""]
    text = value_and_deviation(truth[key], quantity.std)[0]
    return [text, relative_error_to(quantity, truth[key]), deviations_away(quantity, truth[key])]


def markdown_table(headers: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """A table in Markdown; a bar in a cell stays a bar."""
    lines = [headers, ["---"] * len(headers), *rows]
    return "\n".join("| " + " | ".join(cell.replace("|", "\\|") for cell in line) + " |" for line in lines)
