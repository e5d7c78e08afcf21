"""The page of the robots that come along, from robots/README.md and the folders that it names."""

from pathlib import Path

import mkdocs_gen_files

ROOT = Path(__file__).resolve().parents[2]


def page() -> str:
    """The table of robots, its pictures copied beside it."""
    text = (ROOT / "robots" / "README.md").read_text(encoding="utf-8")
    for folder in sorted(path.parent for path in (ROOT / "robots").glob("*/robot.toml")):
        for picture in folder.glob("*.png"):
            with mkdocs_gen_files.open(f"robots/{folder.name}/{picture.name}", "wb") as copy:
                copy.write(picture.read_bytes())
        text = text.replace(f'src="{folder.name}/', f'src="robots/{folder.name}/')
        text = text.replace(f"[`{folder.name}`]({folder.name}/robot.toml)", f"`{folder.name}`")
    return text.replace(
        "[bench/effects/README.md](../bench/effects/README.md)", "[the atlas](atlas/index.md)"
    )


with mkdocs_gen_files.open("robots.md", "w") as written:
    written.write(page())
