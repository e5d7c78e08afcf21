"""The pictures of the README and of the tutorials, `make pictures`: made by the commands that the pages show.

The commands of every tutorial run in an empty folder, as they stand on its page; their figures go to results/pictures,
with pictures of the report in Chromium and of the recording in the Rerun viewer. Needs Chromium and, for the viewer
without a screen, a Vulkan driver (Debian: chromium, mesa-vulkan-drivers).
"""

import contextlib
import io
import re
import shlex
import sys
import tempfile
import time
from pathlib import Path

import click
from PIL import Image
from rerun.experimental import ViewerClient

from bench.basics.files.atomic import atomic_path
from bench.cli import main
from docs.pictures.browser import browser, opened

ROOT = Path(__file__).resolve().parents[2]
PAGES = ROOT / "docs" / "pages" / "tutorials"
TO = ROOT / "results" / "pictures"
COPIED = {
    "friction": {
        "results/tutorial/before/errors_left.png": "tutorial_before.png",
        "results/tutorial/diagnosis/ladder.png": "tutorial_ladder.png",
        "results/tutorial/diagnosis/gains.png": "tutorial_gains.png",
        "results/tutorial/diagnosis/errors.png": "tutorial_errors.png",
    },
    "law": {
        "before/errors_left.png": "law_before.png",
        "found/ladder.png": "law_ladder.png",
    },
}
"""A tutorial -> what its commands draw -> the picture's name."""
SHOWN = "results/tutorial/diagnosis"  # whose report and recording are shown
PORT = 9877
SIZE = (1440, 900)  # of the pictures, px
MOMENT = 7.0  # s, at which the viewer stands
LOADED = 6.0  # s, until the viewer has drawn
COLOURS = 192


def blocks(page: Path) -> list[tuple[str, str]]:
    """(language, text) of every block of a page."""
    return re.findall(r"```(\w+)\n(.*?)```", page.read_text(encoding="utf-8"), flags=re.DOTALL)


def run_page(page: Path) -> None:
    """Run the commands of a page in this folder; a scenario that it shows is saved under the name that they use."""
    told = blocks(page)
    commands = [line for language, text in told if language == "sh" for line in text.strip().splitlines()]
    named = [word for line in commands for word in shlex.split(line) if word.endswith(".toml")]
    for name, (_, text) in zip(named, [one for one in told if one[0] == "toml"], strict=True):
        Path(name).write_text(text, encoding="utf-8")
    for line in commands:
        click.echo(line)
        program, *arguments = shlex.split(line)
        if program != "bench":
            raise ValueError(f"{page}: {line}: not a command of bench")
        with contextlib.redirect_stdout(io.StringIO()):
            code = main(arguments)
        if code:
            raise SystemExit(f"{page}: {line}: exit code {code}")


def small(png: bytes | Path) -> Image.Image:
    """A picture with few colours, as the pages carry them."""
    image = Image.open(io.BytesIO(png) if isinstance(png, bytes) else png).convert("RGB")
    return image.quantize(COLOURS, dither=Image.Dither.NONE)


def keep(image: Image.Image, name: str) -> None:
    """Write a picture into results/pictures."""
    with atomic_path(TO / name) as path:
        image.save(path, format="png", optimize=True)
    click.echo(f"{name}: {(TO / name).stat().st_size // 1000} kB")


def report_picture(report: Path) -> None:
    """The first fold of a report."""
    with browser() as launched:
        page = opened(launched, report, width=SIZE[0], height=SIZE[1])
        page.wait_for_timeout(1000.0)
        keep(small(page.screenshot()), "report.png")


def law_picture(report: Path) -> None:
    """The chart of the law that was found, in a report."""
    with browser() as launched:
        page = opened(launched, report, width=560, height=SIZE[1])
        figure = page.locator("#laws [data-figure]").first
        figure.scroll_into_view_if_needed()
        page.wait_for_timeout(1000.0)
        keep(small(figure.screenshot()), "law_curve.png")


def viewer_picture(recording: Path) -> None:
    """The Rerun viewer at a moment of a recording."""
    program = Path(sys.executable).with_name("rerun")
    client = ViewerClient.spawn(
        headless=True, port=PORT, hide_welcome_screen=True, detach_process=False, executable_path=str(program)
    )
    try:
        client.open(str(recording))
        client.set_time("time", duration=MOMENT, play_state="paused")
        before, until = b"", time.monotonic() + 60.0
        time.sleep(LOADED)
        while (now := client.take_screenshot(max_size=SIZE[0])) != before and time.monotonic() < until:
            before = now
        keep(small(now), "viewer.png")
    finally:
        client.quit()


def draw(folder: Path) -> None:
    """All pictures, with the commands' files in a folder."""
    for name, files in COPIED.items():
        place = folder / name
        place.mkdir()
        with contextlib.chdir(place):
            run_page(PAGES / f"{name}.md")
        for source, target in files.items():
            keep(small(place / source), target)
    shown = folder / "friction" / SHOWN
    report_picture(shown / "report.html")
    law_picture(folder / "law" / "found" / "report.html")
    main(["view", str(shown), "--save", str(folder / "shown.rrd"), "--quiet"])
    viewer_picture(folder / "shown.rrd")


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as name:
        draw(Path(name))
    sys.exit(0)
