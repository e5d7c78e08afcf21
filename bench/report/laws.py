"""The law of an effect and what its symbols mean, as its class tells them."""

import inspect
import re

from bench.effects import Effect

_AFTER = re.compile(r" (?:Valid|Source:|The columns? (?:is|are)) .*")  # no longer about symbols


def law_of(effect: Effect) -> tuple[str, str]:
    """The law in a sentence, and its symbols with their units; empty where the effect's class tells none.

    The first two paragraphs of a class's docstring hold them, the second up to where the law is valid.
    """
    text = inspect.getdoc(type(effect)) or ""
    if text.startswith(f"{type(effect).__name__}("):  # what a dataclass says of itself where nobody does
        return "", ""
    law, _, rest = text.partition("\n\n")
    symbols = " ".join(rest.partition("\n\n")[0].split())
    return in_symbols(" ".join(law.split())), in_symbols(_AFTER.sub("", symbols))


def in_symbols(text: str) -> str:
    """A law in plain letters with the signs that one writes: qd as q̇, tau as τ, N*m as N·m, s2 as s²."""
    text = re.sub(r"\bqdd(?=_|\b)", "q̈", text)
    text = re.sub(r"\bqd(?=_|\b)", "q̇", text)
    text = re.sub(r"\b(d?)tau(?=_|\b)", r"\1τ", text)
    text = re.sub(r"(?<=\w)\^2\b|(?<=[/*]m)2\b", "²", text)
    text = re.sub(r"\b(s|rad|A|V)2\b", r"\1²", text)
    text = re.sub(r"\b(s|rad|A|V)3\b", r"\1³", text)
    return re.sub(r"(?<![\w-])-(?=[\w|(])|(?<= )-(?= )", "−", text.replace("*", "·"))
