"""What every command says at its end, what `--quiet` and `--json -` leave of it, and what a misspelt word is told."""

import json
import re
import shutil

import pytest

from bench import cli
from bench.cli import main
from bench.cli.last_lines import after_diagnosis, next_line, say
from bench.cli.next_steps import after_export, after_replay
from bench.identification.finding import Code, Finding
from bench.truth.dataset import write_simulation
from bench.truth.simulate import simulate
from tests.diagnosis_kit import OTHERS, found_diagnosis
from tests.hidden_kit import scenario
from tests.shown import dataset_of

OWN = 4.21  # kg: the five-bar's bodies in its MJCF


@pytest.fixture(scope="module")
def data(tmp_path_factory):
    """A short dataset with friction that no model is told of."""
    folder = tmp_path_factory.mktemp("data")
    hidden = {"effect": "viscous_friction", "joint": "left", "Fv": 0.3}
    write_simulation(simulate(scenario("five_bar", [hidden]), threads=1), folder)
    return folder


def last_line(capsys):
    return capsys.readouterr().out.splitlines()[-1]


def test_the_last_line_is_the_next_command_with_all_that_was_given(data, tmp_path, capsys):
    assert main(["identify", str(data)]) == 0
    assert last_line(capsys).startswith(f"next: bench diagnose {data}    names the")
    assert main(["identify", str(data), "--with", "coulomb_friction:left", "--decimation", "25"]) == 0
    with_options = f"next: bench diagnose {data} --with coulomb_friction:left --decimation 25    names the"
    assert last_line(capsys).startswith(with_options)
    model = tmp_path / "model.json"
    right = ["--with", "viscous_friction:left"]
    assert main(["identify", str(data), *right]) == 0
    assert last_line(capsys) == (
        f"next: bench identify {data} --with viscous_friction:left --json model.json    keeps the model"
    )
    assert main(["identify", str(data), *right, "--json", str(model)]) == 0
    told = capsys.readouterr().out.splitlines()
    assert told[-2] == f"wrote {model} (model)"
    assert told[-1].startswith(f"next: bench compare {data} --model {model} ")
    assert main(["compare", str(data), "--model", str(model)]) == 0
    assert last_line(capsys).startswith(f"next: bench export {model} --to mjcf -o {tmp_path / 'model.xml'} ")
    assert main(["compare", str(data)]) == 0
    assert last_line(capsys).startswith(f"next: bench diagnose {data}    ")


def test_what_is_declared_wrongly_is_to_be_mended_first(data, tmp_path, capsys):
    wrong = tmp_path / "grams"
    shutil.copytree(data, wrong)
    told = (wrong / "dataset.toml").read_text(encoding="utf-8")
    mass = re.search(r"^mass = ([\d.]+)$", told, flags=re.MULTILINE)
    told = told.replace(mass[0], f"mass = {1000.0 * float(mass[1])}")
    (wrong / "dataset.toml").write_text(told, encoding="utf-8")
    assert main(["identify", str(wrong), "--with", "viscous_friction:left"]) == 0
    out = capsys.readouterr().out
    asked = f"The payload disc of 500 kg is far heavier than the robot ({OWN:.3g} kg in its MJCF): is that in grams"
    assert asked in " ".join(out.split())
    assert "is the payload's mass in grams?" in " ".join(out.split())
    again = (
        f"next: bench identify {wrong} --with viscous_friction:left    again, after correcting what the first"
    )
    assert out.splitlines()[-1].startswith(again)
    model = tmp_path / "model.json"
    assert main(["identify", str(data), "--json", str(model), "-q"]) == 0
    for beside in ([], ["--model", str(model)]):
        assert main(["compare", str(wrong), *beside]) == 0
        assert asked in " ".join(capsys.readouterr().out.split())
    meant = told.replace('payload = "disc"', 'payload = "disc"\naccept = ["mass"]')
    (wrong / "dataset.toml").write_text(meant, encoding="utf-8")
    assert main(["compare", str(wrong), "--model", str(model)]) == 0
    assert asked not in " ".join(capsys.readouterr().out.split())


def test_after_a_diagnosis_comes_what_it_calls_for(tmp_path):
    from dataclasses import replace

    from bench.dataset.robot import load_robot
    from bench.diagnosis.result import Discovered

    folder, model = tmp_path / "data", tmp_path / "model.json"
    found = found_diagnosis(dataset_of(load_robot("five_bar")))
    assert found.missing
    step = after_diagnosis(found, folder, f"bench diagnose {folder}", model)
    assert step.startswith(f"next: bench compare {folder} --model {model} ")
    law = tmp_path / "law_left.py"
    step = after_diagnosis(found, folder, "", model, [law])
    assert step.startswith(f"next: bench compare {folder} --model {model} --effect-file {law} ")
    brake = Discovered("left", "law_left", (), {}, 0.002, 0.002, 0.01, None, None, "")
    discovered = replace(found, missing=(), ranking=(), discovered=(brake,))
    step = after_diagnosis(discovered, folder, "", model, [law])
    assert step.startswith(f"next: bench compare {folder} --model {model} --effect-file {law} ")
    step = after_diagnosis(found, folder, f"bench diagnose {folder} --with backlash", None)
    assert step.startswith(f"next: bench diagnose {folder} --with backlash --apply model.json ")
    doubtful = replace(
        OTHERS[0],
        effect="current_delay",
        verdict="indistinguishable",
        alternatives=("current_loop_lag",),
        actuators=("left",),
    )
    undecided = replace(found, missing=(), ranking=(doubtful,))
    step = after_diagnosis(undecided, folder, "", None)
    assert step.startswith(
        f"next: bench discriminate {folder} current_delay:left current_loop_lag:left -o {folder}.motion "
    )
    heavy = Finding(Code.PAYLOAD_HEAVY, ("disc",), numbers={"mass": 500.0, "own": OWN})
    step = after_diagnosis(
        replace(found, after=replace(found.after, findings=(heavy,))), folder, "bench d", model
    )
    assert step == "next: bench d    again, after correcting what the first note says"
    nothing = replace(found, missing=(), ranking=())
    assert after_diagnosis(nothing, folder, "", None).startswith(
        f"next: bench identify {folder} --json model.json "
    )


def test_a_model_and_a_twin_go_on(tmp_path):
    model = tmp_path / "model.json"
    assert after_export(model, "c", tmp_path / "arm.c", ()) == [
        f"next: cc -O2 -c {tmp_path / 'arm.c'}    compiles it for linking with a controller"
    ]
    step = after_replay(tmp_path, model, None, ["--no-cad"])
    assert step.startswith(
        f"next: bench replay {tmp_path} --model {model} --no-cad --rrd {tmp_path / 'model.rrd'} "
    )


def test_a_path_with_blanks_can_be_copied():
    assert next_line(["compare", "my data"]) == "next: bench compare 'my data'"


def test_an_answer_on_standard_output_is_all_that_stands_there(data, capsys, tmp_path):
    assert main(["identify", str(data), "--json", str(tmp_path / "model.json")]) == 0
    capsys.readouterr()
    assert main(["identify", str(data), "--json", "-"]) == 0
    out, err = capsys.readouterr()
    assert json.loads(out) == json.loads((tmp_path / "model.json").read_text())
    assert "Drive gains" in err
    assert "wrote -" not in err
    assert main(["compare", str(data), "--json", "-", "-q"]) == 0
    out, err = capsys.readouterr()
    assert json.loads(out)["robot"] == "five_bar"
    assert err == ""
    assert not (tmp_path / "-").exists()


def test_quiet_says_errors_alone(data, tmp_path, capsys):
    assert main(["identify", str(data), "-q", "--json", str(tmp_path / "model.json")]) == 0
    assert capsys.readouterr() == ("", "")
    assert (tmp_path / "model.json").is_file()
    assert main(["identify", str(tmp_path / "nothing"), "--quiet"]) == 2
    assert capsys.readouterr().err.count("\n") == 1


@pytest.mark.parametrize("name", cli.COMMANDS)
def test_every_command_can_be_quiet(name, capsys):
    words = [name, "check", "--help"] if name == "robot" else [name, "--help"]
    assert main(words) == 0
    assert "--quiet" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("words", "meant"),
    [
        (["identfy"], "identify"),
        (["diagnos", "x"], "diagnose"),
        (["identify", "x", "--jsn", "y"], "--json"),
        (["robot", "chek", "five_bar"], "check"),
    ],
)
def test_a_misspelt_command_or_option_is_told_what_is_meant(words, meant, capsys):
    assert main(words) == 2
    err = capsys.readouterr().err
    assert "Did you mean" in err
    assert meant in err


@pytest.mark.parametrize(
    ("words", "other"),
    [
        (["diagnose", "x", "--robots", "y"], "--verbose"),
        (["identify", "x", "--noise"], "--verbose"),
        (["figures", "x", "--list"], "--quiet"),
        (["fit", "x"], "identify"),
    ],
)
def test_what_is_not_near_is_not_suggested(words, other, capsys):
    assert main(words) == 2
    err = capsys.readouterr().err
    assert "Did you mean" not in err
    assert other not in err


def test_of_several_options_alike_the_nearest_is_meant(capsys):
    for words, meant in (
        (["identify", "x", "--wiht"], "--with"),
        (["import", "x", "--validate"], "--validate-fraction"),
    ):
        assert main(words) == 2
        assert f"Did you mean '{meant}'? (see: bench {words[0]} --help)" in capsys.readouterr().err


def test_the_next_command_is_one_that_works_as_it_is_typed(tmp_path, monkeypatch, capsys):
    line, called = next_line(["open", "my bench"]), tmp_path / "bin" / "parabench"
    called.parent.mkdir()
    called.touch(mode=0o755)
    monkeypatch.setattr("sys.argv", [str(called)])
    for path, program in ((str(called.parent), "parabench"), ("", str(called))):
        monkeypatch.setenv("PATH", path)
        say([line, "wrote bench (report)"])
        assert capsys.readouterr().out == f"next: {program} open 'my bench'\nwrote bench (report)\n"
    monkeypatch.setattr("sys.argv", ["/opt/bench/__main__.py"])
    say([line])
    assert last_line(capsys) == line


@pytest.mark.parametrize(
    ("effect", "meant"), [("viscous_fricton", "'viscous_friction'"), ("viscous_friction:lefd", "'left'")]
)
def test_a_misspelt_effect_or_joint_is_told_what_is_meant(data, effect, meant, capsys):
    assert main(["identify", str(data), "--with", effect]) == 2
    assert f"did you mean {meant}?" in capsys.readouterr().err


def test_the_help_has_its_commands_in_groups(capsys):
    assert main(["--help"]) == 0
    out = capsys.readouterr().out
    headings = [out.index(f"\n{one.section}:") for one in cli.COMMANDS.values()]
    assert headings == sorted(headings)
    assert len(set(headings)) == 3


def test_a_simulation_does_not_replace_a_dataset_unasked(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr("bench.api.simulate.run", lambda *_, **__: pytest.fail("simulated"))
    (tmp_path / "dataset.toml").write_text("")
    assert main(["simulate", "five_bar", "-o", str(tmp_path)]) == 2
    assert "--overwrite replaces it" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "completed"),
    [
        ("bench ident", ["identify"]),
        ("bench identify data --with visc", ["viscous_friction"]),
        ("bench discriminate data coul", ["coulomb_friction"]),
        ("bench import log.csv --robot five", ["five_bar"]),
        ("bench simulate tut", ["tutorial"]),
        ("bench sweep noise_enc", ["noise_encoder"]),
        ("bench identify --difference-o", ["--difference-order"]),
    ],
)
def test_a_shell_completes_commands_options_and_names(words, completed, monkeypatch, capsys):
    monkeypatch.setenv("_BENCH_COMPLETE", "bash_complete")
    monkeypatch.setenv("COMP_WORDS", words)
    monkeypatch.setenv("COMP_CWORD", str(len(words.split()) - 1))
    with pytest.raises(SystemExit):
        main([])
    assert [line.partition(",")[2] for line in capsys.readouterr().out.splitlines()] == completed
