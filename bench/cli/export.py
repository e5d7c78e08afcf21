"""`bench export`: an identified model for other programs."""

from pathlib import Path

import click

from bench.cli.last_lines import say, wrote
from bench.cli.options import cad_option, effect_file_option, nearest_option, path_option

FORMATS = ("mjcf", "urdf", "csv", "yaml", "c")


@click.command("export")
@click.argument("model", type=click.Path(path_type=Path), metavar="MODEL.json")
@click.option("--to", "form", type=click.Choice(FORMATS), required=True, help="What to write.")
@path_option("-o", "--output", required=True, metavar="PATH", help="File to write.")
@click.option("--robot", metavar="ROBOT", help="Name or folder. [default: that of the model's dataset]")
@click.option("--payload", metavar="NAME", help="Carried at the tool (mjcf, c).  [default: none]")
@cad_option
@nearest_option("Write")
@effect_file_option
def export(
    model: Path,
    form: str,
    output: Path,
    robot: str | None,
    payload: str | None,
    cad: bool,
    nearest: bool,
    effect_files: tuple[Path, ...],
) -> None:
    """Write an identified model as MJCF, URDF, a table or C.

    MODEL.json is a file from `bench identify --json`. Bodies get physically possible masses and inertias with the
    identified base parameters; masses that the data do not determine stay near those of the MJCF, which only this
    command reads. The control input of an exported motor is its current reference. The command lists what the format
    cannot hold; for MJCF this goes to NAME.twin.json. C is a feed-forward: a function from desired motion to currents,
    with the loops closed.
    """
    from bench.basics.errors import BenchError
    from bench.cli.next_steps import after_export
    from bench.export.c_code import write_c
    from bench.export.identified import load_identified
    from bench.export.mjcf import write_mjcf
    from bench.export.physical import physical_set
    from bench.export.placed import not_placed_lines
    from bench.export.sidecar import sidecar, write_sidecar
    from bench.export.tables import write_csv, write_yaml
    from bench.export.urdf import write_urdf

    if payload is not None and form not in ("mjcf", "c"):
        raise click.UsageError("--payload needs --to mjcf or --to c")
    identified = load_identified(model, robot, effect_files)
    step = after_export(model, form, output, effect_files)
    messages: list[str] = []
    if form == "c":
        lines, written = list(write_c(output, identified, payload)), [output]
    else:
        physical = physical_set(identified, use_cad=cad)
        if physical.contradiction is not None and not nearest:
            raise BenchError(f"{model}: {physical.contradiction.words()}; --nearest writes them anyway")
        messages.append(_bodies_line(physical.distance, physical.prior))
        if physical.guessed:
            messages.append(f"No mass in the MJCF, treated as bars: {', '.join(physical.guessed)}")
        shared = [effect.instance.request for effect in identified.effects if effect.instance.recording]
        messages += [f"Mean of the values of the recordings: {request}" for request in dict.fromkeys(shared)]
        lines, written = [], [output]
        if form == "mjcf":
            exported = write_mjcf(output, physical, payload)
            lines = not_placed_lines(exported.placed.not_placed)
            messages += [f"Changed: {line}" for line in exported.changed]
            written.append(write_sidecar(output, sidecar(physical, exported)))
        elif form == "urdf":
            lines = list(write_urdf(output, physical).not_held)
        else:
            (write_csv if form == "csv" else write_yaml)(output, physical)
    for line in (*messages, *(f"Not held: {line}" for line in lines)):
        click.echo(line)
    say([*map(wrote, written), *step])


def _bodies_line(distance: float, prior: str) -> str:
    if distance == 0.0:
        return f"Physically possible bodies with the identified base parameters, otherwise near {prior}."
    return (
        f"The nearest real bodies, {distance:.2g} standard errors from the identified base parameters, otherwise near "
        f"{prior}."
    )
