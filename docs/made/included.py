"""Pages that stand elsewhere in the project, where its folders need them too; here only their links are turned."""

import re
from pathlib import Path

import mkdocs_gen_files

ROOT = Path(__file__).resolve().parents[2]
PAGES = {
    "scenarios/README.md": "reference/scenarios.md",
    "scenarios/sweeps/README.md": "reference/sweeps.md",
    "CONTRIBUTING.md": "contributing.md",
    "CHANGELOG.md": "changelog.md",
}
LINK = re.compile(r"\]\(([^)#\s]+)(#[^)]*)?\)")


def turned(text: str, source: Path, page: Path) -> str:
    """The text with links to pages of the site where there is one, and without a link to what is not in it."""

    def link(found: re.Match[str]) -> str:
        if "://" in found[1]:
            return found[0]
        target = (ROOT / source.parent / found[1]).resolve().relative_to(ROOT).as_posix()
        if target not in PAGES:
            return "]"
        up = "../" * (len(page.parts) - 1)
        return f"]({up}{PAGES[target]}{found[2] or ''})"

    text = LINK.sub(link, text)
    return re.sub(r"(?<!!)\[([^\][]+)\](?![(\[:])", r"\1", text)


for source, page in PAGES.items():
    with mkdocs_gen_files.open(page, "w") as written:
        written.write(turned((ROOT / source).read_text(encoding="utf-8"), Path(source), Path(page)))
