"""`fibws.Node` with a scripted hub."""

from __future__ import annotations

import asyncio
import re
from collections.abc import Callable
from http import HTTPStatus
from inspect import isawaitable

import pytest

import fibws
from fibws.msg.std_msgs import Float64, Int32, String

from .conftest import ScriptedHub

# Name and address


def test_node_has_a_name_and_resolves_others() -> None:
    remapping = fibws.parse_remappings(["fibonacci:=numbers"])
    node = fibws.Node("talker", namespace="robot", remapping=remapping)
    assert (node.name, node.namespace) == ("/robot/talker", "/robot")
    assert node.resolve("fibonacci") == "/robot/numbers"
    assert repr(node) == f"<Node /robot/talker at {node.hub}>"
    with pytest.raises(fibws.InvalidName):
        fibws.Node("a/b")


def test_hub_argument_takes_precedence_over_the_environment(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv("FIBWS_HUB", "robot:9090")
    assert fibws.Node("talker").hub == "ws://robot:9090"
    assert fibws.Node("talker", hub="arm:9090").hub == "ws://arm:9090"


def test_default_hub_is_on_localhost(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("FIBWS_HUB", raising=False)
    assert fibws.Node("talker").hub == "ws://127.0.0.1:9090"


def test_invalid_hub_address_is_refused() -> None:
    with pytest.raises(ValueError, match="not the address of a hub"):
        fibws.Node("talker", hub="http://robot")


def test_now_is_the_time_of_day() -> None:
    assert fibws.Node("talker").now().secs > 1_700_000_000


# Publishing


async def test_node_sends_its_name_and_publishes(hub: ScriptedHub) -> None:
    async with fibws.Node("talker", hub=hub.url) as node:
        peer = await hub.peer()
        assert peer.path == "/?node=/talker"
        numbers = await node.advertise("fibonacci", Int32, queue_size=5, latch=True)
        await numbers.publish(1)
        await numbers.publish(data=2)
        await numbers.publish(Int32(3))
        assert (numbers.topic, numbers.type) == ("/fibonacci", "std_msgs/Int32")
        advertise = await peer.expect("advertise")
        assert advertise["topic"] == "/fibonacci"
        assert advertise["type"] == "std_msgs/Int32"
        assert (advertise["queue_size"], advertise["latch"]) == (5, True)
        assert "definition" not in advertise
        for number in (1, 2, 3):
            assert (await peer.expect("publish"))["msg"] == {"data": number}
        numbers.close()
        numbers.close()
        unadvertise = await peer.expect("unadvertise")
        assert (unadvertise["topic"], unadvertise["id"]) == ("/fibonacci", advertise["id"])
        with pytest.raises(fibws.NodeClosed):
            await numbers.publish(4)


async def test_invalid_message_raises_in_publish(hub: ScriptedHub) -> None:
    async with fibws.Node("talker", hub=hub.url) as node:
        numbers = await node.advertise("fibonacci", Int32)
        with pytest.raises(fibws.InvalidMessage, match="2147483648"):
            await numbers.publish(2**31)
        with pytest.raises(fibws.InvalidMessage, match="data"):
            await numbers.publish("1")  # type: ignore[call-overload]
        with pytest.raises(TypeError, match="arguments or keywords, but not both"):
            await numbers.publish(1, data=1)  # type: ignore[call-overload]
        with pytest.raises(TypeError, match=r"expected \[std_msgs/Int32\] but got \[std_msgs/St"):
            await numbers.publish(String("1"))  # type: ignore[call-overload]
        with pytest.raises(TypeError):
            await numbers.publish(date=1)  # type: ignore[call-overload]


async def test_type_may_be_a_name(hub: ScriptedHub) -> None:
    async with fibws.Node("talker", hub=hub.url) as node:
        peer = await hub.peer()
        numbers = await node.advertise("numbers", "std_msgs/msg/Float64")
        assert numbers.type == "std_msgs/Float64"
        await numbers.publish(Float64(1.5))
        await peer.expect("advertise")
        assert (await peer.expect("publish"))["msg"] == {"data": 1.5}
        with pytest.raises(fibws.InterfaceError, match="did you mean std_msgs/Int32"):
            await node.advertise("numbers", "std_msgs/Int23")
        with pytest.raises(fibws.InterfaceError):
            node.subscribe("numbers", "std_msgs/Int23")


async def test_queue_size_is_at_least_1(hub: ScriptedHub) -> None:
    async with fibws.Node("talker", hub=hub.url) as node:
        with pytest.raises(ValueError, match="queue_size"):
            await node.advertise("fibonacci", Int32, queue_size=0)
        with pytest.raises(ValueError, match="queue_size"):
            node.subscribe("fibonacci", Int32, queue_size=0)


async def test_refused_advertisement_is_raised_by_the_next_publish(hub: ScriptedHub) -> None:
    async with fibws.Node("talker", hub=hub.url) as node:
        peer = await hub.peer()
        numbers = await node.advertise("fibonacci", Int32)
        other = node.subscribe("other", Int32)
        advertise = await peer.expect("advertise")
        await peer.send("status", level="error", id=advertise["id"], msg="not this type")
        await peer.send("publish", topic="/other", msg={"data": 1})
        await anext(other)
        with pytest.raises(fibws.OperationRejected, match="not this type"):
            await numbers.publish(1)
        with pytest.raises(fibws.OperationRejected):
            await numbers.publish(1)
        numbers.close()


# Subscribing


async def test_messages_are_received_as_objects(hub: ScriptedHub) -> None:
    async with fibws.Node("listener", hub=hub.url) as node:
        peer = await hub.peer()
        async with node.subscribe("fibonacci", Int32) as numbers:
            assert (numbers.topic, numbers.type) == ("/fibonacci", "std_msgs/Int32")
            subscribe = await peer.expect("subscribe")
            assert (subscribe["topic"], subscribe["type"]) == ("/fibonacci", "std_msgs/Int32")
            await peer.send("publish", topic="/elsewhere", msg={"data": 7})
            await peer.send("publish", topic="/fibonacci", msg={"data": 8})
            assert await anext(numbers) == Int32(8)
        unsubscribe = await peer.expect("unsubscribe")
        assert (unsubscribe["topic"], unsubscribe["id"]) == ("/fibonacci", subscribe["id"])
        assert [number async for number in numbers] == []


async def test_invalid_messages_are_logged_and_skipped(
    hub: ScriptedHub, capsys: pytest.CaptureFixture[str]
) -> None:
    async with fibws.Node("listener", hub=hub.url) as node:
        peer = await hub.peer()
        numbers = node.subscribe("fibonacci", Int32)
        await peer.send("publish", topic="/fibonacci", msg={"data": "8"})
        await peer.send("publish", topic="/fibonacci")
        await peer.websocket.send("hello")
        await peer.websocket.send(b"\xff")
        await peer.send("nonsense")
        await peer.send("publish", topic="/fibonacci", msg={"data": 13})
        assert await anext(numbers) == Int32(13)
    errors = capsys.readouterr().err
    assert errors.count("Dropped a message on /fibonacci: ") == 2
    assert errors.count("The hub sent an invalid ") == 3


async def test_slow_reader_gets_the_newest_messages(hub: ScriptedHub) -> None:
    async with fibws.Node("listener", hub=hub.url) as node:
        peer = await hub.peer()
        numbers = node.subscribe("fibonacci", Int32, queue_size=2)
        last = node.subscribe("last", Int32)
        for number in range(5):
            await peer.send("publish", topic="/fibonacci", msg={"data": number})
        await peer.send("publish", topic="/last", msg={"data": 0})
        await anext(last)
        assert numbers.dropped == 3
        assert [await anext(numbers), await anext(numbers)] == [Int32(3), Int32(4)]


async def test_refused_subscription_is_raised_by_its_iteration(hub: ScriptedHub) -> None:
    async with fibws.Node("listener", hub=hub.url) as node:
        peer = await hub.peer()
        numbers = node.subscribe("fibonacci", Int32)
        subscribe = await peer.expect("subscribe")
        await peer.send("status", level="error", id=subscribe["id"], msg="not this type")
        with pytest.raises(fibws.OperationRejected, match="not this type"):
            await anext(numbers)


async def test_two_subscriptions_of_a_topic_both_receive_it(hub: ScriptedHub) -> None:
    async with fibws.Node("listener", hub=hub.url) as node:
        peer = await hub.peer()
        first = node.subscribe("fibonacci", Int32)
        second = node.subscribe("fibonacci", Int32)
        assert (await peer.expect("subscribe"))["id"] != (await peer.expect("subscribe"))["id"]
        await peer.send("publish", topic="/fibonacci", msg={"data": 1})
        assert await anext(first) == await anext(second) == Int32(1)


async def test_other_statuses_are_logged(
    hub: ScriptedHub, capsys: pytest.CaptureFixture[str]
) -> None:
    async with fibws.Node("listener", hub=hub.url):
        peer = await hub.peer()
        for level in ("error", "warning", "info", "none"):
            await peer.send("status", level=level, msg=f"a matter of {level}")
        for expected in (8, 4, 2, 2):
            assert (await peer.logged())["level"] == expected
    printed = capsys.readouterr()
    assert re.search(r"\[ERROR\] \[\d+\.\d{6}\]: The hub: a matter of error", printed.err)
    assert re.search(r"\[WARN\] \[\d+\.\d{6}\]: The hub: a matter of warning", printed.err)
    assert re.search(r"\[INFO\] \[\d+\.\d{6}\]: The hub: a matter of info", printed.out)


# The end


async def test_leaving_the_node_sends_pending_messages_and_unregisters(hub: ScriptedHub) -> None:
    async with fibws.Node("talker", hub=hub.url) as node:
        peer = await hub.peer()
        numbers = await node.advertise("fibonacci", Int32)
        subscription = node.subscribe("other", Int32)
        reading = asyncio.create_task(anext(subscription, None))
        spinning = asyncio.create_task(node.spin())
        for number in range(1000):
            await numbers.publish(number)
    await peer.expect("advertise")
    await peer.expect("subscribe")
    for number in range(1000):
        assert (await peer.expect("publish"))["msg"] == {"data": number}
    await peer.websocket.wait_closed()
    assert peer.websocket.close_code == 1000
    assert await reading is None
    await spinning
    with pytest.raises(StopAsyncIteration):
        await anext(node.rate(1))
    with pytest.raises(fibws.NodeClosed):
        await numbers.publish(1)
    with pytest.raises(fibws.NodeClosed):
        node.subscribe("other", Int32)
    numbers.close()
    subscription.close()
    node.log.info("this goes to the console only")


async def test_replaced_node_ends(hub: ScriptedHub) -> None:
    async with fibws.Node("talker", hub=hub.url) as node:
        peer = await hub.peer()
        numbers = await node.advertise("fibonacci", Int32)
        reading = asyncio.create_task(anext(node.subscribe("other", Int32)))
        await peer.websocket.close(4001, "new node registered with same name")
        with pytest.raises(fibws.NodeReplaced, match="/talker"):
            await reading
        with pytest.raises(fibws.NodeReplaced):
            await numbers.publish(1)
        with pytest.raises(fibws.NodeReplaced):
            async for _ in node.rate(1000):
                pass
        with pytest.raises(fibws.NodeReplaced):
            await node.spin()
    assert hub.attempts == 1


async def test_last_messages_are_read_before_the_end_is_raised(hub: ScriptedHub) -> None:
    async with fibws.Node("listener", hub=hub.url) as node:
        peer = await hub.peer()
        numbers = node.subscribe("fibonacci", Int32)
        await peer.send("publish", topic="/fibonacci", msg={"data": 1})
        await peer.websocket.close(4001, "new node registered with same name")
        with pytest.raises(fibws.NodeReplaced):
            await node.spin()
        assert await anext(numbers) == Int32(1)
        with pytest.raises(fibws.NodeReplaced):
            await anext(numbers)


@pytest.mark.parametrize(
    "status", [HTTPStatus.BAD_REQUEST, HTTPStatus.FORBIDDEN, HTTPStatus.NOT_FOUND]
)
async def test_refusal_by_the_hub_is_not_retried(hub: ScriptedHub, status: HTTPStatus) -> None:
    hub.refusal = (status, "not you\n")
    with pytest.raises(fibws.HubUnreachable, match=f"HTTP {status}: not you"):
        async with fibws.Node("talker", hub=hub.url):
            pytest.fail("there is no hub")
    assert hub.attempts == 1


async def test_node_can_be_entered_only_once(hub: ScriptedHub) -> None:
    async with fibws.Node("talker", hub=hub.url) as node:
        assert repr(node) == f"<Node /talker at {hub.url}>"
        with pytest.raises(RuntimeError, match="entered only once"):
            await node.__aenter__()
    with pytest.raises(RuntimeError, match="entered only once"):
        async with node:
            pass


async def test_node_may_be_started_and_closed_without_a_block(hub: ScriptedHub) -> None:
    node = fibws.Node("talker", hub=hub.url)
    assert await node.start() is node
    peer = await hub.peer()
    await node.advertise("numbers", Int32)
    await peer.expect("advertise")
    with pytest.raises(RuntimeError, match="entered only once"):
        await node.start()
    await node.close()
    await node.close()
    with pytest.raises(fibws.NodeClosed):
        node.subscribe("numbers", Int32)


async def test_node_that_was_never_started_can_be_closed() -> None:
    await fibws.Node("talker", hub="127.0.0.1:1").close()


USES: dict[str, Callable[[fibws.Node], object]] = {
    "advertise": lambda node: node.advertise("a", Int32),
    "advertise_serialized": lambda node: node.advertise_serialized("a", "std_msgs/Int32"),
    "subscribe": lambda node: node.subscribe("a", Int32),
    "subscribe_serialized": lambda node: node.subscribe_serialized("a", lambda *message: None),
    "wait_for_message": lambda node: node.wait_for_message("a", Int32),
    "service": lambda node: node.service("a", "std_srvs/Trigger", lambda request: (True, "")),
    "call": lambda node: node.call("a", "std_srvs/Trigger"),
    "call_with_header": lambda node: node.call_with_header("a", "std_srvs/Trigger", headers={}),
    "wait_for_service": lambda node: node.wait_for_service("a"),
    "action_server": lambda node: node.action_server(
        "a", "actionlib_tutorials/Fibonacci", lambda goal: {}
    ),
    "action_client": lambda node: node.action_client("a", "actionlib_tutorials/Fibonacci"),
    "rate": lambda node: anext(node.rate(10)),
    "flush": lambda node: node.flush(),
    "spin": lambda node: node.spin(),
    "params": lambda node: node.params.get("a"),
    "graph": lambda node: node.graph.nodes(),
}
"""What uses the hub, of all methods and properties."""
OFFLINE = {"close", "hub", "log", "name", "namespace", "now", "resolve", "serialized", "start"}


@pytest.mark.parametrize("use", USES)
async def test_methods_raise_before_the_node_is_entered(use: str) -> None:
    node = fibws.Node("talker", hub="127.0.0.1:1")
    with pytest.raises(RuntimeError, match="enter the node first"):
        found = USES[use](node)
        if isawaitable(found):
            await found


def test_all_methods_are_tried_before_the_node_is_entered() -> None:
    node = fibws.Node("talker", hub="127.0.0.1:1")
    assert {name for name in dir(node) if not name.startswith("_")} == USES.keys() | OFFLINE


# Services


async def test_end_cancels_pending_responses_and_waits_for_them(hub: ScriptedHub) -> None:
    asked, left = asyncio.Event(), asyncio.Event()

    async def never(request: object) -> tuple[bool, str]:
        asked.set()
        try:
            await asyncio.Event().wait()
        finally:
            await asyncio.sleep(0)
            left.set()
        return True, ""

    async with fibws.Node("node", hub=hub.url) as node:
        peer = await hub.peer()
        await node.service("never", "std_srvs/Trigger", never)
        await peer.expect("advertise_service")
        await peer.send("call_service", id="call", service="/never", args={})
        await asked.wait()
    assert left.is_set()


async def test_log_lines_name_the_node_while_a_process_has_several(
    hub: ScriptedHub, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("ROSCONSOLE_FORMAT", raising=False)
    talker, listener = (fibws.Node(name, hub=hub.url) for name in ("talker", "listener"))
    custom = fibws.Node("custom", hub=hub.url, log_format="custom: ${message}")
    talker.log.info("not yet")
    async with talker:
        talker.log.info("alone")
        listener.log.info("soon")
        async with listener, custom:
            for node in (talker, listener, custom):
                node.log.info("together")
        talker.log.warning("alone again")
    printed = capsys.readouterr()
    lines = re.sub(r"\d+\.\d{6}", "T", printed.out + printed.err).splitlines()
    assert lines == [
        "[INFO] [T]: not yet",
        "[INFO] [T]: alone",
        "[INFO] [T] [/listener]: soon",
        "[INFO] [T] [/talker]: together",
        "[INFO] [T] [/listener]: together",
        "custom: together",
        "[WARN] [T]: alone again",
    ]
