"""Names that files and options give: files of a dataset, robot or result, what a recording or motor may be declared as.

This module imports nothing, so that what only needs a name starts without numpy and MuJoCo.
"""

from typing import Literal

DATASET_FILE = "dataset.toml"
ROBOT_FILE = "robot.toml"
RUN_FILE = "report.json"
TEXTS = (".csv", ".tsv", ".txt", ".dat", ".log")
ARRAYS = (".mat", ".npz", ".parquet")
BAGS = (".mcap", ".db3", ".bag")
LOGS = (*TEXTS, *ARRAYS, *BAGS)
"""What the files of logs end in."""

Use = Literal["identify", "validate"]
Check = Literal["units", "limits", "constant", "spikes", "frozen", "saturated", "mass"]
"""What a recording may be accepted with; mass: of its payload, which an import asks about."""
Unit = Literal["A", "V", "1"]
"""What the drive commands: a current, the voltage of an amplifier; or torques and forces are logged themselves."""
