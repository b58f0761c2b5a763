"""What all subscribers of a topic share: its subscription, queue and callbacks."""

from __future__ import annotations

import threading

import pytest
from rospy import subscription
from rospy.subscription import Subscription
from std_msgs.msg import String

import fibws
from ros1.rospy.programs import world


async def test_a_message_knows_its_connection() -> None:
    async with world() as it, fibws.Node("talker", hub=it.hub.url) as node:
        chatter = await node.advertise(
            "chatter", "std_msgs/String", latch=True, headers={"cookies": "oreo"}
        )
        await chatter.publish("hello")
        assert await it.run("""
            import rospy
            from std_msgs.msg import String

            rospy.init_node("listener")
            header = rospy.wait_for_message("chatter", String)._connection_header
            for name in sorted(header):
                print(name, repr(header[name]))
        """) == [
            "callerid '/talker'",
            "cookies 'oreo'",
            "latching '1'",
            "md5sum '992ce8a1687cec8c8bd883ec73ca41d1'",
            r"message_definition 'string data\n'",
            "topic '/chatter'",
            "type 'std_msgs/String'",
        ]


async def test_a_slow_callback_gets_the_newest_messages() -> None:
    async with world() as it, fibws.Node("talker", hub=it.hub.url) as node:
        chatter = await node.advertise("chatter", "std_msgs/Int32", queue_size=1000, peers=True)
        after = await node.advertise("after", "std_msgs/Int32", peers=True)
        program = await it.start("""
            import rospy, threading
            from std_msgs.msg import Int32

            rospy.init_node("listener")
            all_sent = threading.Event()

            def hear(message):
                print(message.data, flush=True)
                all_sent.wait(60)

            rospy.Subscriber("chatter", Int32, hear, queue_size=2)
            rospy.Subscriber("after", Int32, lambda message: all_sent.set())
            rospy.spin()
        """)
        for publisher in (chatter, after):
            async for names in publisher.peers.changes():
                if names:
                    break
        await chatter.publish(0)
        assert await program.says() == "0"
        for number in range(1, 101):
            await chatter.publish(number)
        await after.publish(0)
        assert [await program.says(), await program.says()] == ["99", "100"]
        program.interrupt()
        assert await program.ends() == []


async def test_a_fault_of_a_callback_is_logged_and_the_next_message_comes() -> None:
    async with world() as it, fibws.Node("talker", hub=it.hub.url) as node:
        chatter = await node.advertise("chatter", "std_msgs/Int32", peers=True)
        program = await it.start("""
            import rospy
            from std_msgs.msg import Int32

            def hear(message):
                if not message.data:
                    raise ValueError("nothing")
                print("heard", message.data)
                rospy.signal_shutdown("done")

            rospy.init_node("listener")
            rospy.Subscriber("chatter", Int32, hear)
            rospy.spin()
        """)
        async for names in chatter.peers.changes():
            if names:
                break
        await chatter.publish(0)
        await chatter.publish(1)
        text = await program.complains()
        assert "bad callback: <function hear at 0x" in text
        assert text.rstrip().endswith("ValueError: nothing")


async def test_what_the_hub_refuses_is_logged() -> None:
    async with world() as it, fibws.Node("node", hub=it.hub.url) as node:
        await (await node.advertise("chatter", "std_msgs/Int32")).publish(5)
        program = await it.start("""
            import rospy
            from rosgraph_msgs.msg import Log
            from std_msgs.msg import String

            rospy.init_node("listener")
            log = rospy.Subscriber("rosout", Log, lambda line: print(line.msg, flush=True))
            while not log.get_num_connections():
                rospy.sleep(0.01)
            rospy.Subscriber("chatter", String, print)
            rospy.spin()
        """)
        assert (await program.says()).startswith(
            "unable to subscribe to /chatter: subscribe: Tried "
        )
        program.interrupt()
        assert await program.ends() == []


def test_one_may_take_back_only_what_one_has_added() -> None:
    topic = Subscription("/chatter", String)
    topic.add_callback(print, 1)
    topic.add_callback(print, 1)
    topic.remove_callback(print, 1)
    topic.remove_callback(print, 1)
    with pytest.raises(KeyError, match="no matching cb"):
        topic.remove_callback(print, 1)


@pytest.mark.parametrize("moment", ["before", "while", "after"])
def test_what_is_latched_is_told_once_whenever_one_comes(moment: str) -> None:
    topic = Subscription("/chatter", String)
    message = String("kept")
    message._connection_header = {"latching": "1", "callerid": "/talker"}
    heard: list[str] = []

    def second(message: String) -> None:
        heard.append(message.data)

    def first(message: String) -> None:
        if moment == "while":
            topic.add_callback(second, None)

    topic.add_callback(first, None)
    if moment == "before":
        topic.add_callback(second, None)
    topic._handle(message)
    if moment == "after":
        topic.add_callback(second, None)
    assert heard == ["kept"]


def test_what_waits_for_its_callbacks_is_not_told_before_them() -> None:
    topic = Subscription("/chatter", String)
    topic._source = _Latched()  # type: ignore[assignment]
    heard: list[str] = []
    begun, told, over = threading.Event(), threading.Event(), threading.Event()

    def slow(message: String) -> None:
        begun.set()
        told.wait(60)

    def last(message: String) -> None:
        if message.data == "second":
            over.set()

    topic.add_callback(slow, None)
    topic._take(String("first"))
    assert begun.wait(60)
    topic._take(String("second"))
    topic.add_callback(lambda message: heard.append(message.data), None)
    assert heard == ["first"]
    topic.add_callback(last, None)
    told.set()
    assert over.wait(60)
    assert heard == ["first", "second"]
    topic._inbox.close()


class _Latched:
    """Where latched messages come from."""

    def __init__(self) -> None:
        self.connection_header = {"latching": "1", "callerid": "/talker"}


def test_minus_one_is_for_no_bound() -> None:
    topic = Subscription("/chatter", String)
    topic.set_queue_size(5)
    topic.set_queue_size(-1)
    assert topic._queue_size is None


def test_where_nobody_bounds_the_queue_memory_does(monkeypatch: pytest.MonkeyPatch) -> None:
    topic = Subscription("/chatter", String)
    assert topic._bound(String("x" * (1 << 20))) == subscription.MOST, "there is room for a few"
    monkeypatch.setattr(subscription, "FEW", 0)
    assert 60 < topic._bound(String("x" * (1 << 20))) <= 64
    assert topic._bound(String("x")) == subscription.MOST
