"""Publishers and subscribers in programs."""

from __future__ import annotations

import warnings
from functools import partial
from typing import Any

import numpy
import pytest
from rospy import core
from rospy.exceptions import ROSException
from rospy.topics import Publisher, Shared, Subscriber
from std_msgs.msg import Int32, String

import fibws
from ros1.rospy.programs import running_hub


async def test_message_is_received_by_another_program() -> None:
    async with running_hub() as programs:
        listener = await programs.start("""
            import rospy
            from std_msgs.msg import String

            def hear(message, number):
                print(message.data, number)
                if message.data == "last":
                    rospy.signal_shutdown("done")

            rospy.Subscriber("chatter", String, hear, 7)
            rospy.init_node("listener")
            print("ready")
            rospy.spin()
        """)
        assert await listener.read_line() == "ready"
        await programs.run("""
            import rospy
            from std_msgs.msg import String

            early = rospy.Publisher("chatter", String, queue_size=10)
            rospy.init_node("talker")
            while not early.get_num_connections():
                rospy.sleep(0.01)
            early.publish("by order")
            early.publish(data="by name")
            rospy.Publisher("chatter", String, queue_size=10).publish(String("whole"))
            rospy.on_shutdown(lambda: early.publish("last"))
        """)
        assert await listener.finish() == ["by order 7", "by name 7", "whole 7", "last 7"]


async def test_subscribers_of_a_topic_share_a_connection_and_a_thread() -> None:
    async with running_hub() as programs, fibws.Node("talker", hub=programs.hub.url) as node:
        chatter = await node.advertise("chatter", "std_msgs/String", latch=True)
        await chatter.publish("kept")
        program = await programs.start("""
            import rospy, sys, threading
            from std_msgs.msg import String

            rospy.init_node("listener")

            def hear(message, name):
                # In one piece, since both threads may write at the same time.
                sys.stdout.write(f"{name} {message.data} {threading.current_thread().name}\\n")

            first = rospy.Subscriber("chatter", String, hear, "first")
            rospy.wait_for_message("chatter", String)
            second = rospy.Subscriber("chatter", String, hear, "second")
            rospy.spin()
        """)
        # What is latched comes at once, maybe before the first one's thread has printed it.
        said = {await program.read_line(), await program.read_line()}
        assert said == {"first kept /chatter", "second kept MainThread"}
        assert await node.graph.subscribers("chatter") == ["/listener"]
        await chatter.publish("both")
        assert [await program.read_line(), await program.read_line()] == [
            "first both /chatter",
            "second both /chatter",
        ]
        program.interrupt()
        assert await program.finish() == []


async def test_unregistered_handles_neither_receive_nor_publish() -> None:
    async with running_hub() as programs:
        assert await programs.run("""
            import rospy, threading
            from std_msgs.msg import String

            heard = threading.Event()

            def hear(message):
                print("heard", message.data)
                heard.set()

            rospy.init_node("node")
            publisher = rospy.Publisher("chatter", String, queue_size=10)
            gone = rospy.Subscriber("chatter", String, lambda message: print("gone heard it"))
            rospy.Subscriber("chatter", String, hear)
            gone.unregister()
            gone.unregister()
            while not publisher.get_num_connections():
                rospy.sleep(0.01)
            publisher.publish("something")
            heard.wait(60)
            publisher.unregister()
            print(publisher.resolved_name, publisher.type, publisher.name)
            try:
                publisher.publish("more")
            except rospy.ROSException as fault:
                print(fault)
        """) == ["heard something", "None None /chatter", "publish() to an unregistered() handle"]


async def test_wait_for_message_returns_a_message_or_times_out() -> None:
    async with running_hub() as programs, fibws.Node("talker", hub=programs.hub.url) as node:
        await (await node.advertise("chatter", "std_msgs/String", latch=True)).publish("hello")
        assert await programs.run("""
            import rospy
            from std_msgs.msg import String

            rospy.init_node("node")
            print(rospy.wait_for_message("chatter", String, timeout=rospy.Duration(60)).data)
            try:
                rospy.wait_for_message("silence", String, timeout=0.05)
            except rospy.ROSException as fault:
                print(fault)
        """) == ["hello", "timeout exceeded while waiting for message on topic silence"]


async def test_shutdown_interrupts_wait_for_message() -> None:
    async with running_hub() as programs:
        program = await programs.start("""
            import rospy
            from std_msgs.msg import String

            rospy.init_node("node")
            print("ready")
            try:
                rospy.wait_for_message("silence", String)
            except rospy.ROSInterruptException as fault:
                print(fault)
        """)
        assert await program.read_line() == "ready"
        program.interrupt()
        assert await program.finish() == ["rospy shutdown"]


@pytest.mark.parametrize(
    ("name", "data_class", "fault"),
    [
        ("", String, "topic name is not a non-empty string"),
        (5, String, "topic name is not a non-empty string"),
        ("x", None, "topic parameter 'data_class' is not initialized"),
        ("x", "std_msgs/String", "data_class [std_msgs/String] is not a class"),
        ("x", int, "data_class [type] is not a message data class"),
        ("~x", String, "~name topics cannot be created before init_node() has been called"),
    ],
)
@pytest.mark.parametrize("make", [Subscriber, partial(Publisher, queue_size=1)])
def test_topic_needs_a_name_and_a_class(make: Any, name: Any, data_class: Any, fault: str) -> None:
    with pytest.raises(ValueError) as raised:
        make(name, data_class)
    assert str(raised.value) == fault


@pytest.mark.parametrize("size", [10, 10.0, numpy.int64(10), numpy.float32(10)], ids=repr)
def test_queue_size_of_a_publisher_may_be_any_number(size: Any) -> None:
    publisher = Publisher("chatter", String, queue_size=size)
    assert publisher.impl is not None
    assert repr(publisher.impl.queue_size) == "10"
    publisher.unregister()


def test_publisher_without_queue_size_or_node_is_reported() -> None:
    with pytest.warns(SyntaxWarning, match="explicit keyword argument 'queue_size'") as warned:
        publisher = Publisher("chatter", String)
    assert warned[0].filename == __file__
    assert not core.is_initialized()
    with pytest.raises(ROSException) as raised:
        publisher.publish("too early")
    assert str(raised.value).startswith("ROS node has not been initialized yet.")
    assert publisher.get_num_connections() == 0
    publisher.unregister()
    with pytest.raises(ROSException):
        publisher.get_num_connections()


def test_illegal_topic_name_gives_a_warning() -> None:
    with warnings.catch_warnings(record=True) as warned:
        warnings.simplefilter("always")
        Subscriber("no name", Int32).unregister()
    assert [str(each.message)[:60] for each in warned] == [
        "'no name' is not a legal ROS graph resource name. This may c"
    ]


@pytest.mark.parametrize("size", [0, 1.5, "1"])
def test_invalid_queue_size_is_an_error(size: Any) -> None:
    with pytest.raises(ROSException, match="queue size"):
        Subscriber("chatter", String, queue_size=size)


async def test_objects_of_the_program_are_deleted_at_its_end() -> None:
    async with running_hub() as programs:
        said = await programs.run("""
            import rospy
            from std_msgs.msg import String

            class Robot:
                def __init__(self):
                    self.stops = rospy.Publisher("stops", String, queue_size=1)
                    self.orders = rospy.Subscriber("orders", String, self.hear)

                def hear(self, message):
                    pass

                def __del__(self):
                    self.stops.publish("stop")
                    self.orders.unregister()
                    print("deleted")

            rospy.init_node("robot")
            robot = Robot()
        """)
        assert said == ["deleted"]


def test_class_instead_of_a_message_is_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(core, "_initialized", True)
    publisher = Publisher("chatter", String, queue_size=1)
    with pytest.raises(TypeError, match=r"got the class String: write String\(\)"):
        publisher.publish(String)
    publisher.unregister()


async def test_infinity_and_nan_are_received_unchanged() -> None:
    async with running_hub() as programs:
        listener = await programs.start("""
            import rospy
            from sensor_msgs.msg import LaserScan

            rospy.init_node("listener")
            print("ready", flush=True)
            scan = rospy.wait_for_message("scan", LaserScan)
            print(scan.range_max, scan.ranges)
        """)
        assert await listener.read_line() == "ready"
        laser = await programs.start("""
            import rospy
            from sensor_msgs.msg import LaserScan

            rospy.init_node("laser")
            scans = rospy.Publisher("scan", LaserScan, queue_size=1, latch=True)
            inf = float("inf")
            scans.publish(LaserScan(range_max=inf, ranges=[1.5, inf, -inf, float("nan")]))
            rospy.spin()
        """)
        assert await listener.finish() == ["inf (1.5, inf, -inf, nan)"]
        laser.interrupt()
        assert await laser.finish() == []


# Objects that publishers or subscribers share


class Impl:
    def __init__(self, resolved_name: str, data_class: Any) -> None:
        self.resolved_name = resolved_name
        self.data_class = data_class
        self.closings: list[str] = []

    def close(self) -> None:
        self.closings.append(self.resolved_name)


def test_topic_and_class_have_one_shared_object() -> None:
    shared = Shared(Impl)
    first = shared.acquire("/a", String)
    assert shared.acquire("/a", String) is first
    assert shared.acquire("/a", Int32) is not first
    assert shared.acquire("/b", String) is not first


def test_last_release_closes_the_shared_object() -> None:
    shared = Shared(Impl)
    impl = shared.acquire("/a", String)
    shared.acquire("/a", String)
    shared.release(impl)
    assert impl.closings == []
    shared.release(impl)
    assert impl.closings == ["/a"]
    assert shared.acquire("/a", String) is not impl


def test_shutdown_closes_all_shared_objects() -> None:
    shared = Shared(Impl)
    one, other = shared.acquire("/a", String), shared.acquire("/b", String)
    shared.close_all("the end")
    assert one.closings == ["/a"]
    assert other.closings == ["/b"]
    shared.release(one)
