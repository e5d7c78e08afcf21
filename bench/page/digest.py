"""Whether files are still those that they were: digests of a dataset with all that it names, and of single files."""

import hashlib
from collections.abc import Sequence
from pathlib import Path

import mujoco
import numpy as np

from bench.basics.errors import BenchError
from bench.dataset.dataset import Dataset
from bench.dataset.names import DATASET_FILE

SIZE = 16  # bytes


def dataset_digest(dataset: Dataset, effect_files: Sequence[Path] = ()) -> str:
    """Digest of dataset.toml, the recordings, the robot's description and mechanism, and the files with effects.

    The mechanism is taken as MuJoCo compiles it, so that files that the MJCF includes count as well. effect_files:
    those in addition to the dataset's.
    """
    robot = dataset.robot
    recordings = [
        dataset.folder / name for name in dict.fromkeys(recording.log for recording in dataset.recordings)
    ]
    files = [dataset.folder / DATASET_FILE, *recordings, robot.folder / "robot.toml"]
    files += [*dataset.effect_files, *effect_files]
    digest = hashlib.blake2b(digest_size=SIZE)
    for path in files:
        digest.update(bytes.fromhex(file_digest(path)))
    model = robot.mjcf_model()
    mechanism = np.zeros(mujoco.mj_sizeModel(model), np.uint8)
    mujoco.mj_saveModel(model, None, mechanism)
    digest.update(mechanism.tobytes())
    return digest.hexdigest()


def file_digest(path: Path) -> str:
    """Of a file's bytes. Raises BenchError where it cannot be read."""
    try:
        with path.open("rb") as file:
            return hashlib.file_digest(file, lambda: hashlib.blake2b(digest_size=SIZE)).hexdigest()
    except OSError as error:
        raise BenchError(f"{path}: {error.strerror or error}") from None
