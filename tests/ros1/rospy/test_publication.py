"""The state that all publishers of a topic share: registration, numbering and listeners."""

from __future__ import annotations

import asyncio
from typing import Any

import pytest
import rospy
from genpy.message import get_message_class
from rospy import core
from rospy.publication import Publication

import fibws
from ros1.rospy.programs import running_hub


async def test_message_that_the_hub_does_not_take_is_an_error() -> None:
    async with running_hub(max_message_size=20_000) as programs:
        assert await programs.run("""
            import rospy
            from std_msgs.msg import String

            rospy.init_node("talker")
            for latch in (False, True):
                publisher = rospy.Publisher("large", String, latch=latch, queue_size=10)
                try:
                    publisher.publish("x" * 20_000)
                except rospy.ROSSerializationException as error:
                    print(error)
            publisher = rospy.Publisher("small", String, latch=True, queue_size=10)
            publisher.publish("goes on")
            print(rospy.wait_for_message("small", String).data)
        """) == [
            *2
            * [
                "/large: a message of 20009 bytes is larger than the hub takes "
                "(limit 20000, --max-message-size of the hub)"
            ],
            "goes on",
        ]


async def test_message_can_be_published_to_one_peer() -> None:
    async with running_hub() as programs:
        program = await programs.start("""
            import rospy
            from std_msgs.msg import String

            class Listener(rospy.SubscribeListener):
                def peer_subscribe(self, topic_name, topic_publish, peer_publish):
                    print("came to", topic_name, flush=True)
                    peer_publish(String("welcome"))
                    topic_publish(String("somebody came"))

                def peer_unsubscribe(self, topic_name, num_peers):
                    print("left", topic_name, num_peers, flush=True)

            rospy.init_node("talker")
            publisher = rospy.Publisher("chatter", String, Listener(), queue_size=10)
            print("ready")
            rospy.spin()
        """)
        assert await program.read_line() == "ready"
        async with (
            fibws.Node("first", hub=programs.hub.url) as first,
            fibws.Node("second", hub=programs.hub.url) as second,
        ):
            early = first.subscribe("chatter", "std_msgs/String")
            assert await program.read_line() == "came to /chatter"
            async with asyncio.timeout(60):
                said = [(await anext(early)).data for _ in range(2)]
                assert said == ["welcome", "somebody came"]
                late = second.subscribe("chatter", "std_msgs/String")
                assert await program.read_line() == "came to /chatter"
                assert (await anext(early)).data == "somebody came"
                assert [(await anext(late)).data for _ in range(2)] == ["welcome", "somebody came"]
            late.close()
            assert await program.read_line() == "left /chatter 1"
            early.close()
            assert await program.read_line() == "left /chatter 0"
        program.interrupt()
        assert await program.finish() == []


async def test_error_of_a_listener_is_logged() -> None:
    async with running_hub() as programs:
        program = await programs.start("""
            import rospy
            from rosgraph_msgs.msg import Log
            from std_msgs.msg import String

            class Listener(rospy.SubscribeListener):
                def peer_subscribe(self, topic_name, topic_publish, peer_publish):
                    raise ValueError("not you")

            rospy.init_node("talker")
            log = rospy.Subscriber("rosout", Log, lambda line: print(line.msg, flush=True))
            while not log.get_num_connections():
                rospy.sleep(0.01)
            rospy.Publisher("chatter", String, Listener(), queue_size=10)
            rospy.Subscriber("chatter", String, print)
            rospy.spin()
        """)
        assert (await program.read_line()).startswith(
            "bad callback: <bound method Listener.peer_subs"
        )
        while await program.read_line() != "ValueError: not you":
            pass
        program.interrupt()
        await program.finish()


async def test_invalid_message_raises_once_there_is_a_subscriber() -> None:
    async with running_hub() as programs, fibws.Node("listener", hub=programs.hub.url) as node:
        program = await programs.start("""
            import rospy
            from std_msgs.msg import Int8

            rospy.init_node("talker")
            publisher = rospy.Publisher("number", Int8, queue_size=10)
            publisher.publish(200)
            print("nobody minded")
            while not publisher.get_num_connections():
                rospy.sleep(0.01)
            for wrong in (200, "one", 1.5, None):
                try:
                    publisher.publish(wrong)
                    print("all right")
                except rospy.ROSSerializationException as fault:
                    print(fault)
        """)
        assert await program.read_line() == "nobody minded"
        async with node.subscribe("number", "std_msgs/Int8"):
            assert await program.finish() == [
                "field data exceeds specified width [int8]",
                "field data must be an integer type",
                "field data must be an integer type",
                "all right",
            ]


async def test_headers_are_numbered_from_the_first_subscriber() -> None:
    async with running_hub() as programs, fibws.Node("listener", hub=programs.hub.url) as node:
        program = await programs.start("""
            import rospy
            from rospy_tutorials.msg import HeaderString

            rospy.init_node("talker")
            publisher = rospy.Publisher("chatter", HeaderString, queue_size=10)
            message = HeaderString()
            publisher.publish(message)
            print("not heard:", message.header.seq)
            while not publisher.get_num_connections():
                rospy.sleep(0.01)
            for _ in range(3):
                publisher.publish(message)
            print("heard:", message.header.seq)
        """)
        assert await program.read_line() == "not heard: 0"
        async with node.subscribe("chatter", "rospy_tutorials/HeaderString") as chatter:
            assert await program.finish() == ["heard: 3"]
            async with asyncio.timeout(60):
                first, second, third = [(await anext(chatter)).header.seq for _ in range(3)]
            assert [second - first, third - second] == [1, 1]


async def test_later_publisher_can_latch_and_set_headers() -> None:
    async with running_hub() as programs, fibws.Node("listener", hub=programs.hub.url) as node:
        program = await programs.start("""
            import rospy
            from std_msgs.msg import String

            rospy.init_node("talker")
            first = rospy.Publisher("chatter", String, queue_size=10)
            first.publish("before")
            headers = {"a": "b"}
            second = rospy.Publisher("chatter", String, latch=True, headers=headers, queue_size=9)
            first.publish("kept")
            heard = rospy.wait_for_message("chatter", String)
            print(heard.data, heard._connection_header["latching"])
            rospy.spin()
        """)
        assert await program.read_line() == "kept 1"
        async with node.subscribe("chatter", "std_msgs/String", headers=True) as chatter:
            async with asyncio.timeout(60):
                assert (await anext(chatter)).data == "kept"
            assert chatter.connection_header == {"callerid": "/talker", "latching": "1", "a": "b"}
        assert await node.graph.publishers("chatter") == ["/talker"]
        program.interrupt()
        assert await program.finish() == []


async def test_any_msg_is_relayed_unchanged() -> None:
    async with running_hub() as programs, fibws.Node("node", hub=programs.hub.url) as node:
        relay = await programs.start("""
            import rospy
            from std_msgs.msg import String

            rospy.init_node("relay")
            anything = rospy.Publisher("anything", rospy.AnyMsg, queue_size=10)
            typed = rospy.Publisher("typed", String, queue_size=10)

            def hear(message):
                print(message._buff.hex(), message._connection_header["type"], flush=True)
                anything.publish(message)
                typed.publish(message)

            rospy.Subscriber("chatter", rospy.AnyMsg, hear)
            try:
                anything.publish(rospy.AnyMsg())
            except rospy.ROSException as fault:
                print(fault)
            rospy.spin()
        """)
        assert (await relay.read_line()).startswith("unknown type of the messages for /anything")
        chatter = await node.advertise("chatter", "std_msgs/String", latch=True, peers=True)
        typed = node.subscribe("typed", "std_msgs/String")
        await chatter.publish("hi")
        assert await relay.read_line() == "020000006869 std_msgs/String"
        async with asyncio.timeout(60):
            assert (await anext(typed)).data == "hi"
        assert await node.graph.topic_type("anything") == "std_msgs/String"
        relay.interrupt()
        assert await relay.finish() == []


async def test_any_msg_of_an_unknown_type_is_relayed() -> None:
    definition = "Inner inner\n" + "=" * 80 + "\nMSG: made_up/Inner\nint32 number\n"
    async with running_hub() as programs, fibws.Node("node", hub=programs.hub.url) as node:
        relay = await programs.start("""
            import rospy

            rospy.init_node("relay")
            anything = rospy.Publisher("anything", rospy.AnyMsg, latch=True, queue_size=10)

            def relay(message):
                header = message._connection_header
                print(header["type"], header["md5sum"], repr(header["message_definition"]))
                anything.publish(message)

            rospy.Subscriber("chatter", rospy.AnyMsg, relay)
            rospy.spin()
        """)
        chatter = await node.advertise_serialized(
            "chatter", "made_up/Outer", definition=definition, latch=True
        )
        await chatter.publish(b"\5\0\0\0")
        type_, md5sum, text = (await relay.read_line()).split(maxsplit=2)
        assert type_ == "made_up/Outer"
        assert len(md5sum) == 32
        assert "int32 number" in text
        async with asyncio.timeout(60):
            async with node.subscribe("anything", rospy.AnyMsg) as anything:
                assert (await anext(anything))._buff == b"\5\0\0\0"
                assert (anything.type, anything.md5sum) == (type_, md5sum)
        relay.interrupt()
        assert await relay.finish() == []


async def test_any_msg_without_a_header_has_the_type_of_the_topic() -> None:
    async with running_hub() as programs, fibws.Node("node", hub=programs.hub.url) as node:
        chatter = node.subscribe("chatter", "std_msgs/String")
        program = await programs.start("""
            import rospy

            rospy.init_node("talker")
            publisher = rospy.Publisher("chatter", rospy.AnyMsg, latch=True, queue_size=10)
            try:
                publisher.publish(rospy.AnyMsg())
            except rospy.ROSException as fault:
                print(fault)
            message = rospy.AnyMsg()
            message._buff = b"\\2\\0\\0\\0hi"
            publisher.publish(message)
            rospy.spin()
        """)
        assert await program.read_line() == "AnyMsg is not initialized"
        async with asyncio.timeout(60):
            assert (await anext(chatter)).data == "hi"
        program.interrupt()
        assert await program.finish() == []


async def test_latched_message_is_kept_with_another_publisher() -> None:
    async with running_hub() as programs, fibws.Node("listener", hub=programs.hub.url) as node:
        program = await programs.start("""
            import rospy
            from std_msgs.msg import String

            rospy.init_node("talker")
            first = rospy.Publisher("chatter", String, latch=True, queue_size=10)
            first.publish("kept")
            second = rospy.Publisher("chatter", String, queue_size=1, headers={"who": "second"})
            print("ready")
            third = rospy.Publisher("chatter", String, queue_size=1)
            rospy.wait_for_message("go", String)
            second.publish("next")
            rospy.spin()
        """)
        assert await program.read_line() == "ready"
        go = await node.advertise("go", "std_msgs/String", latch=True)
        async with node.subscribe("chatter", "std_msgs/String", headers=True) as chatter:
            async with asyncio.timeout(60):
                assert (await anext(chatter)).data == "kept"
                await go.publish()
                assert (await anext(chatter)).data == "next"
            assert chatter.connection_header["who"] == "second"
        program.interrupt()
        assert await program.finish() == []


@pytest.mark.parametrize("wrong", ["advertise", "subscribe"])
async def test_node_of_another_type_keeps_no_publisher_out(wrong: str) -> None:
    async with (
        running_hub() as programs,
        fibws.Node("node", hub=programs.hub.url) as node,
        fibws.Node("right", hub=programs.hub.url) as right,
    ):
        made: Any = getattr(node, wrong)("chatter", "std_msgs/Int32")
        if wrong == "advertise":
            await made
        await node.flush()
        chatter = right.subscribe("chatter", "std_msgs/String")
        program = await programs.start("""
            import rospy
            from std_msgs.msg import String

            rospy.init_node("talker")
            publisher = rospy.Publisher("chatter", String, queue_size=10, latch=True)
            publisher.publish("hello")
            rospy.spin()
        """)
        async with asyncio.timeout(60):
            assert (await anext(chatter)).data == "hello"
        program.interrupt()
        await program.finish()


def test_publish_after_shutdown_gives_way_to_the_node(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    gave_way: list[str] = []
    monkeypatch.setattr(core, "_shutdown", True)
    monkeypatch.setattr(core.background, "give_way", lambda: gave_way.append("once"))
    string = get_message_class("std_msgs/String")
    assert string is not None
    Publication("/chatter", string).publish(string("nobody hears this"))
    assert gave_way == ["once"]
