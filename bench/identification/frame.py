"""Tables as data frames, where pandas is installed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
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
