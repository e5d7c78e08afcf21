"""Names that tell a reader what a thing is, and where it is from."""

import ast
import re
from collections import Counter
from pathlib import Path

CLASS = re.compile(r"^class ([A-Za-z_]\w*)", re.MULTILINE)
VAGUE = re.compile(r"\b(?:found|told|own|left|here|beside|stands)\b", re.IGNORECASE)
MOST_VAGUE = 280  # in code and handbook: keys of JSON, columns, joints named left, plain English
CONSTANT = re.compile(r"^_?[A-Z][A-Z0-9_]*(?:: [^=\n]*)? = \(?-?[0-9]", re.MULTILINE)
MOST_CONSTANTS = {"identification": 10, "diagnosis": 10, "": 400}  # with a number, by room, and in all
TWICE: set[str] = set()


def test_no_two_classes_have_the_same_name(project_root: Path) -> None:
    files = (
        path
        for path in (project_root / "bench").rglob("*.py")
        if path.parent
        != project_root / "bench" / "truth" / "hidden" / "laws"  # twins of the effects in bench/effects/laws
    )
    found = Counter(name for path in files for name in CLASS.findall(path.read_text(encoding="utf-8")))
    assert {name for name, count in found.items() if count > 1} == TWICE


def test_the_map_of_the_rooms_has_each_of_them_in_the_order_of_imports(project_root: Path) -> None:
    """A room stands below what it imports, in CONTRIBUTING.md as in the tree."""
    text = (project_root / "CONTRIBUTING.md").read_text(encoding="utf-8")
    table = text.partition("| room |")[2].partition("\n\n")[0]
    rows = [re.findall(r"`(\w+)`", line.split("|")[1]) for line in table.splitlines()[2:]]
    row_of = {room: i for i, rooms in enumerate(rows) for room in rooms}
    bench = project_root / "bench"
    assert set(row_of) == {path.name for path in bench.iterdir() if (path / "__init__.py").is_file()}
    for room, row in row_of.items():
        sources = (path.read_text(encoding="utf-8") for path in (bench / room).rglob("*.py"))
        used = {
            name for source in sources for name in re.findall(r"^ *from bench\.(\w+)", source, re.MULTILINE)
        }
        assert all(row_of[name] <= row for name in used & row_of.keys()), room


def test_what_is_gone_through_is_called_by_a_noun(project_root: Path) -> None:
    """`for recording in recordings`: a reader sees what it is without looking for where it comes from."""
    empty = {"one", "obj"}
    found = []
    for path in (project_root / "bench").rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            name = node.id if isinstance(node, ast.Name) else node.arg if isinstance(node, ast.arg) else ""
            if name in empty:
                found.append(f"{path.relative_to(project_root)}:{node.lineno}")
    assert not found


def test_names_and_docstrings_say_what_a_value_is(project_root: Path) -> None:
    """`findings`, not `found`; `residual`, not `left`: these words say only where a value comes from."""
    paths = [
        project_root / "README.md",
        *(project_root / "bench").rglob("*.py"),
        *(project_root / "docs").rglob("*.md"),
    ]
    counts = Counter(
        word.lower() for path in paths for word in VAGUE.findall(path.read_text(encoding="utf-8"))
    )
    assert counts.total() <= MOST_VAGUE, counts


def test_numbers_are_fields_of_values_rather_than_constants_of_modules(project_root: Path) -> None:
    for room, most in MOST_CONSTANTS.items():
        paths = (project_root / "bench" / room).rglob("*.py")
        assert sum(len(CONSTANT.findall(path.read_text(encoding="utf-8"))) for path in paths) <= most, room


def test_in_scripts_too(project_root: Path) -> None:
    """Comments and texts aside; one that is a property is named elsewhere."""
    apart = re.compile(
        r"/\*.*?\*/|//[^\n]*|\"[^\"\n]*\"|: one of \$|(?:the|becomes|old|new) ones?\b", re.DOTALL
    )
    for path in (project_root / "bench").rglob("assets/*.js"):
        assert not re.search(r"\bone\b", apart.sub("", path.read_text(encoding="utf-8"))), path


def test_whether_gains_are_fitted_travels_with_what_is_asked(project_root: Path) -> None:
    """In a Problem, its equations, or the gains themselves; a user's face and numeric kernels aside."""
    given = {
        (path.name, node.name)
        for path in (project_root / "bench").rglob("*.py")
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.FunctionDef)
        and any(argument.arg == "fit_gains" for argument in (*node.args.args, *node.args.kwonlyargs))
    }
    assert given == {
        ("identify.py", "identify"),
        ("problem.py", "problem_of"),
        ("bilinear.py", "at"),
        ("current_error.py", "minimum_on_factors"),
        ("robust.py", "_likeliest"),
        ("solve_only.py", "_weighted"),
    }
