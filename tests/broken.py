"""Broken datasets and robots: each a good dataset with one thing spoilt, and what its error must name.

BROKEN maps a name to (spoil, expected): `spoil(folder)` breaks the dataset that
`tests.good_data.write_good_dataset(folder)` wrote; every text of `expected` must stand in the one-line error.
"""

from tests import broken_descriptions, broken_recordings
from tests.broken_kit import BROKEN

__all__ = ["BROKEN", "broken_descriptions", "broken_recordings"]
