"""Linear algebra on one thread.

The matrices of a fit are small. A BLAS that distributes them over all cores gains nothing on an idle machine, and its
threads wait for each other on a busy one. threadpoolctl, which scikit-learn uses for the same purpose, limits the
number of threads temporarily.
"""

from collections.abc import Callable
from functools import lru_cache, wraps
from typing import ParamSpec, TypeVar

import numpy.linalg  # noqa: F401 - loaded, so that its BLAS is found
import scipy.linalg  # noqa: F401 - likewise
from threadpoolctl import ThreadpoolController

P = ParamSpec("P")
R = TypeVar("R")


def on_one_thread(work: Callable[P, R]) -> Callable[P, R]:
    """The function with BLAS limited to one thread while it runs."""

    @wraps(work)
    def limited(*args: P.args, **kwargs: P.kwargs) -> R:
        with _controller().limit(limits=1, user_api="blas"):
            return work(*args, **kwargs)

    return limited


@lru_cache(maxsize=1)
def _controller() -> ThreadpoolController:
    """The libraries loaded at the first call: those of numpy and scipy, which every fit imports."""
    return ThreadpoolController()
