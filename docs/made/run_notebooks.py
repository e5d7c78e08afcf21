"""Run the notebooks cell by cell and keep what they print: `python docs/made/run_notebooks.py [NAME ...]`.

The pages of the handbook show what is kept in docs/notebooks/outputs.json; a test runs the cells and compares.
"""

import ast
import contextlib
import io
import json
import re
import sys
from pathlib import Path
from typing import Any

FOLDER = Path(__file__).resolve().parents[1] / "notebooks"
OUTPUTS = FOLDER / "outputs.json"
CELL = re.compile(r"^# %%( \[markdown\])?\n", re.MULTILINE)


def run(path: Path) -> tuple[dict[str, Any], list[str]]:
    """The names that a notebook leaves, and what each of its code cells prints; a last expression shows itself."""
    _, *parts = CELL.split(path.read_text(encoding="utf-8"))
    names: dict[str, Any] = {"__name__": "notebook"}
    printed = []
    for kind, cell in zip(parts[::2], parts[1::2], strict=True):
        if kind is not None:
            continue
        tree = ast.parse(cell)
        last = tree.body.pop() if tree.body and isinstance(tree.body[-1], ast.Expr) else None
        with contextlib.redirect_stdout(io.StringIO()) as out:
            exec(compile(tree, str(path), "exec"), names)
            value = None
            if isinstance(last, ast.Expr):
                value = eval(compile(ast.Expression(last.value), str(path), "eval"), names)
        shown = "" if value is None or isinstance(value, int) else f"{value!r}\n"
        printed.append(out.getvalue() + shown)
    return names, printed


def main(names: list[str]) -> None:
    """Run these notebooks, all without a name, and keep what they print."""
    kept = json.loads(OUTPUTS.read_text(encoding="utf-8")) if OUTPUTS.exists() else {}
    for path in sorted(FOLDER.glob("*.py")):
        if not names or path.stem in names:
            kept[path.stem] = run(path)[1]
    text = json.dumps(dict(sorted(kept.items())), indent=1, ensure_ascii=False)
    OUTPUTS.write_text(text + "\n", encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
