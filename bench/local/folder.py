"""The opened folder: its contents, and nothing outside it; uploaded logs, and datasets to download."""

import filecmp
import os
import re
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
BEGINNING = 1 << 16  # bytes at the start of a model file that are searched for it
DEEP, MANY = 6, 5000  # levels and entries that are visited
RESULTS = ".results"  # ending of the folder of a dataset's results
MODEL = re.compile(r"(\d+-diagnosis-)?model(-\d+)?\.json")  # a model file in that folder
LONGEST = 120  # characters of a name
NAME = re.compile(rf"[\w][\w .()+=,-]{{0,{LONGEST - 1}}}")
UNUSUAL = re.compile(r"[^\w .()+=,-]")  # a character that no name has
LARGEST = 1 << 30  # bytes of one log


@dataclass(frozen=True)
class FolderEntry:
    """Contents of the folder, as paths relative to it, with slashes.

    sizes: of the logs, bytes. robots: name or path -> label; runs: folders of results, oldest first; models: model
    files next to them. mjcfs: MJCF files without a robot.toml next to them. cut: whether it stopped after `MANY`.
    """

    datasets: list[str] = field(default_factory=list)
    logs: list[str] = field(default_factory=list)
    sizes: dict[str, int] = field(default_factory=dict)
    mjcfs: list[str] = field(default_factory=list)
    robots: dict[str, str] = field(default_factory=dict)
    runs: list[str] = field(default_factory=list)
    models: list[str] = field(default_factory=list)
    cut: bool = False


@dataclass(frozen=True)
class Folder:
    """The opened folder. robots: robot folders named on the command line, which may be outside it."""

    root: Path
    robots: tuple[Path, ...] = ()

    def inside(self, text: str) -> Path:
        """The path that a page gives relative to the folder.

        Raises BenchError if it leads out of the folder, by itself or by symbolic links, or to a hidden file.
        """
        parts = text.split("/")
        if "\\" in text or "\0" in text or any(not part or part[0] == "." for part in parts):
            raise BenchError(f"{text!r}: not a path inside {self.root}")
        path = self.root.joinpath(*parts)
        try:
            outside = not path.resolve().is_relative_to(self.root.resolve())
        except (OSError, RuntimeError):  # a cycle of symbolic links
            outside = True
        if outside:
            raise BenchError(f"{text!r}: leads out of {self.root}")
        return path

    def name(self, text: str) -> str:
        """The text as the name of a new file or folder. Raises BenchError if it is not a plain name."""
        if not NAME.fullmatch(text) or text.endswith((" ", ".")):
            raise BenchError(f"{text!r}: give a name of letters, digits, spaces, and ( ) + = , . - _")
        return text

    def cleaned(self, text: str) -> str:
        """The text as a plain name: other characters become underscores, and long texts are shortened."""
        plain = UNUSUAL.sub("_", text)[:LONGEST].strip(" .")
        return plain if NAME.fullmatch(plain) else f"log{plain}"[:LONGEST].strip(" .")

    def taken_name(self, text: str) -> str:
        """The plain name under which an uploaded file is kept.

        Raises BenchError for the name of a hidden file, or one that contains a path.
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
        """A name that no file or folder and no results have: the stem, or the stem with a number."""
        for number in count(1):
            path = self.root / (stem if number == 1 else f"{stem}_{number}")
            if not path.exists() and not path.with_name(f"{path.name}{RESULTS}").exists():
                break
        return path.name

    def word(self, path: Path) -> str:
        """A path as an argument of a command: relative to where the server was started, or absolute."""
        try:
            word = path.resolve().relative_to(Path.cwd()).as_posix()
        except ValueError:
            return str(path.resolve())
        return f"./{word}" if word.startswith("-") else word  # never taken for an option

    def robot(self, name: str) -> str:
        """The robot that the page chose, as an argument of a command. Raises BenchError for one that is not offered."""
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
        """Walk through the folder, except symbolic links and hidden names."""
        entry = FolderEntry(robots={name: name for name in built_in_robots()})
        entry.robots.update({str(path): f"{path.name} ({path})" for path in self.robots})
        runs: list[tuple[float, str]] = []
        seen = 0
        for folder, files in self._folders():
            seen += len(files) + 1
            if seen > MANY:
                return replace(entry, runs=[run for _, run in sorted(runs)], cut=True)
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
                for name in sorted(name for name in files if Path(name).suffix.lower() in LOGS):
                    log = name if place == "." else f"{place}/{name}"
                    entry.logs.append(log)
                    entry.sizes[log] = _size(folder / name)
                models = sorted(name for name in files if _is_mjcf(folder / name))
                entry.mjcfs.extend(name if place == "." else f"{place}/{name}" for name in models)
        return replace(entry, runs=[run for _, run in sorted(runs)])

    def _folders(self) -> Iterator[tuple[Path, list[str]]]:
        for place, folders, files in os.walk(self.root):
            folder = Path(place)
            deep = len(folder.relative_to(self.root).parts) >= DEEP
            folders[:] = [] if deep else sorted(name for name in folders if not name.startswith("."))
            folders[:] = [name for name in folders if not (folder / name).is_symlink()]
            yield folder, [name for name in files if not name.startswith(".")]


def _size(path: Path) -> int:
    """Bytes of a file; 0 if it is no longer there."""
    try:
        return path.stat().st_size
    except OSError:
        return 0


def _is_mjcf(path: Path) -> bool:
    if path.suffix.lower() not in MODELS or path.is_symlink():
        return False
    try:
        with path.open("rb") as file:
            return MJCF in file.read(BEGINNING)
    except OSError:
        return False


STARTS: dict[str, tuple[bytes, ...]] = {
    ".parquet": (b"PAR1",),
    ".npz": (b"PK\x03\x04",),
    ".mat": (b"MATLAB ", b"\x89HDF"),
    ".mcap": (b"\x89MCAP",),
    ".db3": (b"SQLite format 3\0",),
    ".bag": (b"#ROSBAG",),
}
"""First bytes of files, by suffix. A CSV file begins with text."""


async def take(folder: Folder, name: str, content: AsyncIterator[bytes], largest: int = LARGEST) -> str:
    """Write a log or an MJCF into the folder; return its name there. A file with the same content stays.

    Characters that are unsuitable in a command are replaced in the name. Raises BenchError, and writes nothing, for the
    name of a hidden file, a suffix that is neither a log's nor a model's, another file of that name, content that does
    not match the suffix or is empty, and more than `largest` bytes.
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
    if (starts := STARTS.get(suffix)) is not None:
        if not content.startswith(starts):
            raise BenchError(f"{name}: does not begin as a {suffix} file does")
        return
    if foreign := next((FOREIGN[entry] for entry in FOREIGN if content.startswith(entry)), None):
        raise BenchError(f"{name}: is {foreign}")
    if b"\0" in content[:4096]:
        raise BenchError(f"{name}: is no text")


def zip_dataset(dataset: Path, target: Path) -> None:
    """Write the files in a dataset's folder to a ZIP archive, except links and hidden files."""
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive:
        for path in sorted(dataset.iterdir()):
            if path.is_file() and not path.is_symlink() and not path.name.startswith("."):
                archive.write(path, f"{dataset.resolve().name}/{path.name}")
