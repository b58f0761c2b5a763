"""What is used is shared, and closed when nobody uses it any more."""

from __future__ import annotations

from typing import Any

from rospy.shared import Shared
from std_msgs.msg import Int32, String


class Impl:
    def __init__(self, resolved_name: str, data_class: Any) -> None:
        self.resolved_name = resolved_name
        self.data_class = data_class
        self.closings: list[str] = []

    def close(self) -> None:
        self.closings.append(self.resolved_name)


def test_one_topic_and_class_have_one_object() -> None:
    shared = Shared(Impl)
    first = shared.acquire("/a", String)
    assert shared.acquire("/a", String) is first
    assert shared.acquire("/a", Int32) is not first
    assert shared.acquire("/b", String) is not first


def test_the_last_user_closes_it() -> None:
    shared = Shared(Impl)
    impl = shared.acquire("/a", String)
    shared.acquire("/a", String)
    shared.release(impl)
    assert impl.closings == []
    shared.release(impl)
    assert impl.closings == ["/a"]
    assert shared.acquire("/a", String) is not impl


def test_the_nodes_end_closes_all() -> None:
    shared = Shared(Impl)
    one, other = shared.acquire("/a", String), shared.acquire("/b", String)
    shared.close_all("the end")
    assert one.closings == ["/a"]
    assert other.closings == ["/b"]
    shared.release(one)
