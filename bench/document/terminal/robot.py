"""The report of a robot's check in a terminal."""

from rich.console import Console
from rich.table import Table as Grid
from rich.text import Text

from bench.basics.plural import plural
from bench.document.layout import TEXT
from bench.document.numbers import pretty_unit
from bench.document.table import Column, Table
from bench.document.terminal.identification import heading, listing, section
from bench.document.terminal.tables import printed
from bench.robot_check.outcome import Check, CheckCode
from bench.robot_check.range_words import without_rounding
from bench.robot_check.report import JointLine, Mobility, RobotReport, Singularity
from bench.robot_check.words import detail_of, name_of, nearest_singularity

UNREAD = {CheckCode.MJCF_UNSUPPORTED, CheckCode.GEOMETRY_UNREADABLE}  # then the loops are unknown
MARKS = {"ok": ("✓", "green"), "note": ("!", "yellow"), "failed": ("✗", "bold red")}


def robot_report(report: RobotReport, console: Console, *, verbose: bool = False) -> None:
    """Print joints, loops, degrees of freedom, singularities and checks, to fit the console's width.

    verbose: list the base parameters, each with its grouping.
    """
    facts = f"{plural(len(report.joints), 'joint')} · {plural(len(report.robot.driven), 'motor')}"
    if report.loops or not any(check.code in UNREAD for check in report.failures):
        facts += f" · {plural(len(report.loops), 'loop') if report.loops else 'no loops'}"
    heading(console, report.robot.name, facts)
    section(console, "Joints", printed(joints_table(report), console.width))
    if report.loops:
        section(console, "Loops", printed(loops_table(report), console.width))
    if report.mobility is not None:
        section(console, "Degrees of freedom", Text(mobility_in_words(report.mobility)))
    if report.singularity is not None:
        section(console, "Singularity", singularity_grid(report.singularity))
    section(console, "Checks", checks_grid(report.checks))
    if report.base is not None:
        title = f"Base parameters: {len(report.base.names)}"
        if verbose:
            grid, base = listing("", "dim", "dim"), report.base
            for name, unit, grouping in zip(base.names, base.units, base.descriptions, strict=True):
                grid.add_row(Text(name), pretty_unit(unit), Text(grouping))
            section(console, title, grid)
        else:
            console.print()
            console.print(Text.assemble((title, "bold"), ("  (--verbose lists them)", "dim")))
    console.print()


def joints_table(report: RobotReport) -> Table:
    """Every joint: kind, the body on which it is mounted, motor, range and home position."""
    joints = report.joints
    homes = [None if joint.home is None else without_rounding(joint.home) for joint in joints]
    return Table(
        (
            Column("joint", [joint.name for joint in joints]),
            Column("kind", [joint.kind for joint in joints]),
            Column("on", [joint.parent for joint in joints], rank=1),
            Column("motor", [joint.gain if joint.actuated else "– passive" for joint in joints], "unit"),
            Column("range", [_range(joint) for joint in joints]),
            Column("home", homes, "number", format=".4g"),
            Column("unit", [{"hinge": "rad", "slide": "m"}.get(joint.kind, "") for joint in joints]),
        ),
        tuple("" if joint.actuated else "weak" for joint in joints),
    )


def loops_table(report: RobotReport) -> Table:
    """Every loop closure: the bodies that it connects, and its gap at home."""
    loops = report.loops
    gaps = [_small(loop.gap) + (f" / {_small(loop.twist)}" if loop.kind == "weld" else "") for loop in loops]
    unit = " / rad" if any(loop.kind == "weld" for loop in loops) else ""
    return Table(
        (
            Column("loop", [loop.name for loop in loops]),
            Column("kind", [loop.kind for loop in loops]),
            Column("holds together", [" – ".join(loop.bodies) for loop in loops], rank=1),
            Column("equations", [loop.equations for loop in loops], "number", format="d"),
            Column(f"gap at home, m{unit}", gaps, "number", format="s"),
        ),
        tuple("poor" if max(loop.gap, loop.twist) > TEXT.exact else "" for loop in loops),
    )


def mobility_in_words(mobility: Mobility) -> str:
    """The degrees of freedom as an equation."""
    sign = "=" if mobility.remaining == mobility.motors else "≠"
    return (
        f"{mobility.tree} of the tree - {mobility.rank} (rank of {mobility.equations} closure equations) "
        f"{f'- {mobility.spins} (idle spins) ' if mobility.spins else ''}"
        f"= {mobility.remaining} {sign} {plural(mobility.motors, 'motor')}"
    )


def singularity_grid(singularity: Singularity) -> Grid:
    """Sentences on home, the reach of each motor, and the nearest singularity."""
    fast = singularity.amplification
    grid = listing("dim", "")
    grid.add_row(
        "at home",
        f"smallest singular value of the closures {singularity.home:.3g} (lengths over {singularity.length:.3g} m)",
    )
    grid.add_row("", f"{fast.passive} moves fastest: {fast.value:.3g} {fast.unit} of {fast.motor}")
    ends = (f"{name} [{low:.4g}, {high:.4g}]" for name, (low, high) in singularity.reach.items())
    grid.add_row("one motor moving", f"reaches {', '.join(ends)}")
    grid.add_row("nearest", nearest_singularity(singularity))
    return grid


def checks_grid(checks: tuple[Check, ...]) -> Grid:
    """Every check with a mark for its outcome."""
    grid = Grid.grid(padding=(0, 2, 0, 0))
    grid.add_column(no_wrap=True)
    grid.add_column()
    grid.add_column(overflow="fold")
    for check in checks:
        mark, style = MARKS[check.verdict]
        detail_style = "dim" if check.verdict == "ok" else style
        grid.add_row(Text(mark, style), Text(name_of(check)), Text(detail_of(check), detail_style))
    return grid


def _small(gap: float) -> str:
    return f"{gap:.1e}" if gap else "0"


def _range(joint: JointLine) -> str:
    if joint.lower is None or joint.upper is None:
        return "–"
    return f"[{joint.lower:.4g}, {joint.upper:.4g}]"
