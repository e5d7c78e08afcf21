"""Identified values as a plain table: CSV, a row per number; YAML by kind."""

import csv
import io
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from bench.basics.files.atomic import write_text_atomically
from bench.export.bodies import about_center
from bench.export.physical import PhysicalSet

COLUMNS = ("kind", "place", "name", "value", "std", "unit")
INERTIAS = ("Ixx", "Ixy", "Iyy", "Ixz", "Iyz", "Izz")
PLACES = ((0, 0), (0, 1), (1, 1), (0, 2), (1, 2), (2, 2))


def table_rows(physical: PhysicalSet) -> list[dict[str, Any]]:
    """Gains, base parameters and effects with their deviations as identified, then the real bodies.

    A body's numbers have no deviation: the data do not determine them one by one. Centres of mass [m] and inertias
    about them [kg m2] are in the frame of the joint that moves the body, those of payloads in the tool frame.
    """
    content = json.loads(physical.model.path.read_text(encoding="utf-8"))
    rows = [_row("drive gain", joint, "gain", quantity) for joint, quantity in content["drive_gains"].items()]
    rows += [_row("base parameter", "", parameter["name"], parameter) for parameter in content["parameters"]]
    for effect, places in content["effect_parameters"].items():
        for place, values in places.items():
            rows += [_row(effect, place, name, value) for name, value in values.items()]
    kinds = {joint.name: joint.kind for joint in physical.model.model.geometry.joints}
    for joint, rotor in zip(physical.model.robot.joints, physical.rotors, strict=True):
        unit = "kg" if kinds[joint] == "slide" else "kg*m^2"
        rows.append(_row("rotor", joint, "Ia", {"value": float(rotor), "std": None, "unit": unit}))
    for kind, bodies in (("body", physical.bodies), ("payload", physical.payloads)):
        for name, parameters in bodies.items():
            mass, center, inertia = about_center(parameters)
            numbers = [("m", mass, "kg")]
            numbers += [(f"c{axis}", float(x), "m") for axis, x in zip("xyz", center, strict=True)]
            numbers += [(i, float(inertia[at]), "kg*m^2") for i, at in zip(INERTIAS, PLACES, strict=True)]
            rows += [
                _row(kind, name, what, {"value": value, "std": None, "unit": unit})
                for what, value, unit in numbers
            ]
    return rows


def _row(kind: str, place: str, name: str, quantity: Mapping[str, Any]) -> dict[str, Any]:
    values = {key: quantity[key] for key in ("value", "std", "unit")}
    return {"kind": kind, "place": place, "name": name, **values}


def write_csv(path: Path, physical: PhysicalSet) -> None:
    """Write the table with a header, whole or not at all."""
    text = io.StringIO()
    writer = csv.DictWriter(text, COLUMNS, lineterminator="\n")
    writer.writeheader()
    writer.writerows(table_rows(physical))
    write_text_atomically(path, text.getvalue())


def write_yaml(path: Path, physical: PhysicalSet) -> None:
    """Write the table as kind, place, name with value, std and unit each, whole or not at all."""
    lines, before = [f"robot: {json.dumps(physical.model.robot.name)}"], ("", None)
    for row in table_rows(physical):
        if row["kind"] != before[0]:
            lines.append(f"{json.dumps(row['kind'])}:")
        if row["place"] and (row["kind"], row["place"]) != before:
            lines.append(f"  {json.dumps(row['place'])}:")
        before = row["kind"], row["place"]
        values = ", ".join(f"{key}: {json.dumps(row[key])}" for key in ("value", "std", "unit"))
        lines.append(f"{'    ' if row['place'] else '  '}{json.dumps(row['name'])}: {{{values}}}")
    write_text_atomically(path, "\n".join(lines) + "\n")
