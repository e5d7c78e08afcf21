"""The simulated truth and the model that is fitted to it share no code, and data flows one way."""

import ast

import pytest

from tests.import_graph import chain, modules_of, read_graph, within

TRUTH = ("bench.scenario.scenario", "bench.truth")
MODEL = (
    "bench.residuals",
    "bench.diagnosis",
    "bench.effects",
    "bench.identification",
    "bench.model",
    "bench.signals",
)
ABOVE = (
    "bench.api",
    "bench.benchmarks",
    "bench.cli",
    "bench.document",
    "bench.excitation",
    "bench.page",
    "bench.robot_check",
    "bench.studies",
)

# A room within a room: it stands on the rest, or the rest stands on it.
UPSTAIRS = ("bench.basics.files", "bench.dataset.logs", "bench.diagnosis.discovery", "bench.export.replay")
DOWNSTAIRS = ("bench.page.workbench",)

# The one place of the model that reads the MJCF, and all that it may call there: names, no dynamics.
GEOMETRY = "bench.model.geometry"
READERS = {GEOMETRY, "bench.model.supported"}
GEOMETRY_MAY_CALL = {"mj_id2name", "mj_name2id"}
DYNAMIC_PROPERTIES = ("mass", "inertia", "ipos", "iquat", "armature", "damping", "friction", "stiffness")

# Importing by a computed name would escape every check here.
MAY_IMPORT_BY_NAME = {
    "bench",
    "bench.cli.lazy",
    "bench.local.worker",  # what its process is to do: `bench.local.server` names it
    "bench.effects.user_file",  # a user's own effect
    "bench.studies.sweep.dask_pool",  # an optional dependency
    "bench.benchmarks.peers.figaroh_arm",  # versions of the peers
    "bench.benchmarks.peers.__main__",  # versions of the peers
    "bench.benchmarks.peers.mujoco_sysid",  # versions of the peers
    "bench.basics.versions",  # versions of what is installed
    "bench.basics.class_files",  # effects, one file each: the checks below read them too
}


@pytest.fixture(scope="module")
def graph(project_root):
    return read_graph(project_root / "bench")


def broken(graph, sources, forbidden):
    """Every chain of imports from `sources` to `forbidden`, as text."""
    starts = [module for module in graph if any(within(module, source) for source in sources)]
    chains = [chain(graph, start, target) for start in starts for target in forbidden]
    return [" -> ".join(found) for found in chains if found]


def test_truth_imports_nothing_of_the_model(graph):
    assert broken(graph, TRUTH, MODEL) == []


def test_model_imports_nothing_of_the_truth(graph):
    assert broken(graph, MODEL, TRUTH) == []


def test_neither_imports_what_brings_them_together(graph):
    assert broken(graph, TRUTH + MODEL, ABOVE) == []


def test_only_geometry_of_the_model_reads_mujoco(graph):
    readers = {module for module, imported in graph.items() if any(within(i, "mujoco") for i in imported)}
    assert {m for m in readers if any(within(m, package) for package in MODEL)} <= READERS


def test_truth_does_not_use_the_model_s_library(graph):
    users = {module for module, imported in graph.items() if any(within(i, "pinocchio") for i in imported)}
    assert [m for m in users if any(within(m, package) for package in TRUTH)] == []


@pytest.mark.parametrize("reader", sorted(READERS))
def test_geometry_reads_no_dynamics(project_root, reader):
    path = modules_of(project_root / "bench")[reader]
    attributes = {
        node.attr for node in ast.walk(ast.parse(path.read_text())) if isinstance(node, ast.Attribute)
    }
    assert {a for a in attributes if a.startswith("mj_")} <= GEOMETRY_MAY_CALL
    assert "MjData" not in attributes
    assert [a for a in attributes if any(word in a for word in DYNAMIC_PROPERTIES)] == []


def test_a_room_within_a_room_is_above_or_below_the_rest(graph):
    for inner in UPSTAIRS + DOWNSTAIRS:
        outer = inner.rpartition(".")[0]
        rest = [m for m in graph if within(m, outer) and m != outer and not within(m, inner)]
        of_inner = [m for m in graph if within(m, inner)]
        assert rest
        assert of_inner
        lower, upper = (rest, of_inner) if inner in UPSTAIRS else (of_inner, rest)
        back = {m: [i for i in graph[m] if any(within(i, u) for u in upper)] for m in lower}
        assert {m: found for m, found in back.items() if found} == {}


def test_modules_import_from_where_a_thing_is_defined(graph):
    """`from bench import x` inside the package would hide whom it depends on."""
    assert [module for module, imported in graph.items() if "bench" in imported] == []


def test_no_import_by_computed_name(graph, project_root):
    users = {
        name
        for name, path in modules_of(project_root / "bench").items()
        if any(within(i, "importlib") for i in graph[name]) or "__import__" in path.read_text()
    }
    assert users <= MAY_IMPORT_BY_NAME


def test_checks_see_direct_indirect_and_hidden_imports(tmp_path):
    package = tmp_path / "bench"
    sources = {
        "__init__.py": "",
        "truth/__init__.py": "",
        "truth/direct.py": "from bench.model import tree",
        "truth/indirect.py": "import bench.helper",
        "truth/hidden.py": "def f():\n    from bench.model.tree import g",
        "truth/typed.py": "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    import bench.model.tree",
        "truth/innocent.py": "import bench.dataset.robot, bench.modelling",
        "helper.py": "import bench.between",
        "between.py": "import bench.model",
        "model/__init__.py": "",
        "model/tree.py": "",
        "robot.py": "",
        "modelling.py": "",
    }
    for name, source in sources.items():
        (package / name).parent.mkdir(parents=True, exist_ok=True)
        (package / name).write_text(source)
    assert broken(read_graph(package), ("bench.truth",), ("bench.model",)) == [
        "bench.truth.direct -> bench.model.tree",
        "bench.truth.hidden -> bench.model.tree",
        "bench.truth.indirect -> bench.helper -> bench.between -> bench.model",
        "bench.truth.typed -> bench.model.tree",
    ]
