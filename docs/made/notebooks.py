"""Notebooks in percent format as pages: text as it is, code in blocks with what it printed, the file beside them."""

import json
import re
from pathlib import Path

import mkdocs_gen_files

FOLDER = Path(__file__).resolve().parents[1] / "notebooks"
CELL = re.compile(r"^# %%( \[markdown\])?\n", re.MULTILINE)


def page(text: str, name: str, printed: list[str]) -> str:
    """Cells one after another, with what those of code print."""
    _, *parts = CELL.split(text)
    lines, outputs = [], iter(printed)
    for kind, cell in zip(parts[::2], parts[1::2], strict=True):
        if kind is None:
            lines.append(f"```python\n{cell.strip()}\n```")
            if output := next(outputs).strip("\n"):
                lines.append(f"```text\n{output}\n```")
        else:
            lines.append(
                "\n".join(line.removeprefix("#").removeprefix(" ") for line in cell.strip().splitlines())
            )
    title, *rest = lines[0].split("\n")
    note = (
        f"[{name}.py]({name}.py) opens as a notebook in VS Code, and in Jupyter with jupytext; tests run it, "
        "and compare what it prints with what stands here."
    )
    return "\n\n".join((title, note, "\n".join(rest), *lines[1:])) + "\n"


KEPT = json.loads((FOLDER / "outputs.json").read_text(encoding="utf-8"))
for path in sorted(FOLDER.glob("*.py")):
    text = path.read_text(encoding="utf-8")
    with mkdocs_gen_files.open(f"notebooks/{path.stem}.md", "w") as written:
        written.write(page(text, path.stem, KEPT[path.stem]))
    with mkdocs_gen_files.open(f"notebooks/{path.name}", "w") as written:
        written.write(text)
