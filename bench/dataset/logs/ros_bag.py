"""ROS bags: joint states of ROS 2 (MCAP or SQLite, a file or a folder) and of ROS 1, read by rosbags without ROS.

A message sensor_msgs/JointState becomes a sample of `position.JOINT`, `velocity.JOINT` and, from its effort,
`current.JOINT`; joints are matched by name, in any order. Time is from the header stamps; if all are zero, it is the
time at which the messages were recorded.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
import numpy.typing as npt

from bench.basics.errors import BenchError
from bench.basics.files.toml_input import one_line
from bench.basics.plural import plural
from bench.dataset.names import BAGS

if TYPE_CHECKING:
    from rosbags.highlevel import AnyReader
    from rosbags.interfaces import Connection

Array = npt.NDArray[np.float64]
Answer = TypeVar("Answer")
JOINT_STATE = "sensor_msgs/msg/JointState"
KINDS = {"position": "position", "velocity": "velocity", "effort": "current"}
"""Field of a message -> kind of column."""

NANO = 1e-9
EFFORT = 'effort is used as current (if it contains torques or forces, set gain_unit = "1" in robot.toml)'


def is_bag(path: Path) -> bool:
    """Whether a path is a ROS bag: a file with the suffix of one, or the folder of a ROS 2 bag."""
    return path.suffix.lower() in BAGS or (path / "metadata.yaml").is_file()


def read_bag(path: Path, topic: str | None = None) -> tuple[dict[str, Array], tuple[str, ...]]:
    """The vectors of the joint states in a bag, by name, and notes on what was assumed.

    Raises BenchError if rosbags is not installed, the bag is broken or has no joint states, a topic is missing or
    ambiguous, or messages differ in their joints.
    """
    return _read(path, lambda reader: _joint_states(path, reader, topic))


def joint_topics(path: Path) -> tuple[str, ...]:
    """The topics of a bag that hold joint states, in order. Raises BenchError as `read_bag` does."""
    return _read(path, lambda reader: tuple(_counts(reader)))


def _read(path: Path, read: Callable[[AnyReader], Answer]) -> Answer:
    """The result of `read` on an open reader of the bag. Raises BenchError for a missing rosbags or a broken bag."""
    try:
        from rosbags.highlevel import AnyReader, AnyReaderError  # noqa: PLC0415 - an extra that may be absent
        from rosbags.rosbag1 import ReaderError as Ros1Error  # noqa: PLC0415
        from rosbags.rosbag2 import ReaderError as Ros2Error  # noqa: PLC0415
        from rosbags.typesys import Stores, get_typestore  # noqa: PLC0415
    except ModuleNotFoundError as error:
        raise BenchError(f"{path}: a ROS bag: install what reads it: pip install 'parabench[ros]'") from error
    # the message type is the same in every release; older bags do not include its definition
    types = get_typestore(Stores.ROS2_HUMBLE)
    try:
        with AnyReader([path], default_typestore=types) as reader:
            return read(reader)
    except (AnyReaderError, Ros1Error, Ros2Error, OSError, ValueError, LookupError, AssertionError) as error:
        raise BenchError(
            f"{path}: is not a complete ROS bag: {one_line(error) or 'it is cut off'}"
        ) from error


def _joint_states(
    path: Path, reader: AnyReader, topic: str | None
) -> tuple[dict[str, Array], tuple[str, ...]]:
    connections = _connections(path, reader, topic)
    received, stamps, names = [], [], []
    values: dict[str, list[Any]] = {field: [] for field in KINDS}
    for connection, when, raw in reader.messages(connections):
        message: Any = reader.deserialize(raw, connection.msgtype)
        received.append(when)
        stamps.append(message.header.stamp.sec * 10**9 + message.header.stamp.nanosec)
        names.append(tuple(message.name))
        for field, list_of_values in values.items():
            list_of_values.append(np.array(getattr(message, field), dtype=np.float64))
    chosen = connections[0].topic
    joints = _joints(f"{path}: {chosen}", names)
    time, said = _time(received, stamps)
    vectors = {"time": time}
    for field, kind in KINDS.items():
        vectors |= _by_joint(f"{path}: {chosen}", field, kind, joints, names, values[field])
    effort = any(name.startswith("current.") for name in vectors)
    return vectors, (f"{len(time)} joint states of {chosen}; {said}", *([EFFORT] if effort else []))


def _states(reader: AnyReader) -> list[Connection]:
    return [
        connection
        for connection in reader.connections
        if connection.msgtype == JOINT_STATE and connection.msgcount
    ]


def _counts(reader: AnyReader) -> dict[str, int]:
    """Number of joint states by topic."""
    counts: Counter[str] = Counter()
    for state in _states(reader):
        counts[state.topic] += state.msgcount
    return counts


def _connections(path: Path, reader: AnyReader, topic: str | None) -> list[Connection]:
    """The connections of the joint states' topic, which must be named if there are several."""
    states, counts = _states(reader), _counts(reader)
    known = ", ".join(f"{name} ({count})" for name, count in counts.items())
    if not counts:
        others = sorted({f"{connection.topic} ({connection.msgtype})" for connection in reader.connections})
        raise BenchError(f"{path}: holds no sensor_msgs/JointState (it has {', '.join(others) or 'nothing'})")
    if topic is None and len(counts) > 1:
        raise BenchError(f"{path}: several topics hold joint states: {known}: name one with --topic")
    if topic is not None and topic not in counts:
        raise BenchError(f"{path}: no joint states on the topic {topic!r} (they are on {known})")
    return [state for state in states if topic is None or state.topic == topic]


def _joints(where: str, names: Sequence[tuple[str, ...]]) -> tuple[str, ...]:
    """The joints of all messages. Raises BenchError if messages have different joints, or one names a joint twice."""
    sets = Counter(frozenset(name) for name in names)
    if len(sets) > 1:
        differing = "; ".join(f"{', '.join(sorted(entry))} ({count})" for entry, count in sets.most_common(4))
        raise BenchError(
            f"{where}: its messages are of different joints: {differing}: record them on separate topics"
        )
    if len(set(names[0])) != len(names[0]):
        raise BenchError(f"{where}: a message names a joint twice: {', '.join(names[0])}")
    return names[0]


def _time(received: Sequence[int], stamps: Sequence[int]) -> tuple[Array, str]:
    """Seconds since the first sample (float64 cannot resolve stamps in ns since 1970), and a note on the clock."""
    stamped = any(stamps)
    clock = np.array(stamps if stamped else received, dtype=np.int64)
    said = "time: the headers' stamps" if stamped else "time: when they were recorded, as the stamps are zero"
    return (clock - clock[0]) * NANO, f"{said}, from zero on"


def _by_joint(
    where: str,
    field: str,
    kind: str,
    joints: Sequence[str],
    names: Sequence[tuple[str, ...]],
    values: Sequence[Array],
) -> dict[str, Array]:
    """The vector of a field for every joint; empty if the messages do not fill the field."""
    lengths = {len(value) for value in values}
    if lengths == {0}:
        return {}
    wrong = next((i for i, value in enumerate(values) if len(value) != len(joints)), None)
    if wrong is not None:
        raise BenchError(
            f"{where}: message {wrong}: {plural(len(values[wrong]), 'value')} of {field} for "
            f"{plural(len(joints), 'joint')}"
        )
    table = np.array(values)
    if any(name != names[0] for name in names):
        places = [[name.index(joint) for joint in joints] for name in names]
        table = np.take_along_axis(table, np.array(places), axis=1)
    return {f"{kind}.{joint}": table[:, j] for j, joint in enumerate(joints)}
