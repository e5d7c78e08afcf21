"""`bench demo`: the main job from scenario to drive gains."""

from pathlib import Path

import click

from bench.cli.last_lines import next_line, say
from bench.cli.options import path_option, scenarios


@click.command("demo")
@path_option(
    "-o",
    "--output",
    default=Path("results/demo"),
    show_default=True,
    metavar="DIR",
    help="Folder for data, model and pictures.",
)
@click.option(
    "--scenario", shell_complete=scenarios, default="five_bar", show_default=True, help="What to simulate."
)
def demo(output: Path, scenario: str) -> None:
    """Simulate a robot, identify it, and compare with the truth."""
    from rich.console import Console

    from bench.api.diagnose import diagnose
    from bench.dataset.dataset import load_dataset
    from bench.document.figures.comparison import write_current_figure
    from bench.document.terminal.identification import identification_report
    from bench.excitation.scenario import load_designed
    from bench.identification.identify import fit
    from bench.identification.model_file import save_model
    from bench.identification.prepare import prepare
    from bench.identification.problem import problem_of
    from bench.page.section_run import CommandRun
    from bench.page.write import write_diagnosis_report
    from bench.studies.sweep.accuracy import true_values
    from bench.truth.dataset import write_simulation
    from bench.truth.report import truth
    from bench.truth.simulate import simulate
    from bench.truth.timers import stop_step_timers
    from bench.viewer.recording import write_rrd

    console = Console()
    console.print(f"Designing exciting trajectories for {scenario} ...")
    loaded, trajectories = load_designed(scenario)
    console.print(
        "Simulating the machine in MuJoCo, with drive gains and noise unknown to the identification ..."
    )
    stop_step_timers()
    simulation = simulate(loaded, trajectories)
    write_simulation(simulation, output / "dataset")
    console.print("Identifying from what was logged ...")
    dataset = load_dataset(output / "dataset")
    prepared = prepare(problem_of(dataset))
    result = fit(prepared)
    true = true_values(prepared.model, truth(simulation))
    identification_report(result, console, truth=true)
    save_model(result, output / "model.json", dataset.folder)
    write_current_figure(output / "currents.png", result)
    write_rrd(output / "demo.rrd", result, dataset, truth=true)
    console.print("Searching for physical effects that the model lacks ...")
    run = CommandRun("diagnose", str(output / "dataset"), output=str(output))
    report = write_diagnosis_report(output, diagnose(dataset), dataset, run)
    click.echo(f"Measurements: {output / 'dataset'}, the truth: {output / 'dataset.truth.json'}")
    click.echo(f"Model:        {output / 'model.json'}")
    click.echo(f"Open {report} in a browser, and the robot in motion with: rerun {output / 'demo.rrd'}")
    say([next_line(["open", output / "dataset"], "continues on a page in the browser")])
