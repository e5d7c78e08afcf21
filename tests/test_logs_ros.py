"""ROS bags become recordings: MCAP and SQLite, a file or a folder, and bags of ROS 1."""

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rosbags.rosbag1 import Writer as Writer1
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

from bench.basics.errors import BenchError
from bench.cli import main
from bench.dataset.dataset import load_dataset
from bench.dataset.logs.columns import LogMap
from bench.dataset.logs.log_file import Reading, read_log
from bench.dataset.logs.ros_bag import EFFORT, JOINT_STATE
from tests.good_data import COUNT, JOINTS, movement, time_stamps, write_robot
from tests.logs_kit import told

START = 1_700_000_000 * 10**9  # ns, of the headers' stamps
TYPES = get_typestore(Stores.ROS2_HUMBLE)


def message(
    stamp: int,
    position: Sequence[float],
    effort: Sequence[float],
    names: Sequence[str] = JOINTS,
    types: Any = TYPES,
) -> Any:
    """A joint state; types: those of the release that writes it."""
    known = types.types
    more = {"seq": 0} if "seq" in known["std_msgs/msg/Header"].__dataclass_fields__ else {}
    header = known["std_msgs/msg/Header"](
        stamp=known["builtin_interfaces/msg/Time"](sec=stamp // 10**9, nanosec=stamp % 10**9),
        frame_id="",
        **more,
    )
    return known[JOINT_STATE](
        header=header,
        name=list(names),
        position=np.array(position),
        velocity=np.zeros(len(position)),
        effort=np.array(effort),
    )


def samples(*, stamped: bool = True) -> list[tuple[int, Any]]:
    """When each message was recorded, and the message: joints change places halfway."""
    position, current = movement(time_stamps())
    found = []
    for i, (t, q, c) in enumerate(zip(time_stamps(), position, current, strict=True)):
        order = [0, 1, 2] if i < COUNT // 2 else [2, 0, 1]
        stamp = START + round(t * 1e9)
        names = [JOINTS[j] for j in order]
        found.append((stamp + 5 * 10**9, message(stamp if stamped else 0, q[order], c[order], names)))
    return found


def write_bag(path: Path, storage: StoragePlugin, topics: dict[str, list[tuple[int, Any]]]) -> Path:
    with Writer(path, version=9, storage_plugin=storage) as bag:
        for topic, messages in topics.items():
            connection = bag.add_connection(topic, JOINT_STATE, typestore=TYPES)
            for when, one in messages:
                bag.write(connection, when, TYPES.serialize_cdr(one, JOINT_STATE))
    return path


def write_ros1(path: Path) -> Path:
    types = get_typestore(Stores.ROS1_NOETIC)
    with Writer1(path) as bag:
        connection = bag.add_connection("/joint_states", JOINT_STATE, typestore=types)
        position, current = movement(time_stamps())
        for t, q, c in zip(time_stamps(), position, current, strict=True):
            stamp = START + round(t * 1e9)
            one = message(stamp, q, c, types=types)
            bag.write(connection, stamp, types.serialize_ros1(one, JOINT_STATE))
    return path


@pytest.fixture
def robot(tmp_path: Path) -> str:
    return str(write_robot(tmp_path / "robot"))


@pytest.fixture
def bag(tmp_path: Path) -> Path:
    return write_bag(tmp_path / "run", StoragePlugin.MCAP, {"/joint_states": samples()})


def logs(folder: Path) -> list[Path]:
    """The same movement as a folder and a file of each storage, and as a bag of ROS 1."""
    states = {"/joint_states": samples()}
    mcap = write_bag(folder / "mcap", StoragePlugin.MCAP, states)
    sqlite = write_bag(folder / "sqlite", StoragePlugin.SQLITE3, states)
    files = [*mcap.glob("*.mcap"), *sqlite.glob("*.db3")]
    return [mcap, sqlite, *files, write_ros1(folder / "one.bag")]


def test_every_kind_of_bag_gives_the_same_recording(tmp_path: Path, robot: str) -> None:
    paths = logs(tmp_path)
    assert [path.suffix for path in paths] == ["", "", ".mcap", ".db3", ".bag"]
    position, current = movement(time_stamps())
    for i, path in enumerate(paths):
        found = told(path, robot, LogMap(), tmp_path / f"out{i}")
        (recording,) = load_dataset(tmp_path / f"out{i}").recordings
        assert np.array_equal(recording.position, position)
        assert np.array_equal(recording.current, current)
        np.testing.assert_allclose(recording.time, time_stamps(), rtol=0.0, atol=1e-9)
        assert set(recording.extra) == {f"velocity.{joint}" for joint in JOINTS}
        assert [note for _, note in found.notes] == [
            "2000 joint states of /joint_states; time: the headers' stamps, from zero on",
            EFFORT,
        ]


def test_effort_is_called_current(bag: Path) -> None:
    log = read_log(bag)
    assert [name for name in log.vectors if name.startswith("current.")] == [f"current.{j}" for j in JOINTS]


def test_without_stamps_time_is_that_of_the_recording(tmp_path: Path, robot: str) -> None:
    path = write_bag(tmp_path / "run", StoragePlugin.SQLITE3, {"/joint_states": samples(stamped=False)})
    found = told(path, robot, LogMap(), tmp_path / "out")
    assert "when they were recorded, as the stamps are zero" in found.notes[0][1]
    np.testing.assert_allclose(load_dataset(tmp_path / "out").recordings[0].time, time_stamps(), atol=1e-9)


def test_one_of_several_topics_is_named(
    tmp_path: Path, robot: str, capsys: pytest.CaptureFixture[str]
) -> None:
    topics = {"/joint_states": samples(), "/commanded": samples()[:500]}
    path = write_bag(tmp_path / "run", StoragePlugin.MCAP, topics)
    with pytest.raises(
        BenchError, match=r"/joint_states \(2000\), /commanded \(500\): name one with --topic"
    ):
        read_log(path)
    with pytest.raises(BenchError, match=r"no joint states on the topic '/arm'"):
        read_log(path, Reading(topic="/arm"))
    words = ["import", str(path), "--robot", robot, "--topic", "/commanded", "-o", str(tmp_path / "out")]
    assert main(words) == 0
    assert "500 joint states of /commanded" in capsys.readouterr().out


FAULTS: dict[str, tuple[dict[str, Any], str]] = {
    "effort of fewer joints": ({"effort": [1.0]}, "message 7: 1 value of effort for 3 joints"),
    "other joints": (
        {"names": ("arm", "rail", "hand")},
        "different joints: arm, rail, wheel (1999); arm, hand, rail (1)",
    ),
}


@pytest.mark.parametrize("name", FAULTS)
def test_messages_that_do_not_fit_are_named(name: str, tmp_path: Path) -> None:
    change, expected = FAULTS[name]
    states = samples()
    states[7] = (states[7][0], message(START, **{"position": [0.0] * 3, "effort": [0.0] * 3, **change}))
    path = write_bag(tmp_path / "run", StoragePlugin.SQLITE3, {"/joint_states": states})
    with pytest.raises(BenchError) as caught:
        read_log(path)
    assert expected in str(caught.value)


def test_a_bag_without_joint_states_says_what_it_has(tmp_path: Path) -> None:
    with Writer(tmp_path / "run", version=9) as writer:
        connection = writer.add_connection("/said", "std_msgs/msg/String", typestore=TYPES)
        said = TYPES.types["std_msgs/msg/String"](data="hello")
        writer.write(connection, START, TYPES.serialize_cdr(said, "std_msgs/msg/String"))
    with pytest.raises(
        BenchError, match=r"holds no sensor_msgs/JointState \(it has /said \(std_msgs/msg/String\)\)"
    ):
        read_log(tmp_path / "run")


def test_a_broken_bag_is_named_in_one_line(tmp_path: Path) -> None:
    for path in logs(tmp_path)[2:]:
        content = path.read_bytes()
        for k, broken in enumerate((content[: len(content) // 2], b"", bytes(range(256)) * 40)):
            file = tmp_path / f"broken{k}{path.suffix}"
            file.write_bytes(broken)
            with pytest.raises(BenchError, match="is not a complete ROS bag: ") as caught:
                read_log(file)
            assert str(caught.value).startswith(f"{file}: ")
            assert "\n" not in str(caught.value)


def test_a_bag_that_is_not_there(tmp_path: Path) -> None:
    with pytest.raises(BenchError, match="no such file"):
        read_log(tmp_path / "run.mcap")


def test_without_the_extra_it_says_what_to_install(
    tmp_path: Path, bag: Path, robot: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setitem(sys.modules, "rosbags.highlevel", None)
    assert main(["import", str(bag), "--robot", robot, "-o", str(tmp_path / "out")]) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert "pip install 'parabench[ros]'" in error
    assert not (tmp_path / "out").exists()


def test_a_topic_is_for_bags_alone(tmp_path: Path) -> None:
    np.savez(tmp_path / "log.npz", t=np.arange(3.0))
    with pytest.raises(BenchError, match="only a ROS bag has topics"):
        read_log(tmp_path / "log.npz", Reading(topic="/joint_states"))
