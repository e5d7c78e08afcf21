"""The runs of a sweep: their order, what they share, and what is refused before they start."""

import re
from itertools import pairwise

import pytest

from bench.basics.errors import BenchError
from bench.effects.catalogue import CATALOGUE
from bench.studies.sweep.command import extent
from bench.studies.sweep.plan import make_plan
from bench.studies.sweep.preflight import check_plan, fixed_declarations
from bench.studies.sweep.sweep_file import IdentifyTable, SweepTable, built_in_sweeps, load_sweep
from bench.truth.hidden import HIDDEN_EFFECTS
from tests.sweep_stand_in import plan_of


def of(tmp_path, axes="", head='base = "five_bar"'):
    return plan_of(tmp_path, f"{head}\n[axes]\n{axes}\n")


def runs_of(plan):
    return [plan.run(i) for i in range(plan.size)]


def test_all_combinations_come_once(tmp_path):
    plan = plan_of(tmp_path, seeds=2)
    assert plan.size == 3 * 3 * 2 * 2
    found = {(run.seed, *run.axes.values()) for run in runs_of(plan)}
    assert len(found) == plan.size


def test_runs_that_share_work_stand_side_by_side(tmp_path):
    plan = plan_of(tmp_path, seeds=4)
    motions = [run.motion for run in runs_of(plan)]
    assert sum(a != b for a, b in pairwise(motions)) + 1 == len(set(motions)) == 3
    tasks = list(plan.tasks())
    assert {len(task) for task in tasks} == {2}, "estimators share the equations"
    assert len({task[0].equations for task in tasks}) == len(tasks) == 3 * 3 * 4
    assert len({run.design for run in runs_of(plan)}) == 1


@pytest.mark.parametrize(
    ("axes", "noted"),
    [
        ('"payloads.disc.mass" = [0.1, 0.2]', True),
        ('"payloads.disc.inertia" = [[1e-3, 1e-3, 1e-3, 0, 0, 0]]', False),
        ('"payloads.disc.mass" = [0.1, 0.2]\n"payloads.disc.declared.mass" = [0.1, 0.2]', False),
        ('method = ["ls", "wls"]', False),
    ],
)
def test_a_declared_value_that_stays_while_the_truth_varies_is_noted(tmp_path, axes, noted):
    head = 'base = "five_bar"\nscenario = { payloads.disc.declared.mass = 0.5 }'
    notes = fixed_declarations(of(tmp_path, axes, head))
    assert bool(notes) is noted
    assert all("declares 0.5 in every run" in note for note in notes)


@pytest.mark.parametrize(
    ("axis", "designs", "motions", "equations"),
    [
        ('method = ["ls", "wls"]', 1, 1, 1),
        ('effects = [[], ["viscous_friction"]]', 1, 1, 2),
        ('"filter.decimation" = [20, 40]', 1, 1, 2),
        ('"sensors.encoder_bits" = [16, 20]', 1, 1, 2),
        ('"payloads.disc.declared.mass" = [0.5, 0.51]', 1, 1, 2),
        ('"gains.error" = [0.1, 0.2]', 1, 2, 2),
        ('"payloads.disc.mass" = [0.1, 0.2]', 1, 2, 2),
        ('"controller.damping" = [0.7, 1.0]', 1, 2, 2),
        ('"design.span" = [0.5, 0.6]', 2, 2, 2),
        ('"recordings.loaded.design.seed" = [5, 6]', 2, 2, 2),
        ('base = ["five_bar", "delta"]', 2, 2, 2),
    ],
)
def test_what_an_axis_makes_necessary(tmp_path, axis, designs, motions, equations):
    plan = of(tmp_path, axis)
    runs = runs_of(plan)
    assert len({run.design for run in runs}) == designs
    assert len({run.motion for run in runs}) == motions
    assert len({run.equations for run in runs}) == equations
    counted = extent(plan, trial=False)
    assert (counted.designs, counted.motions, counted.sets) == (designs, motions, equations)


def test_seeds_share_the_simulation_unless_they_change_the_gains(tmp_path):
    plan = of(tmp_path, head='base = "five_bar"\nseeds = 5')
    assert len({run.motion for run in runs_of(plan)}) == 1
    drawn = of(
        tmp_path,
        '"gains.error" = { draw = "uniform", from = -0.2, to = 0.2 }',
        'base = "five_bar"\nseeds = 5',
    )
    assert len({run.motion for run in runs_of(drawn)}) == 5
    within = of(tmp_path, "", 'base = "five_bar"\nseeds = 5\n[scenario.gains]\nerror = 0\nerror_within = 0.1')
    assert len({run.motion for run in runs_of(within)}) == 5
    assert extent(within, trial=False).motions == 5


def test_trajectories_can_be_designed_for_every_payload(tmp_path):
    plan = of(tmp_path, '"payloads.disc.mass" = [0.1, 0.2]', 'base = "five_bar"\ndesign = "each"')
    assert len({run.design for run in runs_of(plan)}) == 2
    assert extent(plan, trial=False).designs == 2


def test_a_draw_is_the_same_at_every_grid_point_of_its_seed(tmp_path):
    axes = '"gains.error" = { draw = "normal", mean = 0, std = 0.1 }\n"sensors.encoder_bits" = [16, 20]'
    plan = of(tmp_path, axes, 'base = "five_bar"\nseeds = [3, 9]')
    drawn = {(run.seed, run.axes["sensors.encoder_bits"]): run.axes["gains.error"] for run in runs_of(plan)}
    assert drawn[3, 16] == drawn[3, 20] != drawn[9, 16] == drawn[9, 20]
    alone = of(tmp_path, axes, 'base = "five_bar"\nseeds = [9]')
    assert alone.run(0).axes["gains.error"] == drawn[9, 16]


def test_content_is_the_base_with_the_settings_of_the_run(tmp_path):
    head = (
        'base = "five_bar"\nseeds = [4]\n[scenario]\nlog_rate = 500.0\n[scenario.payloads.disc]\nmass = 1.5'
    )
    run = of(tmp_path, '"sensors.encoder_bits" = [16]', head).run(0)
    assert run.content["seed"] == 4
    assert run.content["log_rate"] == 500.0
    assert run.content["payloads"]["disc"]["mass"] == 1.5
    assert run.content["payloads"]["disc"]["center_of_mass"] == [0.0, 0.0, 0.02]
    assert run.content["sensors"] == {"encoder_bits": 16, "current_noise_ratio": 0.01}


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ('base = "five_bra"', "five_bra"),
        ("seeds = 3", "base"),
        ('base = "five_bar"\nseeds = 0', "seeds"),
        ('base = "five_bar"\nseeds = [1, 1]', "given twice"),
        ('base = "five_bar"\nsede = 3', "sede"),
        ('base = "five_bar"\nrecord = ["everything"]', "record"),
        ('base = "five_bar"\nshow = ["gain_eror"]', "gain_eror"),
        ('base = "five_bar"\n[[plots]]\nx = "method"\ny = "gain_error"', "'method' is not an axis"),
        ('base = "five_bar"\n[axes]\nseed = [1, 2]', "seeds have their key"),
        ('base = "five_bar"\n[axes]\nmethod = ["lss"]', "'lss' is not one of"),
        ('base = "five_bar"\n[axes]\neffects = [["visocus_friction"]]', "visocus_friction"),
        ('base = "five_bar"\n[axes]\neffects = ["viscous_friction"]', "effects"),
        ('base = "five_bar"\n[axes]\n"sensors.encoder_bit" = [12]', "encoder_bit"),
        (
            'base = "five_bar"\n[axes]\n"sensors.encoder_bits" = [12, 14, -1]',
            "run 2 (sensors.encoder_bits = -1)",
        ),
        ('base = "five_bar"\n[axes]\n"sensors.encoder_resolution" = [0.0, 1e-3]', "only one of"),
        (
            'base = "five_bar"\n[axes]\n"gains.error.left" = [0.1]\n"gains.error" = [0.1]',
            "varies gains.error.left already",
        ),
        ('base = "five_bar"\n[axes]\n"gains.error.middle" = [0.1]', "middle"),
        ('base = "five_bar"\n[axes]\n"recordings.loda.use" = ["identify"]', "the list has no 'loda'"),
        ('base = "five_bar"\n[axes]\nrobot = ["five_bar", "six_bar"]', "six_bar"),
        ('base = "five_bar"\nseeds = 9000\n[axes]\n"gains.error" = {from=0,to=1,count=200}', "1800000 runs"),
        (
            'base = "five_bar"\nseeds = 50\n[axes]\n"payloads.disc.mass" = {draw="normal", mean=0.05, std=0.05}',
            "payloads.disc.mass",
        ),
        ('base = "five_bar"\n[scenario]\nhidden = [{effect = "gremlins"}]', "gremlins"),
        ('base = "five_bar"\nseeds = -2', "seeds: should be how many, at least 1"),
        ('base = "five_bar"\nseeds = "20"', "seeds: should be how many, at least 1"),
        ('base = "five_bar"\nseeds = []', "seeds: should be how many, at least 1"),
        ('base = "five_bar"\nseeds = 10000000000000000000000', "seeds: should be at most 1000000"),
        ('base = "five_bar"\n[axes]\n"gains.error" = {}', "axes.gains.error: should be a list"),
        ('base = "five_bar"\n[axes]\n"gains.error" = []', "at least one value"),
        ('base = "five_bar"\n[axes]\n"gains.error" = {from=0,to=1,count=1000000000}', "count"),
        ('base = "five_bar"\n[axes]\n"gains.error" = {from=0,to=1,step=1e-12}', "at most 100000 values"),
        (
            'base = "five_bar"\n[axes]\n"gains.error" = {draw="uniforn",from=0,to=1}',
            "draw: 'uniforn' is not one of uniform",
        ),
        ('base = "five_bar"\n[axes]\n"gains.error" = [-20, 20]', "an error of 20 % is 0.2"),
        ('base = "five_bar"\n[axes]\nessential = [true, "yes"]', "essential"),
        (
            'base = "five_bar"\n[axes]\n"payloads.disk.mass" = [0.1]',
            "no recording has the payload 'disk'; used: disc",
        ),
        (
            'base = "five_bar"\n[axes]\nhidden_effect = ["coulomb_friction"]\nhidden_share = [10]',
            "hidden_share: should be a number from 0 to 1",
        ),
        (
            'base = "five_bar"\n[scenario]\nhidden_joint = "middle"\nhidden_effect = "backlash"\nhidden_share = 0.1',
            "no actuated joint 'middle'",
        ),
        (
            'base = "five_bar"\nshow = ["gain_error.lefft"]',
            "should be gain_error.JOINT, with one of left, right",
        ),
        ('base = "five_bar"\nshow = ["gain_std"]', "should be gain_std.JOINT"),
        ('base = "five_bar"\nshow = ["error"]', "should be error.identify or error.validate"),
        ('base = "five_bar"\nshow = ["parameter_error"]', 'record = ["accuracy", "parameters"]'),
        ('base = "five_bar"\nshow = ["diagnosis.missed"]', "needs `diagnose = true`"),
        ('base = "five_bar"\n[[plots]]\nx = "seed"\ny = "gain_within.middle"', "plots: 'gain_within.middle'"),
        ('base = "five_bar"\n[[plots]]\nx = "drive_gain.left"\ny = "gain_error"', "is not recorded"),
    ],
)
def test_a_mistake_is_found_before_anything_runs(tmp_path, text, told):
    with pytest.raises(BenchError) as caught:
        check_plan(plan_of(tmp_path, text))
    message = str(caught.value)
    assert "\n" not in message
    assert told in message


def test_ten_thousand_runs_are_planned_one_at_a_time(tmp_path):
    plan = plan_of(tmp_path, seeds=600)
    assert plan.size == 10_800
    assert plan.run(10_799).number == 10_799
    with pytest.raises(IndexError):
        plan.run(10_800)


@pytest.mark.parametrize("name", built_in_sweeps())
def test_built_in_sweeps_are_sound(name):
    plan = make_plan(load_sweep(name))
    check_plan(plan)
    assert plan.sweep.table.description
    assert plan.sweep.table.show


def test_sweeps_of_effects_have_all_of_them():
    def swept(name):
        axes = {axis.name: axis for axis in load_sweep(name).axes}
        return [point.label for point in axes["hidden_effect"].points]

    assert swept("diagnosis") == sorted(CATALOGUE)
    assert swept("hidden_effects") == sorted(
        HIDDEN_EFFECTS.keys() - {"acceleration_dependent_friction", "product_law"}
    )


def test_there_are_a_dozen_sweeps():
    assert len(built_in_sweeps()) >= 12


def test_the_readme_names_every_key(project_root):
    text = (project_root / "scenarios" / "sweeps" / "README.md").read_text()
    for key in SweepTable.model_fields:
        assert re.search(rf"^\| `\[*{key}\]*` ", text, re.MULTILINE), key
    for key in IdentifyTable.model_fields:
        assert f"`{key}`" in text
