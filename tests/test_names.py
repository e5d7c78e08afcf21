"""A class has a name of its own, so that a reader who meets it knows where it is from."""

import re
from collections import Counter
from pathlib import Path

CLASS = re.compile(r"^class ([A-Za-z]\w*)", re.MULTILINE)
TWICE = {
    "JointLaw",  # of a twin and of the simulated machine, which share no code
    "Table",  # of a document, and what a law looks its torque up in
}


def test_no_two_classes_have_the_same_name(project_root: Path) -> None:
    files = (
        path
        for path in (project_root / "bench").rglob("*.py")
        if path.parent
        != project_root / "bench" / "truth" / "hidden"  # twins of the effects in bench/effects/laws
    )
    found = Counter(name for path in files for name in CLASS.findall(path.read_text(encoding="utf-8")))
    assert {name for name, count in found.items() if count > 1} == TWICE
