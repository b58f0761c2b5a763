"""A queue of frames in which every source keeps only its newest ones."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fibws.protocol.frame_queue import FrameQueue, Lane


def frames(queue: FrameQueue) -> list[bytes]:
    return [queue.pop()[0] for _ in range(len(queue))]


def test_frames_leave_in_order_and_with_their_lanes() -> None:
    queue, lane = FrameQueue(), Lane(2)
    queue.put(b"1", lane)
    queue.put(b"2")
    queue.put(b"3", lane)
    assert list(queue) == [(b"1", lane), (b"2", None), (b"3", lane)]
    assert [queue.pop() for _ in range(3)] == [(b"1", lane), (b"2", None), (b"3", lane)]
    assert not lane.waiting
    with pytest.raises(KeyError):
        queue.pop()


def test_size_counts_bytes_and_the_cost_of_each_frame() -> None:
    queue, lane = FrameQueue(cost=100), Lane(5)
    for number in range(4):
        queue.put(bytes(number), lane)
    assert (len(queue), queue.size) == (4, 406)
    queue.pop()
    queue.trim(lane, 2)
    assert queue.size == 205
    queue.put(b"12345")
    queue.forget(lane)
    assert queue.size == 105
    queue.clear()
    assert (len(queue), queue.size) == (0, 0)


def test_trim_drops_the_oldest_frames_of_one_lane() -> None:
    queue, lane, other = FrameQueue(), Lane(2), Lane(2)
    for number in range(4):
        queue.put(b"%d" % number, lane)
        queue.put(b"other", other)
    assert queue.trim(lane, lane.limit) == 2
    assert queue.trim(lane, lane.limit) == 0
    assert (lane.dropped, other.dropped) == (2, 0)
    assert frames(queue) == [b"other", b"other", b"2", b"other", b"3", b"other"]


def test_forgotten_frames_do_not_count_as_dropped() -> None:
    queue, lane = FrameQueue(), Lane(2)
    queue.put(b"1", lane)
    queue.put(b"2")
    queue.forget(lane)
    assert (lane.dropped, frames(queue)) == (0, [b"2"])


def test_cleared_lane_can_be_used_again() -> None:
    queue, lane = FrameQueue(), Lane(1)
    queue.put(b"1", lane)
    queue.clear()
    queue.put(b"2", lane)
    assert queue.trim(lane, 1) == 0
    assert frames(queue) == [b"2"]


@given(st.lists(st.tuples(st.sampled_from(["put", "pop", "trim", "forget"]), st.integers(0, 2))))
def test_queue_agrees_with_a_plain_list(steps: list[tuple[str, int]]) -> None:
    queue = FrameQueue(cost=1)
    lanes = [Lane(2), Lane(1), None]
    expected: list[tuple[bytes, Lane | None]] = []
    for number, (step, which) in enumerate(steps):
        lane = lanes[which]
        if step == "put":
            queue.put(b"%d" % number, lane)
            expected.append((b"%d" % number, lane))
        elif step == "pop":
            if expected:
                assert queue.pop() == expected.pop(0)
        elif lane is not None:
            own = [each for each in expected if each[1] is lane]
            gone = own[: max(0, len(own) - lane.limit)] if step == "trim" else own
            expected = [each for each in expected if not any(each is one for one in gone)]
            if step == "trim":
                assert queue.trim(lane, lane.limit) == len(gone)
            else:
                queue.forget(lane)
        assert list(queue) == expected
        assert queue.size == sum(len(frame) + 1 for frame, _ in expected)
