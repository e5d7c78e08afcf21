"""Files that come and go: a log or a model comes whole or not at all, a dataset leaves as an archive."""

import filecmp
import zipfile
from collections.abc import AsyncIterator
from pathlib import Path

from bench.basics.errors import BenchError
from bench.basics.files.atomic import atomic_path
from bench.basics.files.csv_text import FOREIGN
from bench.dataset.names import LOGS
from bench.local.folder import MODELS, Folder

LARGEST = 1 << 30  # bytes of one log
STARTS: dict[str, tuple[bytes, ...]] = {
    ".parquet": (b"PAR1",),
    ".npz": (b"PK\x03\x04",),
    ".mat": (b"MATLAB ", b"\x89HDF"),
    ".mcap": (b"\x89MCAP",),
    ".db3": (b"SQLite format 3\0",),
    ".bag": (b"#ROSBAG",),
}
"""How files of a kind begin. A CSV begins with text."""


async def take(folder: Folder, name: str, content: AsyncIterator[bytes], largest: int = LARGEST) -> str:
    """Write a log, or an MJCF, into the folder and return its path in it; a file that is there with this content stays.

    A name with characters that commands would stumble over becomes a plain one. Raises BenchError for a name of a
    hidden file, a kind that neither has, another file of that name, content that is not of its kind, and too much of
    it; nothing is written then.
    """
    name = folder.taken_name(name)
    suffix = Path(name).suffix.lower()
    if suffix not in (*LOGS, *MODELS):
        raise BenchError(f"{name}: a log is one of {', '.join(LOGS)}; an MJCF model is .xml")
    target = folder.inside(name)
    if target.is_symlink() or (target.exists() and not target.is_file()):
        raise BenchError(f"{name}: is in the folder already; rename one of the two, then drop it again")
    with atomic_path(target) as partial:
        size = 0
        with partial.open("wb") as file:
            async for part in content:
                if size == 0 and part:
                    _check_beginning(name, suffix, part)
                size += len(part)
                if size > largest:
                    raise BenchError(
                        f"{name}: larger than {largest / 2**20:.0f} MB; put it into the folder by hand"
                    )
                file.write(part)
        if size == 0:
            raise BenchError(f"{name}: the file is empty")
        if target.exists() and not filecmp.cmp(partial, target, shallow=False):
            raise BenchError(
                f"{name}: another file of that name is in the folder already; rename one of the two, then drop it again"
            )
    return name


def _check_beginning(name: str, suffix: str, content: bytes) -> None:
    starts = STARTS.get(suffix)
    if starts is not None and not content.startswith(starts):
        raise BenchError(f"{name}: does not begin as a {suffix} file does")
    if starts is None and (
        foreign := next((FOREIGN[entry] for entry in FOREIGN if content.startswith(entry)), None)
    ):
        raise BenchError(f"{name}: is {foreign}")
    if starts is None and b"\0" in content[:4096]:
        raise BenchError(f"{name}: is no text")


def zip_dataset(dataset: Path, target: Path) -> None:
    """A dataset's files as an archive: those that lie in its folder, links and hidden ones aside."""
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive:
        for path in sorted(dataset.iterdir()):
            if path.is_file() and not path.is_symlink() and not path.name.startswith("."):
                archive.write(path, f"{dataset.resolve().name}/{path.name}")
