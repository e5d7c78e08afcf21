"""Sentences from templates of `str.format`, with additional formats for lists, counts and shares."""

from collections.abc import Sequence
from string import Formatter
from typing import Any

from bench.basics.plural import plural


class _Template(Formatter):
    """Formats. Names: "" separates them by commas, "and" and "or" join the last one by that word, "quoted" quotes
    each. A share: "%". A number or names: "?is|are" chooses the singular or the plural. A number: "# loop", as in "2
    loops".
    """

    def format_field(self, value: Any, format_spec: str) -> str:
        if format_spec.startswith("?"):
            return format_spec[1:].split("|")[(value if isinstance(value, (int, float)) else len(value)) != 1]
        if format_spec.startswith("# "):
            return plural(value, format_spec[2:])
        if format_spec == "%":
            return in_percent(value)
        if isinstance(value, (list, tuple)):
            quoted = map(repr, value) if format_spec == "quoted" else value
            return _joined(value, format_spec) if format_spec in ("and", "or") else ", ".join(quoted)
        return str(super().format_field(value, format_spec))


def say(template: str, **values: Any) -> str:
    """The template filled with these values."""
    return _Template().format(template, **values)


def in_percent(share: float | None, digits: int = 3) -> str:
    """A share in percent with `digits` significant digits, but all digits before the point; "–" for None."""
    if share is None:
        return "–"
    value = 100.0 * share
    return f"{value:.0f} %" if abs(value) >= 10.0**digits else f"{value:.{digits}g} %"


def capital(text: str) -> str:
    """A text with a capital first letter."""
    return text[:1].upper() + text[1:]


def and_list(names: Sequence[str]) -> str:
    """Names as in "a, b and c"; "none" without names."""
    return _joined(names, "and")


def or_list(names: Sequence[str]) -> str:
    """Names as in "a, b or c"; "none" without names."""
    return _joined(names, "or")


def _joined(names: Sequence[str], word: str) -> str:
    if len(names) < 2:
        return names[0] if names else "none"
    return f"{', '.join(names[:-1])} {word} {names[-1]}"
