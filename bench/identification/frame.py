"""Tables for notebooks: as data frames, where pandas is installed, and as HTML under a cell."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from html import escape
from typing import TYPE_CHECKING, Any

from bench.basics.errors import BenchError

if TYPE_CHECKING:
    import pandas as pd


def data_frame(columns: Mapping[str, Sequence[Any]]) -> pd.DataFrame:
    """Columns by name as a pandas data frame: what notebooks of engineers read. Raises BenchError without pandas."""
    try:
        import pandas as pd  # noqa: PLC0415 - optional, and slow to import
    except ImportError:
        raise BenchError("a data frame needs pandas: pip install 'parabench[frames]'") from None
    return pd.DataFrame(columns)


def html_table(title: str, rows: Sequence[Mapping[str, str | float]]) -> str:
    """Rows of the same keys as a small table, its title above."""

    def cells(tag: str, values: Sequence[str | float]) -> str:
        texts = (f"{value:.5g}" if isinstance(value, float) else str(value) for value in values)
        return "<tr>" + "".join(f"<{tag}>{escape(text)}</{tag}>" for text in texts) + "</tr>"

    head = cells("th", list(rows[0])) if rows else ""
    body = "".join(cells("td", list(row.values())) for row in rows)
    return f"<p>{escape(title)}</p><table><thead>{head}</thead><tbody>{body}</tbody></table>"
