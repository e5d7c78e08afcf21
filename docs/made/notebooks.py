"""Notebooks in percent format as pages: cells of text as they are, code in blocks, the file beside them."""

import re
from pathlib import Path

import mkdocs_gen_files

FOLDER = Path(__file__).resolve().parents[1] / "notebooks"
CELL = re.compile(r"^# %%( \[markdown\])?\n", re.MULTILINE)


def page(text: str, name: str) -> str:
    """Cells one after another."""
    _, *parts = CELL.split(text)
    lines = []
    for kind, cell in zip(parts[::2], parts[1::2], strict=True):
        if kind is None:
            lines.append(f"```python\n{cell.strip()}\n```")
        else:
            lines.append(
                "\n".join(line.removeprefix("#").removeprefix(" ") for line in cell.strip().splitlines())
            )
    title, *rest = lines[0].split("\n")
    note = (
        f"[{name}.py]({name}.py) opens as a notebook in VS Code, and in Jupyter with jupytext; tests run it."
    )
    return "\n\n".join((title, note, "\n".join(rest), *lines[1:])) + "\n"


for path in sorted(FOLDER.glob("*.py")):
    text = path.read_text(encoding="utf-8")
    with mkdocs_gen_files.open(f"notebooks/{path.stem}.md", "w") as written:
        written.write(page(text, path.stem))
    with mkdocs_gen_files.open(f"notebooks/{path.name}", "w") as written:
        written.write(text)
