"""Where the runs of a command go: processes of this machine, or the workers of a Dask scheduler."""

import os
from dataclasses import dataclass

from bench.studies.sweep.pool import LocalPool, Pool, start_server


@dataclass(frozen=True)
class Workers:
    """What the command was given. processes: on this machine, None for one a core; scheduler: an address instead."""

    processes: int | None = None
    scheduler: str | None = None

    @property
    def count(self) -> int:
        """How many processes of this machine there are to be."""
        return self.processes or len(os.sched_getaffinity(0))

    def warm_up(self) -> None:
        """Begin to import what processes of this machine need, in addition to whatever comes before they start."""
        if self.scheduler is None:
            start_server()

    def pool(self) -> Pool:
        """Start the processes, or connect to the scheduler."""
        if self.scheduler is None:
            return LocalPool(self.count)
        from bench.studies.sweep.dask_pool import DaskPool  # noqa: PLC0415 - an optional extra

        return DaskPool(self.scheduler)


ON_ALL_CORES = Workers()
