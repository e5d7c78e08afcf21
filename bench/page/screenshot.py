"""Pictures of a page as people see it, to look at after every change: for developers only.

    python -m bench.page.screenshot report.html FOLDER

writes laptop_light.png, laptop_dark.png, phone_light.png, phone_dark.png and print.pdf; `--whole` the whole length of
the page instead of its start. Needs Debian's chromium.
"""

import argparse
from pathlib import Path

from bench.page.browser import browser, opened, scrolled

WIDTHS = {"laptop": (1366, 1500), "phone": (390, 844)}


def take(report: Path, folder: Path, *, whole: bool) -> list[Path]:
    """Write the pictures into a folder and tell their paths."""
    folder.mkdir(parents=True, exist_ok=True)
    written = []
    with browser() as program:
        for device, (width, height) in WIDTHS.items():
            for dark in (False, True):
                page = scrolled(opened(program, report, width=width, height=height, dark=dark))
                path = folder / f"{device}_{'dark' if dark else 'light'}.png"
                page.screenshot(path=path, full_page=whole)
                written.append(path)
        page = opened(program, report)
        page.pdf(path=folder / "print.pdf", prefer_css_page_size=True)
        written.append(folder / "print.pdf")
    return written


def main() -> None:
    """Read the command line."""
    parser = argparse.ArgumentParser(
        prog="python -m bench.page.screenshot", description=(__doc__ or "").partition("\n")[0]
    )
    parser.add_argument("report", type=Path)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--whole", action="store_true", help="the page in its whole length")
    given = parser.parse_args()
    for path in take(given.report, given.folder, whole=given.whole):
        print(path)  # noqa: T201 - a separate program


if __name__ == "__main__":
    main()
