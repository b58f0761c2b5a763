"""The transform buffer, which works like tf2's BufferCore."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fibws.interfaces import Time
from fibws.tf import buffer as module
from fibws.tf.buffer import MAX_FRAME_ID, Buffer
from fibws.tf.errors import (
    FrameLoop,
    InvalidTransform,
    OldData,
    RepeatedData,
    TransformError,
    TransformOutOfTime,
    UnconnectedFrames,
    UnknownFrame,
)
from fibws.tf.history import Sample
from fibws.tf.transform import Quaternion, Transform

from .oracle import Matrix, assert_same, homogeneous, transforms

SECOND = 1_000_000_000
QUARTER = math.sqrt(0.5)


def place(
    buffer: Buffer, frame: str, parent: str, x: float, at: float = 1, static: bool = False
) -> None:
    transform = Transform((x, 0.0, 0.0))
    buffer.insert(frame, Sample(int(at * SECOND), parent, transform), static=static)


def x_of(buffer: Buffer, target: str, source: str, at: float = 0) -> float:
    return buffer.lookup(target, source, int(at * SECOND)).transform.translation[0]


@pytest.fixture
def buffer() -> Buffer:
    return Buffer()


@pytest.fixture
def robot(buffer: Buffer) -> Buffer:
    """map → odom → base → {camera, arm → hand}, each with another length."""
    place(buffer, "odom", "map", 1)
    place(buffer, "base", "odom", 10)
    place(buffer, "camera", "base", 100, static=True)
    place(buffer, "arm", "base", 1000)
    place(buffer, "hand", "arm", 10000)
    return buffer


@pytest.mark.parametrize(
    ("target", "source", "x"),
    [
        ("map", "odom", 1),
        ("map", "hand", 11011),
        ("hand", "map", -11011),
        ("camera", "hand", 10900),
        ("hand", "camera", -10900),
        ("base", "camera", 100),
        ("arm", "arm", 0),
    ],
)
def test_lookup_goes_through_the_nearest_common_ancestor(
    robot: Buffer, target: str, source: str, x: float
) -> None:
    sample = robot.lookup(target, source)
    assert sample.transform.translation == (x, 0.0, 0.0)
    assert sample.parent == target


def test_lookup_gives_the_source_in_the_target(buffer: Buffer) -> None:
    """A camera a metre in front of the base, which looks to the left; as `tf_echo base camera`."""
    left: Quaternion = (0.0, 0.0, QUARTER, QUARTER)
    buffer.insert("camera", Sample(1, "base", Transform((1.0, 0.0, 0.0), left)))
    seen = buffer.lookup("base", "camera").transform
    assert seen.translation == (1.0, 0.0, 0.0)
    assert seen.rotation == pytest.approx(left)
    assert buffer.lookup("camera", "base").transform.translation == pytest.approx((0, 1, 0))


@given(st.lists(st.tuples(st.integers(0), transforms), min_size=1, max_size=12), st.data())
def test_lookup_agrees_with_matrices(
    tree: list[tuple[int, Transform]], data: st.DataObject
) -> None:
    buffer = Buffer()
    in_root: list[Matrix] = [np.eye(4)]
    for number, (choice, transform) in enumerate(tree, 1):
        parent = choice % number
        buffer.insert(f"f{number}", Sample(7, f"f{parent}", transform))
        in_root.append(in_root[parent] @ homogeneous(transform))
    frames = st.integers(0, len(tree))
    target, source = data.draw(frames), data.draw(frames)
    transform = buffer.lookup(f"f{target}", f"f{source}").transform
    expected = np.linalg.inv(in_root[target]) @ in_root[source]
    assert_same(transform, expected, scale=1000)


def test_leading_slash_is_ignored(buffer: Buffer) -> None:
    place(buffer, "/base", "/map", 1)
    assert buffer.lookup("map", "/base") == buffer.lookup("/map", "base")
    assert buffer.lookup("/map", "base").parent == "map"


# Time


def test_latest_time_is_common_to_the_whole_path(buffer: Buffer) -> None:
    for at in (1.0, 2.0, 3.0, 4.0):
        place(buffer, "odom", "map", at * 100, at)
    for at in (1.5, 2.5):
        place(buffer, "base", "odom", at, at)
    assert buffer.lookup("map", "base").stamp == 2.5 * SECOND
    assert x_of(buffer, "map", "base") == 252.5
    assert x_of(buffer, "base", "map") == -252.5


def test_frames_off_the_path_are_ignored(robot: Buffer) -> None:
    place(robot, "arm", "base", 1000, at=3)
    place(robot, "hand", "arm", 20000, at=3)
    place(robot, "odom", "map", 1, at=2)
    assert robot.lookup("base", "hand").stamp == 3 * SECOND
    assert robot.lookup("camera", "hand").stamp == 3 * SECOND


def test_lookup_at_a_time(buffer: Buffer) -> None:
    for at in (1.0, 2.0, 3.0):
        place(buffer, "odom", "map", at * 100, at)
    place(buffer, "camera", "odom", 5, static=True)
    sample = buffer.lookup("map", "camera", int(1.5 * SECOND))
    assert (sample.stamp, sample.transform.translation) == (1.5 * SECOND, (155.0, 0.0, 0.0))
    for at in (0.9, 3.1):
        with pytest.raises(TransformOutOfTime, match=r"from frame \[camera\] to frame \[map\]$"):
            x_of(buffer, "map", "camera", at)
        with pytest.raises(TransformOutOfTime, match=r"from frame \[map\] to frame \[camera\]$"):
            x_of(buffer, "camera", "map", at)


def test_gap_above_the_nearest_ancestor_is_ignored(robot: Buffer) -> None:
    place(robot, "arm", "base", 2000, at=2)
    place(robot, "hand", "arm", 20000, at=2)
    assert x_of(robot, "camera", "hand", at=2) == 21900
    with pytest.raises(TransformOutOfTime, match=r"but only time 1.000000000 is"):
        x_of(robot, "map", "hand", at=2)


def test_static_path_is_valid_at_all_times(buffer: Buffer) -> None:
    place(buffer, "camera", "base", 1, at=5, static=True)
    place(buffer, "lens", "camera", 2, at=9, static=True)
    assert buffer.lookup("base", "lens").stamp == 0
    assert x_of(buffer, "base", "lens", at=1) == x_of(buffer, "base", "lens") == 3


def test_transforms_without_stamps_are_kept(buffer: Buffer) -> None:
    place(buffer, "base", "map", 1, at=0)
    place(buffer, "base", "map", 2, at=0)
    assert x_of(buffer, "map", "base") == 2


# Changes of the tree


def test_latest_parent_replaces_the_others(buffer: Buffer) -> None:
    place(buffer, "cup", "table", 1, at=1)
    place(buffer, "cup", "hand", 2, at=2)
    place(buffer, "lamp", "table", 3)
    assert x_of(buffer, "hand", "cup") == 2
    with pytest.raises(UnconnectedFrames):
        buffer.lookup("table", "cup")
    assert x_of(buffer, "table", "cup", at=1) == 1


def test_frame_may_become_static_or_moving(buffer: Buffer) -> None:
    for at in (1, 2):
        place(buffer, "base", "map", at, at)
    place(buffer, "base", "map", 7, at=0, static=True)
    assert x_of(buffer, "map", "base", at=99) == 7
    assert buffer.samples == 1
    place(buffer, "base", "map", 8, at=3)
    assert x_of(buffer, "map", "base") == 8
    with pytest.raises(TransformOutOfTime):
        x_of(buffer, "map", "base", at=99)


# Errors


def test_unknown_frame_is_an_error(robot: Buffer) -> None:
    with pytest.raises(
        UnknownFrame, match='"foot" passed to lookupTransform argument source_frame'
    ):
        robot.lookup("map", "foot")
    with pytest.raises(UnknownFrame, match='"world" passed to lookupTransform argument target_'):
        robot.lookup("world", "hand")
    with pytest.raises(LookupError):
        Buffer().lookup("a", "b")


def test_unconnected_frames_are_an_error(robot: Buffer) -> None:
    place(robot, "moon", "earth", 1)
    for target, source in (("map", "moon"), ("moon", "map"), ("earth", "hand"), ("map", "earth")):
        with pytest.raises(UnconnectedFrames, match=f"{target!r} and {source!r}"):
            robot.lookup(target, source)


@pytest.mark.parametrize("length", [2, 3, 50])
def test_loop_is_an_error(buffer: Buffer, length: int) -> None:
    for number in range(length):
        place(buffer, f"f{number}", f"f{(number + 1) % length}", 1)
    place(buffer, "base", "map", 1)
    place(buffer, "tail", "f0", 1)
    with pytest.raises(FrameLoop, match=r"Frame f0 exists with parent f1.\n"):
        buffer.lookup("map", "f0")
    with pytest.raises(FrameLoop, match=r"Frame f0 exists with parent f1.\n"):
        buffer.lookup("f0", "map")
    with pytest.raises(FrameLoop, match=r"because it contains a loop.\nFrame f0"):
        buffer.lookup("base", "tail")
    assert x_of(buffer, "f1", "f0") == 1


def transform(**changes: float) -> Transform:
    values = dict.fromkeys(("x", "y", "z", "qx", "qy", "qz"), 0.0) | {"qw": 1.0} | changes
    x, y, z, qx, qy, qz, qw = values.values()
    return Transform((x, y, z), (qx, qy, qz, qw))


@pytest.mark.parametrize(
    ("frame", "parent", "wrong", "fault"),
    [
        ("", "map", transform(), "a frame's id is empty"),
        ("base", "/", transform(), "a frame's id is empty"),
        ("/base", "base", transform(), "the frame 'base' cannot be its own parent"),
        ("b" * (MAX_FRAME_ID + 1), "map", transform(), r"'b{40}'\.\.\. .*256"),
        ("base", "map", transform(y=math.nan), "'base': .*translation"),
        ("base", "map", transform(qz=math.inf), "'base': .*translation"),
        ("base", "map", transform(qw=0), r"'base': the rotation .* \(0, 0, 0, 1\)"),
        ("base", "map", transform(qw=1.01), "'base': the rotation .* of length 1"),
    ],
)
def test_invalid_transform_is_an_error(
    robot: Buffer, frame: str, parent: str, wrong: Transform, fault: str
) -> None:
    before = robot.lookup("map", "hand"), len(robot), robot.samples
    for static in (False, True):
        with pytest.raises(InvalidTransform, match=fault):
            robot.insert(frame, Sample(9 * SECOND, parent, wrong), static=static)
    assert (robot.lookup("map", "hand"), len(robot), robot.samples) == before


def test_quaternion_is_normalized(buffer: Buffer) -> None:
    buffer.insert("base", Sample(1, "map", transform(qw=1.004)))
    assert buffer.lookup("map", "base").transform == Transform()


def test_empty_frame_id_is_an_error(robot: Buffer) -> None:
    for target, source in (("", "base"), ("base", "/")):
        with pytest.raises(InvalidTransform, match="a frame's id is empty"):
            robot.lookup(target, source)


# Bounds


def test_frame_without_samples_for_longest_is_removed_at_the_limit(
    buffer: Buffer, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "MAX_FRAMES", 4)
    place(buffer, "camera", "base", 1, static=True)
    for frame in ("a", "b", "c"):
        place(buffer, frame, "base", 1)
    place(buffer, "a", "base", 2, at=2)
    place(buffer, "new", "base", 1)
    assert (len(buffer), buffer.samples) == (4, 5)
    for frame in ("camera", "a", "c", "new"):
        buffer.lookup("base", frame)
    with pytest.raises(UnknownFrame, match='"b"'):
        buffer.lookup("base", "b")


def test_static_frame_is_removed_if_there_are_no_others(
    buffer: Buffer, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "MAX_FRAMES", 2)
    for frame in ("a", "b", "c"):
        place(buffer, frame, "base", 1, static=True)
    assert (len(buffer), buffer.samples) == (2, 2)
    with pytest.raises(UnknownFrame, match='"a"'):
        buffer.lookup("base", "a")


def test_samples_are_bounded(buffer: Buffer, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "MAX_SAMPLES", 5)
    for at in range(1, 8):
        place(buffer, "base", "map", at, at)
    assert buffer.samples == 5
    place(buffer, "arm", "base", 1, at=7)
    place(buffer, "arm", "base", 2, at=8)
    assert (x_of(buffer, "base", "arm"), x_of(buffer, "map", "base", at=3)) == (2, 3)
    place(buffer, "base", "map", 8, at=8)
    assert buffer.samples == 5


def test_names_of_frames_are_bounded(buffer: Buffer, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "MAX_FRAMES", 3)
    for number in range(50):
        place(buffer, "cup", f"hand{number}", 1, at=number)
        place(buffer, f"cup{number}", "table", 1)
    assert len(buffer.frames()) <= 13
    assert buffer.exists("hand49")
    assert x_of(buffer, "table", "cup49") == 1


# Time travel, chains, listings


@pytest.fixture
def train(buffer: Buffer) -> Buffer:
    """map → train → {door, seat}: the train moves 10 m in a second."""
    for at in (1.0, 2.0, 3.0):
        place(buffer, "train", "map", at * 10, at)
        place(buffer, "seat", "train", 2, at)
    place(buffer, "door", "train", 1, static=True)
    return buffer


def test_lookup_of_two_times_goes_over_the_fixed_frame(train: Buffer) -> None:
    sample = train.lookup_full("door", 3 * SECOND, "seat", 1 * SECOND, "map")
    assert sample.transform.translation == (-19.0, 0.0, 0.0)
    assert (sample.stamp, sample.parent) == (3 * SECOND, "door")
    assert train.lookup_full("door", 0, "seat", 0, "map").transform.translation == (1.0, 0.0, 0.0)
    with pytest.raises(UnknownFrame, match="argument fixed_frame does not exist"):
        train.lookup_full("door", 0, "seat", 0, "moon")
    with pytest.raises(TransformOutOfTime, match=r"from frame \[map\] to frame \[door\]"):
        train.lookup_full("door", 4 * SECOND, "seat", SECOND, "map")


def test_latest_common_time(train: Buffer) -> None:
    place(train, "seat", "train", 2, at=4)
    assert train.latest_common_time("map", "seat") == 3 * SECOND
    assert train.latest_common_time("seat", "train") == 4 * SECOND
    assert train.latest_common_time("door", "train") == 0
    assert train.latest_common_time("seat", "seat") == 4 * SECOND
    assert train.lookup("seat", "seat").stamp == 4 * SECOND
    with pytest.raises(UnknownFrame):
        train.latest_common_time("moon", "seat")


def test_chain(train: Buffer) -> None:
    assert train.chain("seat", 0, "door", 0, "train") == ["door", "train", "seat"]
    assert train.chain("seat", 0, "door", 0, "map") == ["door", "train", "map", "train", "seat"]
    assert train.chain("map", 0, "door", 0, "map") == ["door", "train", "map"]
    assert train.chain("map", 0, "map", 0, "map") == []


def test_check_raises_as_lookup_does(train: Buffer) -> None:
    train.check("map", "seat", 2 * SECOND)
    with pytest.raises(TransformOutOfTime):
        train.check("map", "seat", 9 * SECOND)
    with pytest.raises(UnknownFrame):
        train.check("map", "moon")


def test_frames_are_listed_in_the_order_in_which_they_were_named(train: Buffer) -> None:
    train.insert("seat", Sample(4 * SECOND, "train", transform()), authority="/node")
    assert train.frames() == ["train", "map", "seat", "door"]
    assert train.exists("map")
    assert not train.exists("moon")
    assert train.infos()[1] == ("seat", "train", "/node", 4, 4 * SECOND, SECOND)
    assert train.listing().splitlines() == [
        "Frame train exists with parent map.",
        "Frame seat exists with parent train.",
        "Frame door exists with parent train.",
    ]


def test_clear_keeps_static_frames(train: Buffer) -> None:
    train.clear()
    assert (len(train), train.samples) == (1, 1)
    assert x_of(train, "train", "door") == 1
    with pytest.raises(UnconnectedFrames):
        train.lookup("map", "seat")


def test_strict_buffer_treats_samples_as_tf2() -> None:
    buffer = Buffer(5.0, strict=True)
    place(buffer, "base", "map", 1, at=10)
    with pytest.raises(RepeatedData):
        place(buffer, "base", "map", 2, at=10)
    with pytest.raises(OldData):
        place(buffer, "base", "map", 2, at=4)
    place(buffer, "base", "map", 3, at=11, static=True)
    assert x_of(buffer, "map", "base", at=10.5) == 2
    place(buffer, "camera", "base", 1, static=True)
    place(buffer, "camera", "base", 2, at=10)
    assert x_of(buffer, "base", "camera", at=99) == 2
    assert (len(buffer), buffer.samples) == (2, 3)


FRAMES = st.sampled_from("abcde")


@given(st.lists(st.tuples(FRAMES, FRAMES, st.integers(0, 40), st.booleans())))
def test_random_inserts_and_lookups(
    samples: list[tuple[str, str, int, bool]],
) -> None:
    buffer = Buffer()
    for frame, parent, at, static in samples:
        try:
            place(buffer, frame, parent, 1, at, static)
        except InvalidTransform:
            assert frame == parent
        assert buffer.samples == sum(map(len, buffer._frames.values()))
    for target in "abcde":
        for source in "abcde":
            for at in (0, 20):
                try:
                    buffer.lookup(target, source, at * SECOND)
                except TransformError:
                    assert target != source


def test_times_of_messages_are_taken_and_returned() -> None:
    buffer = Buffer(cache_time=0.5)
    for seconds in (1, 2, 2.25):
        buffer.insert(
            "base", Sample(round(seconds * SECOND), "map", Transform((seconds, 0.0, 0.0)))
        )
    moment = Time(2, 125_000_000)
    found = buffer.lookup("map", "base", moment)
    assert (found.time, found.transform.translation[0]) == (moment, 2.125)
    buffer.check("map", "base", moment)
    with pytest.raises(TransformOutOfTime):
        buffer.check("map", "base", Time(1))
