"""Changes to a dataset.toml that a user may have written: what is not changed stays, comments and all."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from bench.dataset.names import Check, Use
from bench.dataset.payload import Payload

OF_THE_OLD = ("window", "exclude")  # stretches of a log that is replaced say nothing of the new one


@dataclass(frozen=True)
class RecordingEntry:
    """One [[recordings]] table to write: file name relative to the folder, use, payload, accepted checks."""

    file: str
    use: Use
    payload: str | None = None
    accept: tuple[Check, ...] = ()


def payload_keys(payload: Payload) -> dict[str, float | list[float]]:
    """The given values of a payload, under the keys of its table."""
    keys: dict[str, float | list[float]] = {} if payload.mass is None else {"mass": float(payload.mass)}
    for key, values in (("center_of_mass", payload.center_of_mass), ("inertia", payload.inertia)):
        if values is not None:
            keys[key] = np.asarray(values, dtype=np.float64).tolist()
    return keys


def edited(text: str, entries: Sequence[RecordingEntry], payloads: Sequence[Payload]) -> str:
    """The dataset.toml `text` in which recordings and payloads that it has already are as given.

    A recording's place in the list stays; its windows go. Of a payload, what is not given stays.
    """
    if not (entries or payloads):
        return text
    import tomlkit  # noqa: PLC0415 - slow to import: only once a file is changed

    document: Any = tomlkit.parse(text)
    tables = {table["file"]: table for table in document["recordings"]}
    for entry in entries:
        _set(tables[entry.file], entry)
    for payload in payloads:
        document["payloads"][payload.name].update(payload_keys(payload))
    return str(tomlkit.dumps(document))


def _set(table: Any, entry: RecordingEntry) -> None:
    keys: Mapping[str, Any] = {
        "use": entry.use,
        "payload": entry.payload,
        "accept": list(entry.accept) or None,
        **dict.fromkeys(OF_THE_OLD),
    }
    for key, value in keys.items():
        if value is not None:
            table[key] = value
        elif key in table:
            del table[key]
