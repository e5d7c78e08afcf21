"""Models side by side: tables of their errors and gains, and sentences on their differences."""

from bench.document.layout import TEXT
from bench.document.numbers import USES, change_between, percent, pretty_unit, quantity_text
from bench.document.table import Column, Table
from bench.effects.display_names import spoken
from bench.identification.result import DriveGain
from bench.residuals.side_by_side import ComparedModel, SideBySide, effect_places, interval, moved_parameters


def compared_errors_table(comparison: SideBySide) -> Table:
    """Errors: a row for each use, motor and recording, a column for each model."""
    first = comparison.models[0].model.error
    rows = [USES["identify"]] if first.identify is not None else []
    rows += [USES["validate"]] if first.validate is not None else []
    rows += [f"motor {joint}" for joint in first.by_actuator]
    rows += [f"motor {joint}, not fitted" for joint in first.by_actuator_validate]
    rows += list(first.by_recording)
    columns = [Column("error", rows)]
    for model in comparison.models:
        error = model.model.error
        cells = [error.identify] if first.identify is not None else []
        cells += [error.validate] if first.validate is not None else []
        for values in (error.by_actuator, error.by_actuator_validate, error.by_recording):
            cells += list(values.values())
        columns.append(Column(model.name, cells, "share"))
    uses = sum(value is not None for value in (first.identify, first.validate))
    return Table(tuple(columns), ends=(uses - 1,))


def compared_gains_table(comparison: SideBySide) -> Table:
    """Drive gains: a row for each motor, with its 95 % interval in every model."""
    gains = comparison.models[0].model.drive_gains
    columns = [
        Column(model.name, [_interval_text(model.model.drive_gains[joint]) for joint in gains])
        for model in comparison.models
    ]
    unit = Column("unit", [gain.unit for gain in gains.values()], "unit")
    return Table((Column("drive gain", list(gains)), *columns, unit))


def changed_sentences(comparison: SideBySide) -> list[str]:
    """How each further model differs from the first one: its effects, errors, gains, parameters and filters."""
    first, *others = comparison.models
    return [sentence for other in others for sentence in _changed(first, other)]


def _changed(first: ComparedModel, other: ComparedModel) -> list[str]:
    old, new = first.model, other.model
    there, then = effect_places(old), effect_places(new)
    more = [name for name in then if name not in there]
    less = [name for name in there if name not in then]
    said = [f"has {_listed(more)}"] if more else []
    said += [f"lacks {_listed(less)}"] if less else []
    sentences = [f"{other.name} {' and '.join(said) or 'has the same effects'}, beside {first.name}"]
    for use, words in USES.items():
        before, after = getattr(old.error, use), getattr(new.error, use)
        if before is not None and after is not None:
            sentences.append(
                f"{other.name}: error on recordings {words} {percent(before)} → {percent(after)}"
            )
    for joint, gain in new.drive_gains.items():
        was = old.drive_gains[joint]
        if gain.value != was.value:
            change = change_between(was.value, gain.value)
            unit = pretty_unit(gain.unit)
            sentences.append(
                f"{other.name}: drive gain of {joint} {quantity_text(was)} → {quantity_text(gain)} {unit}, {change}"
            )
    if moved := moved_parameters(old, new):
        rest = f" and {len(moved) - TEXT.moved} more" if len(moved) > TEXT.moved else ""
        count = f"{len(moved)} of {len(new.parameters)} base parameters"
        sentences.append(
            f"{other.name}: {count} moved by more than 3 standard errors: {', '.join(moved[: TEXT.moved])}{rest}"
        )
    if old.settings != new.settings:
        sentences.append(
            f"{other.name} was fitted at another rate or with other filters than {first.name}: their errors are not "
            "of the same band"
        )
    return sentences


def _listed(names: list[str]) -> str:
    return ", ".join(
        f"{spoken(name)} at {place}" if place else spoken(name)
        for name, _, place in (name.partition(":") for name in names)
    )


def _interval_text(gain: DriveGain) -> str:
    ends, text = interval(gain), quantity_text(gain)
    if ends is None or not gain.determined:
        return text
    digits = len(text.partition(" ")[0].partition(".")[2])
    return f"{gain.value:z.{digits}f} [{ends[0]:z.{digits}f}, {ends[1]:z.{digits}f}]"
