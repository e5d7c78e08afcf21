"""A dataset to try the workbench on, and a diagnosis of it."""

from bench.diagnosis.reason import Because, Reason
from bench.diagnosis.result import Diagnosis, EffectVerdict, LadderStep, Remainder, Unexplained
from bench.effects import CATALOGUE
from bench.identification.identify import identify
from bench.identification.prepare import prepare
from bench.identification.problem import problem_of
from bench.page.parts import Page, Section
from bench.page.render import Workbench, render_page
from bench.page.workbench.page_data import with_command
from bench.page.workbench.page_files import script, style
from bench.scenario.scenario import load_scenario
from bench.truth.dataset import write_simulation
from bench.truth.simulate import simulate
from tests.hidden_kit import STEP

FRICTION = (
    {"effect": "coulomb_friction", "joint": "left", "Fc": 0.2},
    {"effect": "viscous_friction", "joint": "left", "Fv": 0.1},
)
FOUND = ("coulomb_friction:left", "viscous_friction:left")
ABSORBED = ("payload_mass_error", "rotor_inertia")


RECORDINGS = (
    ("free", "identify", 1, False),
    ("held", "identify", 2, True),
    ("free_check", "validate", 3, False),
    ("held_check", "validate", 4, True),
)


def write_page(path, data, model=None):
    """A page with nothing but the workbench."""
    page = Page("A page", (), (), (), (Section("ranking", "Ranking", "", ()),), "")
    tool = Workbench(with_command(data, "bench identify 'my data'", model), script(), style())
    path.write_text(render_page(page, tool), encoding="utf-8")
    return path


def write_dataset(folder, robot="five_bar", hidden=FRICTION, duration=6.0, recordings=RECORDINGS, step=STEP):
    """A short dataset with two recordings to fit and two to judge on, or others: name, use, seed, loaded."""
    payload = next(iter(load_scenario(robot).settings.payloads))
    tables = [
        {"name": name, "use": use, "design": {"seed": seed}, **({"payload": payload} if loaded else {})}
        for name, use, seed, loaded in recordings
    ]
    design = {"optimise": False, "duration": duration, "ramp": 0.5}
    changes = {"design": design, "recordings": tables, "hidden": list(hidden), "step": step}
    write_simulation(simulate(load_scenario(robot, changes), threads=1), folder)
    return folder


def diagnosis_of(dataset, found=FOUND, names=tuple(CATALOGUE), filters=None, held_out=0.0):
    """A diagnosis that found these effects and ranks these, without the search."""
    before, after = (
        identify(prepare(problem_of(dataset, filters=filters))),
        identify(prepare(problem_of(dataset, found, filters=filters))),
    )
    present = {one.partition(":")[0] for one in found}
    ranking = tuple(
        EffectVerdict(
            name,
            "missing" if name in present else "absorbed" if name in ABSORBED else "not supported",
            before.error.validate,
            after.error.validate,
            1.0,
            (),
            (),
            {},
            Reason(Because.EXPLAINS),
        )
        for name in sorted(names, key=lambda name: name not in present)
    )
    steps = (
        LadderStep((), before.error.identify, before.error.validate),
        LadderStep(tuple(present), after.error.identify, after.error.validate),
    )
    left = Unexplained(Remainder.NOISE, after.error.validate, after.error.validate, ())
    return Diagnosis(
        dataset.robot.name,
        held_out,
        tuple(present),
        steps,
        ranking,
        left,
        before,
        after,
    )
