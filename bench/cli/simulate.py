"""`bench simulate` and `bench demo`: simulated measurements with known truth, and their identification."""

from pathlib import Path

import click

from bench.basics.plural import plural
from bench.cli.last_lines import next_line, say, wrote
from bench.cli.options import output_option, scenarios
from bench.cli.progress import quiet_option, shown_progress


@click.command("simulate")
@click.argument("scenario", shell_complete=scenarios)
@output_option("Dataset folder to write.", required=True, callback=None)
@click.option("--seed", type=int, help="Seed for gains and noise, instead of the scenario's.")
@click.option("--overwrite", is_flag=True, help="Replace an existing dataset in DIR.")
@quiet_option
def simulate(scenario: str, output: Path, seed: int | None, overwrite: bool, quiet: bool) -> None:
    """Simulate a scenario and write its measurements as a dataset.

    SCENARIO is a built-in name or the path of a scenario file. The truth goes to DIR.truth.json,
    outside the dataset.
    """
    with shown_progress(quiet) as progress:
        from bench.api.simulate import simulation_of
        from bench.basics.errors import BenchError
        from bench.basics.quiet import stop_step_timers
        from bench.dataset.names import DATASET_FILE
        from bench.truth.dataset import write_simulation

        if (output / DATASET_FILE).exists() and not overwrite:
            raise BenchError(f"{output}: already holds a dataset; --overwrite replaces it")
        stop_step_timers()
        simulation = simulation_of(scenario, seed, progress)
        progress.phase("writing the recordings")
        truth = write_simulation(simulation, output)
    content = f"{plural(len(simulation.recordings), 'recording')}, loop gap {simulation.loop_gap:.1e} m"
    step = next_line(["compare", output], "fits the model and shows where it fails")
    say([wrote(output, f"dataset: {content}"), wrote(truth, "truth"), step])


@click.command("demo")
@output_option(
    "Folder for data, model and pictures.", default=Path("results/demo"), show_default=True, callback=None
)
@click.option(
    "--scenario", shell_complete=scenarios, default="five_bar", show_default=True, help="What to simulate."
)
def demo(output: Path, scenario: str) -> None:
    """Simulate a robot, identify it, and compare with the truth."""
    from rich.console import Console

    from bench.api.diagnose import diagnose
    from bench.basics.quiet import stop_step_timers
    from bench.dataset.dataset import load_dataset
    from bench.document.figures.comparison import current_figure
    from bench.document.figures.write import write_figure
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
    write_figure(output / "currents.png", current_figure(result))
    write_rrd(output / "demo.rrd", result, dataset, truth=true)
    console.print("Searching for physical effects that the model lacks ...")
    run = CommandRun("diagnose", str(output / "dataset"), output=str(output))
    report = write_diagnosis_report(output, diagnose(dataset), dataset, run)
    click.echo(f"Measurements: {output / 'dataset'}, the truth: {output / 'dataset.truth.json'}")
    click.echo(f"Model:        {output / 'model.json'}")
    click.echo(f"Open {report} in a browser, and the robot in motion with: rerun {output / 'demo.rrd'}")
    say([next_line(["open", output / "dataset"], "continues on a page in the browser")])
