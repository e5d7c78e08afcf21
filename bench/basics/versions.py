"""Versions of the program and its packages."""

import platform
import subprocess
from dataclasses import dataclass
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

PACKAGES = ("parabench", "mujoco", "numpy", "pin", "scipy")


@dataclass(frozen=True)
class Versions:
    """Versions by package, and the commit of the checkout ("" for an installed wheel)."""

    python: str
    packages: tuple[tuple[str, str], ...]
    commit: str

    def columns(self) -> dict[str, str]:
        """Columns of a table: commit, version.python and version.PACKAGE."""
        return {
            "commit": self.commit,
            "version.python": self.python,
            **{f"version.{name}": number for name, number in self.packages},
        }

    def named(self) -> dict[str, str]:
        """The `versions` of a JSON answer: by package, with Python and the commit."""
        return {**dict(self.packages), "python": self.python, "commit": self.commit}


@cache
def versions() -> Versions:
    """The versions in this process."""
    return Versions(platform.python_version(), tuple((name, _version(name)) for name in PACKAGES), _commit())


def _version(package: str) -> str:
    """The version of a package; "" if it is not installed, but only on the path."""
    try:
        return version(package)
    except PackageNotFoundError:
        return ""


def _commit() -> str:
    """Commit of the checkout of this package, with "+" if files in bench or robots differ from it; "" without one."""
    root = Path(__file__).resolve().parents[2]
    if not (root / ".git").exists():
        return ""

    def git(*arguments: str) -> str:
        done = subprocess.run(
            ["git", "-C", str(root), *arguments], capture_output=True, text=True, check=False
        )
        return done.stdout.strip() if done.returncode == 0 else ""

    commit = git("rev-parse", "--short=12", "HEAD")
    return f"{commit}+" if git("status", "--porcelain", "--untracked-files=no", "bench", "robots") else commit
