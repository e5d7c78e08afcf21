"""An identification as Markdown, for the viewer's text panels."""

from bench.document.identification import effects_table, errors_table, gains_table, parameters_table
from bench.document.markdown.tables import markdown
from bench.document.numbers import Truth, settings_lines
from bench.identification.result import Identification


def summary_markdown(result: Identification, truth: Truth | None = None) -> str:
    """Gains, errors, notes and settings: what to look at first."""
    remark = "" if result.gains_fitted else " (nominal: not fitted)"
    effects = ", ".join(result.effects) if result.effects else "rigid bodies only"
    parts = [f"**{result.robot}**, estimator *{result.method}*, {effects}"]
    parts += [f"### Drive gains{remark}", markdown(gains_table(result, truth))]
    if result.effect_parameters:
        parts += ["### Effects", markdown(effects_table(result, truth))]
    errors = errors_table(result.recordings, result.joints)
    parts += ["### Error of the modelled current", markdown(errors)]
    if result.notes:
        parts += ["### Notes", "\n".join(f"- {note}" for note in result.notes)]
    parts += ["### Fit", "\n".join(f"- {line}" for line in settings_lines(result))]
    return "\n\n".join(parts) + "\n"


def parameters_markdown(result: Identification, truth: Truth | None = None) -> str:
    """Every base and payload parameter with its whole grouping."""
    text = f"### Dynamic parameters\n\n{markdown(parameters_table(result, truth, full=True))}\n"
    if result.left_out:
        text += f"\nLeft out, as the data do not need them: {', '.join(result.left_out)}.\n"
    return text
