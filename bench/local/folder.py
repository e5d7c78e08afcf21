"""The opened folder: what lies in it, and nothing outside of it; logs that come in, datasets that go out."""

import filecmp
import os
import re
import time
import zipfile
from collections.abc import AsyncIterator, Iterator
from dataclasses import dataclass, field, replace
from itertools import count
from pathlib import Path

from bench.basics.errors import BenchError
from bench.basics.files.atomic import atomic_path
from bench.basics.files.csv_text import FOREIGN
from bench.dataset.catalogue import built_in_robots
from bench.dataset.names import DATASET_FILE, LOGS, ROBOT_FILE, RUN_FILE

MODELS = (".xml",)
MJCF = b"<mujoco"
BEGINNING = 1 << 16  # bytes of a model file in which that is
DEEP, MANY = 6, 5000  # levels and entries that are looked at
RESULTS = ".results"  # what the folder of a dataset's results ends in
MODEL = re.compile(r"(\d+-diagnosis-)?model(-\d+)?\.json")  # in it
LONGEST = 120  # characters of a name
NAME = re.compile(rf"[\w][\w .()+=,-]{{0,{LONGEST - 1}}}")
UNUSUAL = re.compile(r"[^\w .()+=,-]")  # what no name has
LARGEST = 1 << 30  # bytes of one log


@dataclass(frozen=True)
class FolderEntry:
    """What lies in the folder, as paths relative to it, with slashes.

    robots: what a command takes -> its words; runs: folders of results; models: model files next to them.
    mjcfs: MJCF files without a robot.toml next to them.
    """

    datasets: list[str] = field(default_factory=list)
    logs: list[str] = field(default_factory=list)
    mjcfs: list[str] = field(default_factory=list)
    robots: dict[str, str] = field(default_factory=dict)
    runs: list[str] = field(default_factory=list)
    models: list[str] = field(default_factory=list)
    cut: bool = False


@dataclass(frozen=True)
class Folder:
    """The folder that was opened. robots: robot folders elsewhere that the command line named."""

    root: Path
    robots: tuple[Path, ...] = ()

    def inside(self, text: str) -> Path:
        """A path that a page names, relative to the folder.

        Raises BenchError where it leads out of it, by itself or by symbolic links, or to a hidden file.
        """
        parts = text.split("/")
        if (
            not text
            or "\\" in text
            or "\0" in text
            or any(p in ("", ".", "..") or p[0] == "." for p in parts)
        ):
            raise BenchError(f"{text!r}: not a path inside {self.root}")
        path = self.root.joinpath(*parts)
        try:
            outside = not path.resolve().is_relative_to(self.root.resolve())
        except (OSError, RuntimeError):  # symbolic links in a circle
            outside = True
        if outside:
            raise BenchError(f"{text!r}: leads out of {self.root}")
        return path

    def name(self, text: str) -> str:
        """A plain name for a new file or folder. Raises BenchError where it is none."""
        if not NAME.fullmatch(text) or text.endswith((" ", ".")):
            raise BenchError(f"{text!r}: give a name of letters, digits, spaces, and ( ) + = , . - _")
        return text

    def cleaned(self, text: str) -> str:
        """A plain name that is as near to a text as one can be."""
        plain = UNUSUAL.sub("_", text)[:LONGEST].strip(" .")
        return plain if NAME.fullmatch(plain) else f"log{plain}"[:LONGEST].strip(" .")

    def taken_name(self, text: str) -> str:
        """The plain name under which a file that is called so is taken.

        Raises BenchError for a hidden file's name and for one that holds a path.
        """
        path = Path(text)
        if not text or text.startswith(".") or "/" in text or "\\" in text or "\0" in text:
            raise BenchError(
                f"{text!r}: rename it, then drop it again: give a name that begins with a letter or digit"
            )
        if NAME.fullmatch(text):
            return text
        suffix = UNUSUAL.sub("_", path.suffix)
        return f"{self.cleaned(path.stem)[: LONGEST - len(suffix)]}{suffix}"

    def free(self, stem: str) -> str:
        """A name that neither a folder nor the results of one has: the stem, or the stem with a number."""
        names = (stem if number == 1 else f"{stem}_{number}" for number in count(1))
        return next(
            name for name in names if not any((self.root / f"{name}{end}").exists() for end in ("", RESULTS))
        )

    def word(self, path: Path) -> str:
        """A path as a command is given it: from where the server was started, or in full."""
        try:
            word = path.resolve().relative_to(Path.cwd()).as_posix()
        except ValueError:
            return str(path.resolve())
        return f"./{word}" if word.startswith("-") else word  # never taken for an option

    def robot(self, name: str) -> str:
        """A robot that the page chose, as a command is given it. Raises BenchError for one that is not offered."""
        if name in built_in_robots():
            return name
        for path in self.robots:
            if name == str(path):
                return self.word(path)
        path = self.inside(name)
        if not (path / ROBOT_FILE).is_file():
            raise BenchError(f"{name}: no robot folder: it holds no {ROBOT_FILE}")
        return self.word(path)

    def look(self) -> FolderEntry:
        """Walk through the folder, symbolic links and hidden names aside."""
        entry = FolderEntry(robots={name: name for name in built_in_robots()})
        entry.robots.update({str(path): f"{path.name} ({path})" for path in self.robots})
        runs: list[tuple[float, str]] = []
        seen = 0
        for folder, files in self._folders():
            seen += len(files) + 1
            if seen > MANY:
                return replace(entry, runs=_by_time(runs), cut=True)
            place = folder.relative_to(self.root).as_posix()
            if ROBOT_FILE in files and place != ".":
                entry.robots[place] = place
            if RUN_FILE in files:
                runs.append(((folder / RUN_FILE).stat().st_mtime, place))
            elif DATASET_FILE in files:
                entry.datasets.append(place)
            elif place.endswith(RESULTS) or (place == RESULTS[1:] and entry.datasets == ["."]):
                entry.models.extend(f"{place}/{name}" for name in sorted(files) if MODEL.fullmatch(name))
            elif ROBOT_FILE not in files:
                logs = sorted(name for name in files if Path(name).suffix.lower() in LOGS)
                entry.logs.extend(name if place == "." else f"{place}/{name}" for name in logs)
                models = sorted(name for name in files if _is_mjcf(folder / name))
                entry.mjcfs.extend(name if place == "." else f"{place}/{name}" for name in models)
        return replace(entry, runs=_by_time(runs))

    def _folders(self) -> Iterator[tuple[Path, list[str]]]:
        for place, folders, files in os.walk(self.root):
            folder = Path(place)
            deep = len(folder.relative_to(self.root).parts) >= DEEP
            folders[:] = [] if deep else sorted(name for name in folders if not name.startswith("."))
            folders[:] = [name for name in folders if not (folder / name).is_symlink()]
            yield folder, [name for name in files if not name.startswith(".")]


def _is_mjcf(path: Path) -> bool:
    if path.suffix.lower() not in MODELS or path.is_symlink():
        return False
    try:
        with path.open("rb") as file:
            return MJCF in file.read(BEGINNING)
    except OSError:
        return False


def _by_time(runs: list[tuple[float, str]]) -> list[str]:
    return [place for _, place in sorted(runs)]


def said_time(path: Path) -> str:
    """When a file was written, in this machine's time."""
    return time.strftime("%Y-%m-%d %H:%M", time.localtime(path.stat().st_mtime))


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
