"""Distribute the independent pieces of one computation over all processors."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from bench.basics.errors import BenchError
from bench.basics.mapper import Item, Result
from bench.basics.mapper import Shared as Common
from bench.studies.sweep.pool import ON_ALL_CORES, Pool, Shared, Workers

START = 1.0  # s: about the time that processes take to start, which shorter work need not wait for


@dataclass(frozen=True)
class _Piece:
    """One item; a BenchError is returned as part of the result."""

    work: Callable[[Any, Any], Any]
    item: Any

    def __call__(self, shared: Any) -> tuple[Any, str | None]:
        try:
            return self.work(shared, self.item), None
        except BenchError as error:
            return None, str(error)


class PooledMapper:
    """A `Mapper` that works in this process until its work has taken `start` s, then in several; `with` ends these."""

    def __init__(self, workers: Workers = ON_ALL_CORES, start: float = START) -> None:
        self._workers, self._start = workers, start
        self._spent = 0.0
        self._pool: Pool | None = None
        self._keys = 0
        self._shared = Shared("0", None)

    def __enter__(self) -> PooledMapper:
        if self._workers.count > 1:
            self._workers.warm_up()
        return self

    def __exit__(self, *_: object) -> None:
        if self._pool is not None:
            self._pool.close()

    def map(
        self, work: Callable[[Common, Item], Result], shared: Common, items: Sequence[Item]
    ) -> Iterator[Result]:
        """See `Mapper`. A single item is computed in this process."""
        for at, item in enumerate(items):
            if len(items) > 1 and self._workers.count > 1 and self._spent >= self._start:
                yield from self._pooled(work, shared, items[at:])
                return
            begun = time.perf_counter()
            result = work(shared, item)
            self._spent += time.perf_counter() - begun
            yield result

    def _pooled(
        self, work: Callable[[Common, Item], Result], shared: Common, items: Sequence[Item]
    ) -> Iterator[Result]:
        pool = self._pool = self._pool or self._workers.pool()
        if shared is not self._shared.value:
            self._shared = Shared(f"{int(self._shared.name) + 1}", shared)
        first = self._keys
        self._keys += len(items)
        for key, item in enumerate(items, start=first):
            pool.submit(key, _Piece(work, item), self._shared)
        ended: dict[int, Any] = {}
        for key in range(first, self._keys):
            while key not in ended:
                for outcome in pool.outcomes():
                    if outcome.fault is not None:
                        raise RuntimeError(f"a worker process: {outcome.fault}")
                    ended[outcome.key] = outcome.value
            result, mistake = ended.pop(key)
            if mistake is not None:
                raise BenchError(mistake)
            yield result
