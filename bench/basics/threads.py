"""Linear algebra on as many threads as help: one.

The matrices of a fit are small. A BLAS that spreads them over all cores gains nothing on an idle machine, and waits for
itself on a busy one. threadpoolctl, which scikit-learn uses for the same end, limits it for a while and gives it back.
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
    """The function, with BLAS on one thread while it runs and as it was before once it has returned or raised."""

    @wraps(work)
    def limited(*args: P.args, **kwargs: P.kwargs) -> R:
        with _controller().limit(limits=1, user_api="blas"):
            return work(*args, **kwargs)

    return limited


@lru_cache(maxsize=1)
def _controller() -> ThreadpoolController:
    """The libraries that are loaded when it is first asked for: those of numpy and scipy, which every fit imports."""
    return ThreadpoolController()
