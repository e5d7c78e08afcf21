"""Pages that stand elsewhere in the project, where its folders need them too; here only their links are turned."""

import posixpath
import re
from pathlib import Path

import mkdocs_gen_files

from bench.studies.sweep.metrics import METRICS, metric_of

ROOT = Path(__file__).resolve().parents[2]
PAGES = {
    "scenarios/README.md": "reference/scenarios.md",
    "scenarios/sweeps/README.md": "reference/sweeps.md",
    "bench/effects/README.md": "reference/effects.md",
    "CONTRIBUTING.md": "contributing.md",
    "CHANGELOG.md": "changelog.md",
    "results/measured/measured.md": "measured.md",
    "results/peers/peers.md": "trust/peers.md",
    "results/excite/excite.md": "trust/excite.md",
    **dict.fromkeys(
        ["results/trust/trust.md"] * (ROOT / "results/trust/trust.md").is_file(), "trust/evaluation.md"
    ),
    **{
        f"results/{kind}/{path.name}": f"trust/{kind}_{path.name}"
        for kind in ("trial", "montecarlo")
        for path in sorted((ROOT / "results" / kind).glob("*.md"))
    },
}
WIDE = ("measured.md", "trust/")  # pages and folders whose tables need the room of the contents
PICTURES = {
    "results/pictures": "pictures",
    "results/trial": "trust",
    "results/trust": "trust",
    "results/atlas": "atlas",
}
FENCED = re.compile(r"(^```.*?^```$)", re.DOTALL | re.MULTILINE)
HEAD = re.compile(r"^\|.*\|$(?=\n\|[-:| ]+\|$)", re.MULTILINE)
LINK = re.compile(r"(?<!!)\[([^\][]+)\]\(([^)#\s]+)(#[^)]*)?\)")


def turned(text: str, source: Path, page: Path) -> str:
    """The text with links to pages of the site where there is one, and without a link to what is not in it."""

    def link(found: re.Match[str]) -> str:
        if "://" in found[2]:
            return found[0]
        target = posixpath.normpath(posixpath.join(source.parent.as_posix(), found[2]))
        if target not in PAGES:
            return found[1]
        up = "../" * (len(page.parts) - 1)
        return f"[{found[1]}]({up}{PAGES[target]}{found[3] or ''})"

    parts = FENCED.split(text)  # what is code stays as it is: every second part
    return "".join(part if i % 2 else HEAD.sub(broken, LINK.sub(link, part)) for i, part in enumerate(parts))


def broken(head: re.Match[str]) -> str:
    """The heads of a table; a name of a metric may go on in the next line, behind a part of it."""
    return re.sub(r"(?<=\w)([._])(?=\w)", r"\1<wbr>", head[0])


def with_words(summary: str) -> str:
    """The summary of a sweep, whose columns go by the names of commands, with what they measure."""
    title, _, rest = summary.partition("\n")
    head = next(line for line in rest.splitlines() if line.startswith("|"))
    names = dict.fromkeys(name.strip().partition(".")[0] for name in head.strip("| ").split("|"))
    told = [f"- `{name}`: {metric_of(name).measures}" for name in names if name in METRICS]
    return f"# Sweep `{title.lstrip('# ')}`\n{rest}\n" + "\n".join(told) + "\n"


for source, page in PAGES.items():
    text = (ROOT / source).read_text(encoding="utf-8")
    with mkdocs_gen_files.open(page, "w") as written:
        written.write("---\nhide: [toc]\n---\n\n" if page.startswith(WIDE) else "")
        written.write(turned(with_words(text) if "/montecarlo_" in page else text, Path(source), Path(page)))
for folder, there in PICTURES.items():
    for picture in sorted((ROOT / folder).glob("*.png")):
        with mkdocs_gen_files.open(f"{there}/{picture.name}", "wb") as copy:
            copy.write(picture.read_bytes())
