"""Broken dataset.toml, robot.toml and MJCF files."""

import shutil
from pathlib import Path

from tests.broken_kit import CSV, PARQUET, broken, edit

# --- dataset.toml -------------------------------------------------------------------------------------------


@broken("dataset.toml")
def no_dataset_toml(folder: Path) -> None:
    (folder / "dataset.toml").unlink()


@broken("dataset.toml", "line 1")
def dataset_toml_does_not_parse(folder: Path) -> None:
    edit(folder / "dataset.toml", "robot = ", "robot : ")


@broken("dataset.toml", "recordings[1].purpose", "unknown")
def unknown_key(folder: Path) -> None:
    edit(folder / "dataset.toml", 'payload = "disc"', 'purpose = "disc"')


@broken("dataset.toml", "robot", "missing")
def robot_key_missing(folder: Path) -> None:
    edit(folder / "dataset.toml", 'robot = "./robot"', "")


@broken("nobody")
def robot_unknown(folder: Path) -> None:
    edit(folder / "dataset.toml", "./robot", "nobody")


@broken("dataset.toml", "recordings[0].use", "identify", "fit")
def use_unknown(folder: Path) -> None:
    edit(folder / "dataset.toml", '"identify"', '"fit"')


@broken("dataset.toml", "recordings")
def no_recordings(folder: Path) -> None:
    text = (folder / "dataset.toml").read_text()
    (folder / "dataset.toml").write_text(text.split("[[recordings]]")[0])


@broken("dataset.toml", "recordings[0].file", "elsewhere.csv")
def recording_file_missing(folder: Path) -> None:
    edit(folder / "dataset.toml", CSV, "elsewhere.csv")


@broken("dataset.toml", "recordings[1].file", CSV, "twice")
def recording_listed_twice(folder: Path) -> None:
    edit(folder / "dataset.toml", PARQUET, CSV)


@broken("dataset.toml", "recordings", "'copy.csv' holds the same samples as", CSV, "remove one")
def recording_under_a_second_name(folder: Path) -> None:
    shutil.copy(folder / CSV, folder / "copy.csv")
    with (folder / "dataset.toml").open("a") as file:
        file.write('[[recordings]]\nfile = "copy.csv"\nuse = "validate"\npayload = "disc"\n')


@broken("dataset.toml", "recordings[1].payload", "'disk'", "disc")
def payload_undefined(folder: Path) -> None:
    edit(folder / "dataset.toml", 'payload = "disc"', 'payload = "disk"')


@broken("dataset.toml", "payloads.disc.mass", "positive", "-0.5")
def payload_mass_negative(folder: Path) -> None:
    edit(folder / "dataset.toml", "mass = 0.5", "mass = -0.5")


@broken("dataset.toml", "payloads.disc.mass", "0.5 kg")
def payload_mass_is_text(folder: Path) -> None:
    edit(folder / "dataset.toml", "mass = 0.5", 'mass = "0.5 kg"')


@broken("dataset.toml", "payloads.disc.mass", "nan")
def payload_mass_nan(folder: Path) -> None:
    edit(folder / "dataset.toml", "mass = 0.5", "mass = nan")


@broken("dataset.toml", "payloads.disc.center_of_mass", "3")
def payload_center_of_two_numbers(folder: Path) -> None:
    edit(folder / "dataset.toml", "[0.0, 0.0, 0.02]", "[0.0, 0.02]")


@broken("dataset.toml", "payloads.disc.center_of_mass", "metres")
def payload_center_in_millimetres(folder: Path) -> None:
    edit(folder / "dataset.toml", "[0.0, 0.0, 0.02]", "[0.0, 0.0, 20.0]")


@broken("dataset.toml", "payloads.disc.inertia", "not positive")
def payload_inertia_indefinite(folder: Path) -> None:
    edit(folder / "dataset.toml", "0.002, 0.0, 0.0, 0.0]", "0.002, 0.0, 0.0, 0.5]")


@broken("dataset.toml", "payloads.disc.inertia", "triangle")
def payload_inertia_impossible(folder: Path) -> None:
    edit(folder / "dataset.toml", "[0.001, 0.001, 0.002", "[0.001, 0.001, 0.005")


@broken("dataset.toml", "payloads.disc.weight", "unknown")
def payload_key_unknown(folder: Path) -> None:
    edit(folder / "dataset.toml", "mass = 0.5", "weight = 0.5")


@broken("dataset.toml", "effects", "my_effect.py")
def effect_file_missing(folder: Path) -> None:
    edit(folder / "dataset.toml", 'robot = "./robot"', 'robot = "./robot"\neffects = ["my_effect.py"]')


@broken("dataset.toml", "recordings[0].accept", "everything")
def accepts_an_unknown_check(folder: Path) -> None:
    edit(folder / "dataset.toml", 'use = "identify"', 'use = "identify"\naccept = ["everything"]')


# --- the robot ----------------------------------------------------------------------------------------------


@broken("robot.toml", "gain_units", "unknown")
def robot_key_unknown(folder: Path) -> None:
    edit(folder / "robot" / "robot.toml", "gain_unit =", "gain_units =")


@broken("robot.toml", "gone.xml")
def robot_model_missing(folder: Path) -> None:
    edit(folder / "robot" / "robot.toml", "robot.xml", "gone.xml")


@broken("robot.xml")
def robot_model_does_not_compile(folder: Path) -> None:
    edit(folder / "robot" / "robot.xml", "</body>", "</bodi>")


@broken("robot.toml", "elbow")
def robot_joint_not_in_model(folder: Path) -> None:
    edit(folder / "robot" / "robot.toml", '"wheel"', '"elbow"')


@broken("robot.toml", "floating", "free")
def robot_drives_a_free_joint(folder: Path) -> None:
    edit(folder / "robot" / "robot.toml", '"wheel"', '"floating"')


@broken("robot.toml", "gain_unit", "rail", "slide")
def robot_gain_unit_of_the_wrong_kind(folder: Path) -> None:
    edit(folder / "robot" / "robot.toml", '"N/V"', '"N*m/V"')


@broken("robot.toml", "gain", "-3.0")
def robot_gain_negative(folder: Path) -> None:
    edit(folder / "robot" / "robot.toml", "gain = 3.0", "gain = -3.0")


@broken("robot.toml", "flange")
def robot_tool_site_not_in_model(folder: Path) -> None:
    edit(folder / "robot" / "robot.toml", 'site = "tool"', 'site = "flange"')


@broken("dataset.toml", "recordings[1].payload", "tool")
def payload_without_a_tool(folder: Path) -> None:
    edit(folder / "robot" / "robot.toml", '[tool]\nsite = "tool"\n', "")
