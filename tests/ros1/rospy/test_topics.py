"""What programs do with publishers and subscribers."""

from __future__ import annotations

import warnings
from functools import partial
from typing import Any

import pytest
from rospy import core
from rospy.exceptions import ROSException
from rospy.topics import Publisher, Shared, Subscriber
from std_msgs.msg import Int32, String

import fibws
from ros1.rospy.programs import world


async def test_a_message_goes_from_one_program_to_another() -> None:
    async with world() as it:
        listener = await it.start("""
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
        assert await listener.says() == "ready"
        await it.run("""
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
        assert await listener.ends() == ["by order 7", "by name 7", "whole 7", "last 7"]


async def test_subscribers_of_a_topic_share_a_connection_and_a_thread() -> None:
    async with world() as it, fibws.Node("talker", hub=it.hub.url) as node:
        chatter = await node.advertise("chatter", "std_msgs/String", latch=True)
        await chatter.publish("kept")
        program = await it.start("""
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
        said = {await program.says(), await program.says()}
        assert said == {"first kept /chatter", "second kept MainThread"}
        assert await node.graph.subscribers("chatter") == ["/listener"]
        await chatter.publish("both")
        assert [await program.says(), await program.says()] == [
            "first both /chatter",
            "second both /chatter",
        ]
        program.interrupt()
        assert await program.ends() == []


async def test_what_is_unregistered_hears_no_more_and_publishes_no_more() -> None:
    async with world() as it:
        assert await it.run("""
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


async def test_who_waits_for_a_message_gets_one_or_is_told() -> None:
    async with world() as it, fibws.Node("talker", hub=it.hub.url) as node:
        await (await node.advertise("chatter", "std_msgs/String", latch=True)).publish("hello")
        assert await it.run("""
            import rospy
            from std_msgs.msg import String

            rospy.init_node("node")
            print(rospy.wait_for_message("chatter", String, timeout=rospy.Duration(10)).data)
            try:
                rospy.wait_for_message("silence", String, timeout=0.05)
            except rospy.ROSException as fault:
                print(fault)
        """) == ["hello", "timeout exceeded while waiting for message on topic silence"]


async def test_the_end_of_the_node_ends_the_wait_for_a_message() -> None:
    async with world() as it:
        program = await it.start("""
            import rospy
            from std_msgs.msg import String

            rospy.init_node("node")
            print("ready")
            try:
                rospy.wait_for_message("silence", String)
            except rospy.ROSInterruptException as fault:
                print(fault)
        """)
        assert await program.says() == "ready"
        program.interrupt()
        assert await program.ends() == ["rospy shutdown"]


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
def test_a_topic_needs_a_name_and_a_class(
    make: Any, name: Any, data_class: Any, fault: str
) -> None:
    with pytest.raises(ValueError) as raised:
        make(name, data_class)
    assert str(raised.value) == fault


def test_a_publisher_needs_a_queue_size_and_a_node() -> None:
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


def test_a_name_that_ros_does_not_allow_is_warned_of() -> None:
    with warnings.catch_warnings(record=True) as warned:
        warnings.simplefilter("always")
        Subscriber("no name", Int32).unregister()
    assert [str(each.message)[:60] for each in warned] == [
        "'no name' is not a legal ROS graph resource name. This may c"
    ]


@pytest.mark.parametrize("size", [0, 1.5, "1"])
def test_a_queue_has_a_size(size: Any) -> None:
    with pytest.raises(ROSException, match="queue size"):
        Subscriber("chatter", String, queue_size=size)


async def test_the_programs_objects_live_no_longer_than_it() -> None:
    async with world() as it:
        said = await it.run("""
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


def test_a_class_is_no_message(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(core, "_initialized", True)
    publisher = Publisher("chatter", String, queue_size=1)
    with pytest.raises(TypeError, match=r"got the class String: write String\(\)"):
        publisher.publish(String)
    publisher.unregister()


async def test_infinity_arrives_as_it_is_and_nan_as_nan() -> None:
    async with world() as it:
        listener = await it.start("""
            import rospy
            from sensor_msgs.msg import LaserScan

            rospy.init_node("listener")
            print("ready", flush=True)
            scan = rospy.wait_for_message("scan", LaserScan)
            print(scan.range_max, scan.ranges)
        """)
        assert await listener.says() == "ready"
        laser = await it.start("""
            import rospy
            from sensor_msgs.msg import LaserScan

            rospy.init_node("laser")
            scans = rospy.Publisher("scan", LaserScan, queue_size=1, latch=True)
            inf = float("inf")
            scans.publish(LaserScan(range_max=inf, ranges=[1.5, inf, -inf, float("nan")]))
            rospy.spin()
        """)
        assert await listener.ends() == ["inf (1.5, inf, -inf, nan)"]
        laser.interrupt()
        assert await laser.ends() == []


# Objects that publishers or subscribers share


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
