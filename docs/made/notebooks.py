"""Notebooks in percent format as pages: text as it is, code in blocks with what it printed, the file beside them."""

import json
import re
from pathlib import Path
from typing import Any

import mkdocs_gen_files

FOLDER = Path(__file__).resolve().parents[1] / "notebooks"
CELL = re.compile(r"^# %%( \[markdown\])?\n", re.MULTILINE)


def cells(text: str) -> list[tuple[bool, str]]:
    """Whether a cell is code, and what stands in it; text without its comment signs."""
    _, *parts = CELL.split(text)
    return [
        (True, cell.strip())
        if kind is None
        else (
            False,
            "\n".join(line.removeprefix("#").removeprefix(" ") for line in cell.strip().splitlines()),
        )
        for kind, cell in zip(parts[::2], parts[1::2], strict=True)
    ]


def notebook(text: str, printed: list[str]) -> dict[str, Any]:
    """The same as Jupyter keeps it (nbformat 4.5), with what the cells print."""
    outputs, made = iter(printed), []
    for number, (code, source) in enumerate(cells(text)):
        cell = {"id": f"cell-{number}", "metadata": {}, "source": source.splitlines(keepends=True)}
        if code:
            shown = next(outputs).splitlines(keepends=True)
            stream = [{"output_type": "stream", "name": "stdout", "text": shown}] if shown else []
            cell |= {"cell_type": "code", "execution_count": None, "outputs": stream}
        else:
            cell |= {"cell_type": "markdown"}
        made.append(cell)
    kernel = {"name": "python3", "display_name": "Python 3", "language": "python"}
    return {"nbformat": 4, "nbformat_minor": 5, "metadata": {"kernelspec": kernel}, "cells": made}


def page(text: str, name: str, printed: list[str]) -> str:
    """Cells one after another, with what those of code print."""
    lines, outputs = [], iter(printed)
    for code, cell in cells(text):
        lines.append(f"```python\n{cell}\n```" if code else cell)
        if code and (output := next(outputs).strip("\n")):
            lines.append(f"```text\n{output}\n```")
    title, *rest = lines[0].split("\n")
    note = (
        f"[{name}.ipynb]({name}.ipynb) opens in Jupyter, and [{name}.py]({name}.py), the same cells as a script, in VS "
        "Code; tests run it, and compare what it prints with what stands here."
    )
    return "\n\n".join((title, note, "\n".join(rest), *lines[1:])) + "\n"


KEPT = json.loads((FOLDER / "outputs.json").read_text(encoding="utf-8"))
for path in sorted(FOLDER.glob("*.py")):
    text = path.read_text(encoding="utf-8")
    with mkdocs_gen_files.open(f"notebooks/{path.stem}.md", "w") as written:
        written.write(page(text, path.stem, KEPT[path.stem]))
    with mkdocs_gen_files.open(f"notebooks/{path.name}", "w") as written:
        written.write(text)
    with mkdocs_gen_files.open(f"notebooks/{path.stem}.ipynb", "w") as written:
        json.dump(notebook(text, KEPT[path.stem]), written, indent=1, ensure_ascii=False)
