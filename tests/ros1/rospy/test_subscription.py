"""The state that all subscribers of a topic share: subscription, queue and callbacks."""

from __future__ import annotations

import threading
from io import BytesIO
from typing import Any

import pytest
from rospy import subscription
from rospy.subscription import Subscription
from std_msgs.msg import String

import fibws
from fibws.node.subscription import Received
from ros1.rospy.programs import running_hub


async def test_messages_have_connection_headers() -> None:
    async with running_hub() as programs, fibws.Node("talker", hub=programs.hub.url) as node:
        chatter = await node.advertise(
            "chatter", "std_msgs/String", latch=True, headers={"cookies": "oreo"}
        )
        await chatter.publish("hello")
        assert await programs.run("""
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


async def test_slow_callback_gets_the_newest_messages() -> None:
    async with running_hub() as programs, fibws.Node("talker", hub=programs.hub.url) as node:
        chatter = await node.advertise("chatter", "std_msgs/Int32", queue_size=1000, peers=True)
        after = await node.advertise("after", "std_msgs/Int32", peers=True)
        program = await programs.start("""
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
        assert await program.read_line() == "0"
        for number in range(1, 101):
            await chatter.publish(number)
        await after.publish(0)
        assert [await program.read_line(), await program.read_line()] == ["99", "100"]
        program.interrupt()
        assert await program.finish() == []


async def test_error_of_a_callback_is_logged_and_the_next_message_is_passed() -> None:
    async with running_hub() as programs, fibws.Node("talker", hub=programs.hub.url) as node:
        chatter = await node.advertise("chatter", "std_msgs/Int32", peers=True)
        program = await programs.start("""
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
        text = await program.read_errors()
        assert "bad callback: <function hear at 0x" in text
        assert text.rstrip().endswith("ValueError: nothing")


async def test_publisher_of_another_type_is_logged_and_keeps_nothing_out() -> None:
    async with running_hub() as programs, fibws.Node("node", hub=programs.hub.url) as node:
        await (await node.advertise("chatter", "std_msgs/Int32")).publish(5)
        program = await programs.start("""
            import sys

            import rospy
            from rosgraph_msgs.msg import Log
            from std_msgs.msg import String

            def write(text):  # At once: print writes a line's end apart, and there are two threads.
                sys.stdout.write(text + "\\n")
                sys.stdout.flush()

            rospy.init_node("listener")
            log = rospy.Subscriber("rosout", Log, lambda line: write(line.msg))
            while not log.get_num_connections():
                rospy.sleep(0.01)
            rospy.Subscriber("chatter", String, lambda message: write(message.data))
            rospy.spin()
        """)
        warning = "subscribe: /chatter has type std_msgs/Int32 (published by /node)"
        lines = {await program.read_line(), await program.read_line()}
        assert {line.partition(warning)[0] for line in lines} == {
            "The hub: ",  # Of the node,
            "/listener: ",  # and of the hub.
        }
        async with fibws.Node("right", hub=programs.hub.url) as right:
            await (await right.advertise("chatter", "std_msgs/String")).publish("hello")
            while await program.read_line() != "hello":
                pass
        program.interrupt()
        await program.finish()


def test_only_added_callbacks_can_be_removed() -> None:
    topic = Subscription("/chatter", String)
    topic.add_callback(print, 1)
    topic.add_callback(print, 1)
    topic.remove_callback(print, 1)
    topic.remove_callback(print, 1)
    with pytest.raises(KeyError, match="no matching cb"):
        topic.remove_callback(print, 1)


@pytest.mark.parametrize("moment", ["before", "while", "after"])
def test_new_callback_gets_a_latched_message_once(moment: str) -> None:
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
    topic._call_back(message)
    if moment == "after":
        topic.add_callback(second, None)
    assert heard == ["kept"]


def test_new_callback_is_not_passed_queued_messages_early() -> None:
    topic = Subscription("/chatter", String)
    topic._source = Source()  # type: ignore[assignment]
    heard: list[str] = []
    begun, added, over = threading.Event(), threading.Event(), threading.Event()

    def slow(message: String) -> None:
        begun.set()
        added.wait(60)

    def last(message: String) -> None:
        if message.data == "second":
            over.set()

    topic.add_callback(slow, None)
    topic._take(received("first"))
    assert begun.wait(60)
    topic._take(received("second"))
    topic.add_callback(lambda message: heard.append(message.data), None)
    assert heard == ["first"]
    topic.add_callback(last, None)
    added.set()
    assert over.wait(60)
    assert heard == ["first", "second"]
    topic._queue.close()


async def test_dropped_messages_are_not_decoded() -> None:
    topic = Subscription("/chatter", String)
    topic.set_queue_size(1)
    source = Source()
    topic._source = source  # type: ignore[assignment]
    begun, go_on, over = threading.Event(), threading.Event(), threading.Event()

    def slow(message: String) -> None:
        begun.set()
        go_on.wait(60)
        if message.data == "last":
            over.set()

    topic.add_callback(slow, None)
    topic._take(received("first"))
    assert begun.wait(60)
    topic._take(received("dropped"))
    topic._take(received("last"))
    go_on.set()
    assert over.wait(60)
    assert source.decoded == ["first", "last"]
    topic._queue.close()


class Source:
    """A subscription of the node to a topic whose messages are latched."""

    type = "std_msgs/String"

    def __init__(self) -> None:
        self.decoded: list[str] = []

    def _decode(self, received: Received) -> Any:
        message = String().deserialize(bytes(received[0]))
        self.decoded.append(message.data)
        return message


def received(text: str) -> Received:
    """Return a message as it arrives."""
    buffer = BytesIO()
    String(text).serialize(buffer)
    return memoryview(buffer.getvalue()), b'{"latching":"1","callerid":"/talker"}'


def test_queue_size_of_minus_one_is_no_limit() -> None:
    topic = Subscription("/chatter", String)
    topic.set_queue_size(5)
    topic.set_queue_size(-1)
    assert topic._queue_size is None


def test_queue_without_a_size_is_limited_by_memory(monkeypatch: pytest.MonkeyPatch) -> None:
    topic = Subscription("/chatter", String)
    large = "x" * (1 << 20)
    assert topic._limit(received(large)) == subscription.MOST, "there is room for a few"
    monkeypatch.setattr(subscription, "FEW", 0)
    assert 60 < topic._limit(received(large)) <= 64
    assert 60 < topic._limit(({"data": large}, None)) <= 64, "JSON"
    assert topic._limit(received("x")) == subscription.MOST
