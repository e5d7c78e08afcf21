"""`bench simulate`: measurements with known truth."""

from pathlib import Path

import click

from bench.basics.plural import plural
from bench.cli.last_lines import next_line, say, wrote
from bench.cli.options import path_option, scenarios
from bench.cli.progress import quiet_option, shown_progress


@click.command("simulate")
@click.argument("scenario", shell_complete=scenarios)
@path_option("-o", "--output", required=True, metavar="DIR", help="Dataset folder to write.")
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
        from bench.dataset.names import DATASET_FILE
        from bench.truth.dataset import write_simulation
        from bench.truth.timers import stop_step_timers

        if (output / DATASET_FILE).exists() and not overwrite:
            raise BenchError(f"{output}: already holds a dataset; --overwrite replaces it")
        stop_step_timers()
        simulation = simulation_of(scenario, seed, progress)
        progress.phase("writing the recordings")
        truth = write_simulation(simulation, output)
    count = len(simulation.recordings)
    gap = f"loop gap {simulation.loop_gap:.1e} m"
    say(
        [
            wrote(output, f"dataset: {plural(count, 'recording')}, {gap}"),
            wrote(truth, "truth"),
            next_line(["compare", output], "fits the model and shows where it fails"),
        ]
    )
