"""A law as the Python file of a user-defined effect."""

import json
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from textwrap import wrap

from bench.diagnosis.discovery.factors import Memory, Number, PiecewiseLinear
from bench.diagnosis.discovery.term import Term
from bench.diagnosis.discovery.variables import MEANINGS, SYMBOLS, Place, Variable
from bench.effects import Effect
from bench.effects.user_file import effects_in
from bench.identification.tolerances import TOLERANCES

ATTRIBUTES = {"position": "position", "velocity": "velocity", "acceleration": "acceleration"}


OF_THE_ROBOT = ("load", "tool_speed", "others_load")


def law_effect(name: str, terms: Sequence[Term], place: Place, validity: str = "") -> tuple[Effect, str]:
    """The effect of that name, which is the sum of these terms at a motor, and the text of its file."""
    source = law_source(name, terms, place, validity)
    return effects_in(source, Path(f"{name}.py"))[name], source


def law_source(name: str, terms: Sequence[Term], place: Place, validity: str = "") -> str:
    """The file of an effect that is the sum of terms; place: a motor at which it acts; validity: its range."""
    code_place = _nameless(place)
    numbers, names = labelled(terms)
    variables = sorted({variable for term in terms for variable in term.variables})
    columns = [
        code
        for term, labels in zip(terms, names, strict=True)
        for code in term.codes(code_place, [f"self.{word}" for word in labels])
    ]
    units = [term.unit(place) for term in terms for _ in range(term.parts)]
    formulas = [
        part for term, labels in zip(terms, names, strict=True) for part in _law(term, code_place, labels)
    ]
    law = " + ".join(
        f"c{i + 1}*{formula}" if formula != "1" else f"c{i + 1}" for i, formula in enumerate(formulas)
    )
    motor_alone = all(variable.ahead == 0 and variable.kind not in OF_THE_ROBOT for variable in variables)
    base = "ActuatorEffect" if motor_alone else "Effect"
    by_load = Variable("load") in variables
    lines = [
        '"""A law found in data: an effect that is in no catalogue."""',
        "",
        "from dataclasses import dataclass",
        "",
        "import numpy as np",
        "",
        f"from bench.effects import {base}, EffectParameter{', ShapeParameter' if numbers else ''}",
        *_imports(terms, variables),
        "",
        "",
        "@dataclass(frozen=True)",
        f"class {_class_name(name)}({base}):",
        f'    """{validity or "Valid for motions like those of the data."}"""',
        "",
        f'    name = "{name}"',
        *_wrapped("law", f"τ = {law}"),
        *_wrapped("symbols", f"{_symbols(variables, code_place)}."),
        "    parameters = (",
        *(f'        EffectParameter("c{i + 1}", "{unit}"),' for i, unit in enumerate(units)),
        "    )",
        *_shape(numbers),
        *(
            ["    depends_on_model = True"]
            if any(variable.depends_on_model for variable in variables)
            else []
        ),
        *([""] if numbers or by_load else []),
        *(f"    {label}: float = {number.value!r}" for label, number in numbers.items()),
        *(f"    c{i + 1}: float = 0.0" for i in range(len(columns) if by_load else 0)),
        "",
        *(_torque(variables, columns) if motor_alone else _columns(variables, columns, code_place)),
    ]
    return "\n".join(lines) + "\n"


def labelled(terms: Sequence[Term]) -> tuple[dict[str, Number], list[list[str]]]:
    """The constants of all terms by unique names, and these names term by term."""
    taken: dict[str, Number] = {}
    names: list[list[str]] = []
    for term in terms:
        labels = []
        for number in term.numbers:
            count = sum(other.name == number.name for other in taken.values())
            label = number.name if not count else f"{number.name}_{count + 1}"
            taken[label] = number
            labels.append(label)
        names.append(labels)
    return taken, names


def _nameless(place: Place) -> Place:
    """The motors by their position after the law's motor, so that it can act at any."""
    count = len(place.motors)
    ahead = ["own", *("other" if count == 2 else f"other{k}" for k in range(1, count))]
    motors = tuple(ahead[(i - place.index) % count] for i in range(count))
    return replace(place, motors=motors)


def _law(term: Term, place: Place, names: Sequence[str]) -> tuple[str, ...]:
    """The term's parts with the names of constants, without numpy."""
    return tuple(
        code.replace("np.", "").replace("heaviside", "step").replace(", joint.rate", "")
        for code in term.codes(place, names)
    )


def _imports(terms: Sequence[Term], variables: Sequence[Variable]) -> list[str]:
    lines = []
    if any(isinstance(factor, Memory) for term in terms for factor in term.factors):
        lines.append("from bench.effects.memory import first_order")
    if any(isinstance(factor, PiecewiseLinear) for term in terms for factor in term.factors):
        lines.append("from bench.effects.table import hat")
    if any(variable.depends_on_model for variable in variables):
        more = ", with_itself" if Variable("load") in variables else ""
        lines.append(f"from bench.effects.load import load_at{more}")
    if any(variable.kind == "tool_speed" for variable in variables):
        lines.append("from bench.effects.tool_motion import tool_speed")
    return lines


def _wrapped(name: str, text: str) -> list[str]:
    """A class attribute with long text."""
    lines = wrap(text, TOLERANCES.report.width - 12, break_long_words=False, drop_whitespace=False)
    return [
        f"    {name} = (",
        *(f"        {json.dumps(line, ensure_ascii=False)}" for line in lines),
        "    )",
    ]


def _class_name(name: str) -> str:
    return "".join(part.capitalize() for part in name.split("_"))


def _symbols(variables: Sequence[Variable], place: Place) -> str:
    said = [
        f"{variable.symbol(place)}: {MEANINGS[variable.kind]}"
        + (f" (of the motor {variable.ahead} further in the robot's order)" if variable.ahead else "")
        for variable in variables
    ]
    return "; ".join(said) or "The same at all times"


def _shape(numbers: dict[str, Number]) -> list[str]:
    if not numbers:
        return []
    lines = [
        f'        ShapeParameter("{label}", "{number.unit}", ({number.low!r}, {number.value!r}, {number.high!r})),'
        for label, number in numbers.items()
    ]
    return ["    shape = (", *lines, "    )"]


def _assigned(variables: Sequence[Variable], of: str) -> list[str]:
    """The names of the variables of the law's motor."""
    lines = []
    for variable in variables:
        if variable.ahead or variable.kind in OF_THE_ROBOT:
            continue
        if variable.kind == "time":
            lines.append(f"        t = {of}.time")
        else:
            lines.append(f"        {SYMBOLS[variable.kind]} = {of}.{ATTRIBUTES[variable.kind]}")
    return lines


def _stacked(columns: Sequence[str], of: str) -> list[str]:
    ones = [f"np.ones(len({of}.time))" if column == "1" else column for column in columns]
    return [
        "np.column_stack(",
        "            (",
        *(f"                {name}," for name in ones),
        "            )",
        "        )",
    ]


def _torque(variables: Sequence[Variable], columns: Sequence[str]) -> list[str]:
    stacked = _stacked(columns, "joint")
    return [
        "    def torque(self, joint):",
        *_assigned(variables, "joint"),
        f"        return {stacked[0]}",
        *stacked[1:],
    ]


def _columns(variables: Sequence[Variable], columns: Sequence[str], place: Place) -> list[str]:
    """The `columns` method of a law that uses other motors or the tool."""
    replaced = [column.replace("joint.rate", "own.rate") for column in columns]
    lines = [
        "    def columns(self, robot, joint):",
        "        motors = list(robot.joints)",
        "        here = motors.index(joint)",
        "        own = robot.joints[joint]",
        *_assigned(variables, "own"),
    ]
    for ahead in sorted({variable.ahead for variable in variables if variable.ahead}):
        other = Variable("velocity", ahead).motor(place)
        lines.append(f"        {other} = motors[(here + {ahead}) % len(motors)]")
    for variable in variables:
        if variable.kind == "load":
            if variable.ahead:
                lines.append(f"        {variable.symbol(place)} = load_at(robot, {variable.motor(place)})")
        elif variable.kind == "others_load":
            lines.append(
                "        others_load = sum(load_at(robot, motor) for motor in motors if motor != joint)"
            )
        elif variable.kind == "tool_speed":
            lines.append("        speed = tool_speed(robot)")
        elif variable.ahead:
            lines.append(
                f"        {variable.symbol(place)} = robot.joints[{variable.motor(place)}].{ATTRIBUTES[variable.kind]}"
            )
    replaced = [name.replace("tool_speed", "speed") for name in replaced]
    stacked = _stacked(replaced, "robot")
    made = [f"        columns[:, here] = {stacked[0]}", *stacked[1:]]
    if Variable("load") in variables:  # includes the law itself
        values = ", ".join(f"self.c{i + 1}" for i in range(len(columns)))
        lines += [
            "",
            "        def law(load):",
            f"            return {stacked[0]}",
            *(f"    {name}" for name in stacked[1:]),
            "",
            f"        load = with_itself(load_at(robot, joint), law, [{values}])",
        ]
        made = ["        columns[:, here] = law(load)"]
    return [
        *lines,
        f"        columns = np.zeros((len(robot.time), len(motors), {len(columns)}))",
        *made,
        "        return columns",
    ]
