"""Which module of the package imports which, read from the source: nothing is executed."""

import ast
from collections.abc import Iterable, Mapping
from pathlib import Path


def modules_of(package: Path) -> dict[str, Path]:
    """Dotted name -> file of every module under the folder of a package."""
    found = {}
    for path in sorted(package.rglob("*.py")):
        parts = path.relative_to(package.parent).with_suffix("").parts
        found[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = path
    return found


def imports_in(source: str, modules: Iterable[str]) -> set[str]:
    """Modules that a source imports anywhere, inside functions and TYPE_CHECKING blocks too.

    `from a import b` counts as `a.b` where that is one of `modules`, otherwise as `a`.
    """
    known = set(modules)
    found = set()
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            if node.level:
                raise ValueError(f"relative import in line {node.lineno}: the package uses absolute ones")
            for alias in node.names:
                inner = f"{node.module}.{alias.name}"
                found.add(inner if inner in known else str(node.module))
    return found


def read_graph(package: Path) -> dict[str, set[str]]:
    """Module -> the modules it imports, of the package and of others."""
    modules = modules_of(package)
    return {name: imports_in(path.read_text(encoding="utf-8"), modules) for name, path in modules.items()}


def within(module: str, package: str) -> bool:
    """Whether a module is `package` or lies in it."""
    return module == package or module.startswith(package + ".")


def chain(graph: Mapping[str, set[str]], start: str, package: str) -> list[str] | None:
    """A shortest chain of imports from `start` to a module in `package`; None if there is none."""
    paths = {start: [start]}
    queue = [start]
    while queue:
        module = queue.pop(0)
        for imported in sorted(graph.get(module, ())):
            if imported in paths:
                continue
            paths[imported] = [*paths[module], imported]
            if within(imported, package):
                return paths[imported]
            queue.append(imported)
    return None
