"""The transforms that one client of tf2_web_republisher receives."""

from __future__ import annotations

import logging
import math

import pytest

from fibws.tf import selection as module
from fibws.tf.buffer import Buffer
from fibws.tf.errors import InvalidTransform
from fibws.tf.history import Sample
from fibws.tf.selection import Selection
from fibws.tf.transform import Transform, of_yaw_pitch_roll

LOG = logging.getLogger("tests.transforms.selection")
ANGULAR, TRANSLATIONAL = 0.1, 0.01


@pytest.fixture
def buffer() -> Buffer:
    return Buffer()


def place(buffer: Buffer, frame: str, x: float = 0, yaw: float = 0, *, sign: int = 1) -> None:
    qx, qy, qz, qw = of_yaw_pitch_roll(yaw, 0, 0)
    rotation = (sign * qx, sign * qy, sign * qz, sign * qw)
    buffer.insert(frame, Sample(1, "map", Transform((x, 0.0, 0.0), rotation)))


def select(
    *sources: str, angular: float = ANGULAR, translational: float = TRANSLATIONAL
) -> Selection:
    return Selection("/map", sources, angular, translational, LOG)


def test_first_transform_counts_as_a_change(buffer: Buffer) -> None:
    place(buffer, "base")
    selection = select("/base")
    assert selection.changes(buffer) == {"base": Transform()}
    assert selection.target == "map"
    assert selection.changes(buffer) == {}


def test_translation_above_the_threshold_is_a_change(buffer: Buffer) -> None:
    selection = select("base")
    reported = []
    for x in (1.0, 1.009, 1.0101, 1.02, 1.0001):
        place(buffer, "base", x)
        reported += [change.translation[0] for change in selection.changes(buffer).values()]
    assert reported == [1.0, 1.0101, 1.0001]


def test_rotation_above_the_threshold_is_a_change(buffer: Buffer) -> None:
    selection = select("base")
    reported = []
    for yaw in (1.0, 1.099, 1.101, 1.19, 0.9):
        place(buffer, "base", yaw=yaw)
        reported += [yaw for _ in selection.changes(buffer)]
    assert reported == [1.0, 1.101, 0.9]


def test_quaternion_of_opposite_sign_is_not_a_change(buffer: Buffer) -> None:
    selection = select("base")
    place(buffer, "base", yaw=1)
    assert selection.changes(buffer)
    place(buffer, "base", yaw=1, sign=-1)
    assert selection.changes(buffer) == {}


def test_small_steps_add_up_to_a_change(buffer: Buffer) -> None:
    selection = select("base")
    reported = 0
    for step in range(101):
        place(buffer, "base", step * 0.001)
        reported += len(selection.changes(buffer))
    assert reported == 1 + 9


@pytest.mark.parametrize(("angular", "translational"), [(0, 1), (1, 0), (0, 0), (-1, 1)])
def test_with_a_threshold_of_0_all_transforms_are_changes(
    buffer: Buffer, angular: float, translational: float
) -> None:
    place(buffer, "base")
    selection = select("base", angular=angular, translational=translational)
    for _ in range(3):
        assert selection.changes(buffer) == {"base": Transform()}


def test_with_infinite_thresholds_only_the_first_transform_is_a_change(buffer: Buffer) -> None:
    place(buffer, "base")
    selection = select("base", angular=math.inf, translational=math.inf)
    assert selection.changes(buffer)
    place(buffer, "base", 1e6, 3)
    assert selection.changes(buffer) == {}


def test_frames_change_independently(buffer: Buffer) -> None:
    selection = select("base", "arm", "base", "map")
    for frame in ("base", "arm"):
        place(buffer, frame)
    assert list(selection.changes(buffer)) == ["base", "arm", "map"]
    place(buffer, "arm", 1)
    assert list(selection.changes(buffer)) == ["arm"]


def test_renew_reports_all_transforms_again(buffer: Buffer) -> None:
    place(buffer, "base")
    selection = select("base")
    assert selection.changes(buffer)
    selection.renew()
    assert selection.changes(buffer) == {"base": Transform()}


def test_unknown_frame_is_logged_once(buffer: Buffer, caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level(logging.INFO)
    place(buffer, "arm")
    selection = select("base", "arm")
    assert list(selection.changes(buffer)) == ["arm"]
    assert selection.changes(buffer) == {}
    place(buffer, "base")
    assert list(selection.changes(buffer)) == ["base"]
    selection.changes(buffer)
    assert [record.levelno for record in caplog.records] == [logging.WARNING, logging.INFO]
    assert all("base" in record.getMessage() for record in caplog.records)


@pytest.mark.parametrize(
    ("target", "sources", "thresholds", "fault"),
    [
        ("", ["base"], (0, 0), "a frame's id is empty"),
        ("map", ["base", "/"], (0, 0), "a frame's id is empty"),
        ("map", ["base"], (math.nan, 0), "a threshold"),
        ("map", ["base"], (0, math.nan), "a threshold"),
        ("map", list("abcd"), (0, 0), "4 .*limit 3"),
    ],
)
def test_invalid_selection_is_an_error(
    monkeypatch: pytest.MonkeyPatch,
    target: str,
    sources: list[str],
    thresholds: tuple[float, float],
    fault: str,
) -> None:
    monkeypatch.setattr(module, "MAX_FRAMES", 3)
    with pytest.raises(InvalidTransform, match=fault):
        Selection(target, sources, *thresholds, LOG)
