"""The folder of the measured logs."""

import os
from pathlib import Path


def measured_data() -> Path:
    """The folder that $PARABENCH_DATA names, or ../shared/data; it may be missing."""
    return Path(os.environ.get("PARABENCH_DATA", "../shared/data"))
