"""Fixed names: files of a dataset, robot or result, suffixes of logs, and values that files and options may give.

This module imports no numerical package, so that code that needs only a name starts without numpy and MuJoCo.
"""

from typing import Literal

DATASET_FILE = "dataset.toml"
ROBOT_FILE = "robot.toml"
RUN_FILE = "report.json"
TEXTS = (".csv", ".tsv", ".txt", ".dat", ".log")
ARRAYS = (".mat", ".npz", ".parquet")
BAGS = (".mcap", ".db3", ".bag")
LOGS = (*TEXTS, *ARRAYS, *BAGS)
"""Suffixes of log files."""

Use = Literal["identify", "validate"]
Check = Literal["units", "limits", "constant", "spikes", "frozen", "saturated", "mass"]
"""Checks that a recording may skip; mass: of its payload, which an import may doubt."""
Unit = Literal["A", "V", "1"]
"""Unit of a drive's command: a current, an amplifier's voltage, or 1 if torques and forces are logged directly."""
