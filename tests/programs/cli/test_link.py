"""A tool's link to the hub."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from types import SimpleNamespace

import pytest
from websockets.exceptions import ConnectionClosed
from websockets.sync.server import ServerConnection, serve

from fibws.cli import link as module
from fibws.cli import stream
from fibws.cli.link import Link, Operation, check
from fibws.errors import (
    HubUnreachable,
    InvalidAddress,
    OperationRejected,
    ServiceError,
    ServiceTimeout,
    UnknownService,
)

from .conftest import HubThread, Publish


def test_a_link_is_a_node_while_it_is_open(hub: HubThread, link: Link) -> None:
    with Link("other", hub.url) as other:
        assert other.node in link.call("/rosapi/nodes")["nodes"]
    assert other.node not in link.call("/rosapi/nodes")["nodes"]


def test_the_hub_may_be_named_by_the_environment(
    hub: HubThread, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("FIBWS_HUB", hub.url)
    with Link("test") as link:
        assert link.url == hub.url


def test_names_are_relative_to_the_namespace(
    hub: HubThread, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("ROS_NAMESPACE", "/robot")
    with Link("test", hub.url) as link:
        assert link.resolve("arm") == "/robot/arm"
        assert link.resolve("/arm") == "/arm"
        assert link.resolve("~arm") == f"{link.node}/arm"
        assert link.resolve_namespace("arm/") == "/robot/arm"
        assert link.resolve_namespace("/") == "/"


def test_messages_come_in_order(link: Link, publish: Publish) -> None:
    publish("/number", "std_msgs/Int32", {"data": 1})
    link.subscribe("/number")
    for number in (2, 3):
        link.send({"op": "publish", "topic": "/number", "msg": {"data": number}})
    messages = link.messages("/number", 20)
    assert [next(messages)["data"] for _ in range(3)] == [1, 2, 3]


def test_what_comes_during_a_call_is_kept(link: Link, publish: Publish) -> None:
    publish("/number", "std_msgs/Int32", {"data": 1})
    link.subscribe("/number")
    assert "time" in link.call("/rosapi/get_time")
    assert next(link.messages("/number", 0)) == {"data": 1}


def test_silence_ends_the_wait(link: Link) -> None:
    assert link.receive(0) is None
    assert list(link.messages("/number", 0.01)) == []


def test_messages_can_be_heard_as_text(link: Link, publish: Publish) -> None:
    heard: list[bytes] = []
    link.hear("/number", heard.append)
    link.subscribe("/number")
    publish("/number", "std_msgs/Int32", {"data": 8})
    publish("/other", "std_msgs/Int32", {"data": 9})
    assert heard == [b'{"data":8}']


def test_a_service_that_fails_says_why(link: Link) -> None:
    with pytest.raises(UnknownService, match="/nobodys"):
        link.call("/nobodys")
    with pytest.raises(ServiceError, match="std_msgs/Strin"):
        link.call("/rosapi/message_details", {"type": "std_msgs/Strin"})


def test_a_service_that_does_not_answer_is_given_up(hub: HubThread, link: Link) -> None:
    with Link("silent", hub.url) as silent:
        silent.send({"op": "advertise_service", "service": "/s", "type": "std_srvs/Empty"})
        silent.call("/rosapi/get_time")
        with pytest.raises((ServiceError, ServiceTimeout)):
            link.call("/s", timeout=0.1)


def test_a_refusal_is_an_operation_until_it_is_checked(link: Link) -> None:
    link.send({"op": "advertise", "topic": "/x", "type": "std_msgs/Strin"})
    refusal = link.receive(20)
    assert refusal is not None
    with pytest.raises(OperationRejected, match="std_msgs/Strin"):
        check(refusal)
    check({"op": "publish"})


@pytest.mark.parametrize(("comes", "waits"), [(1, [1.0, 0.6]), (9, [1.0, 0.6, 0.1])])
def test_the_hub_is_heeded_for_so_long_whatever_it_says(
    comes: int, waits: list[float], link: Link, monkeypatch: pytest.MonkeyPatch
) -> None:
    waited: list[float | None] = []
    times, operations = iter([0.0, 0.4, 0.9, 1.2]), iter([{"op": "publish"}] * comes)

    def receive(timeout: float | None = None) -> Operation | None:
        waited.append(timeout)
        return next(operations, None)

    monkeypatch.setattr(link, "receive", receive)
    monkeypatch.setattr(module, "time", SimpleNamespace(monotonic=lambda: next(times)))
    link.heed(1.0)
    assert waited == [pytest.approx(each) for each in waits]


@pytest.mark.parametrize("seconds", [60, None])
def test_what_the_hub_refuses_meanwhile_raises(link: Link, seconds: float | None) -> None:
    link.send({"op": "advertise", "topic": "/x", "type": "std_msgs/Strin"})
    with pytest.raises(OperationRejected, match="std_msgs/Strin"):
        link.heed(seconds)


def test_what_is_no_address_is_refused() -> None:
    with pytest.raises(InvalidAddress):
        Link("test", "http://127.0.0.1:1")


@contextmanager
def stranger(*texts: str | bytes | list[str]) -> Iterator[str]:
    """The address of what speaks WebSocket, and answers whatever is said with these texts."""

    def answer(connection: ServerConnection) -> None:
        for _ in connection:
            for text in texts:
                connection.send(text, text=True)

    with serve(answer, "127.0.0.1", 0) as server:
        thread = threading.Thread(target=server.serve_forever)
        thread.start()
        yield f"ws://127.0.0.1:{server.socket.getsockname()[1]}"
        server.shutdown()
        thread.join(60)


def test_messages_are_heard_however_a_hub_writes_them() -> None:
    heard: list[bytes] = []
    texts = '{"op": "publish", "msg": {"data": 8}, "topic": "/x"}', '{"op": "end"}'
    with stranger(*texts) as url, Link("test", url) as link:
        link.hear("/x", heard.append)
        link.subscribe("/x")
        assert link.receive(60) == {"op": "end"}
    assert heard == [b'{"data": 8}']


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("{garbage", "it sends what is no JSON"),
        (b"\xff\xfe{", "it sends what is no JSON"),
        ("[" * 100_000, "it sends what is no JSON"),
        ("9" * 5_000, "it sends what is no JSON"),
        ("[1, 2]", r"it sends '\[1, 2\]', no JSON object"),
        ([""] * 5_000, "it sends a message in more than 4096 fragments"),
        ("x" * 2_000, "exceeds limit of 1000 bytes"),
        (["x"] * 2_000, "exceeds limit of 1000 bytes"),
    ],
)
def test_who_does_not_speak_as_a_hub_is_an_error(
    text: str | bytes | list[str], fault: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    if "exceeds" in fault:
        monkeypatch.setattr(stream, "MOST_BYTES", 1_000)
    with stranger(text) as url, Link("test", url) as link:
        with pytest.raises(HubUnreachable, match=f"what answers there is no hub .*{fault}"):
            link.call("/rosapi/get_time")


def test_a_response_that_lacks_a_field_says_so_when_that_is_asked_for() -> None:
    response = '{"op": "service_response", "id": "call:1", "values": {"one": 1}}'
    with stranger(response) as url, Link("test", url) as link:
        values = link.call("/s")
        assert (values["one"], values.get("two")) == (1, None)
        with pytest.raises(ServiceError, match="/s told no two: this may be another kind of hub"):
            values["two"]


def test_a_message_that_is_none_is_passed_over() -> None:
    bad = ('{"op": "publish", "topic": "/t"}', '{"op": "publish", "topic": "/t", "msg": 5}')
    with stranger(*bad, '{"op": "publish", "topic": "/t", "msg": {}}') as url:
        with Link("test", url) as link:
            link.subscribe("/t")
            assert next(link.messages("/t", 20)) == {}


def test_a_call_ends_though_something_else_comes_without_end() -> None:
    def chatter(connection: ServerConnection) -> None:
        connection.recv()
        with suppress(ConnectionClosed):
            while True:
                connection.send("{}")

    with serve(chatter, "127.0.0.1", 0) as server:
        thread = threading.Thread(target=server.serve_forever)
        thread.start()
        link = Link("test", f"ws://127.0.0.1:{server.socket.getsockname()[1]}")
        with pytest.raises(ServiceTimeout, match=r"no response within 0\.01 s"):
            link.call("/s", timeout=0.01)
        link._stream.leave()
        server.shutdown()
        thread.join(60)


def test_what_comes_during_a_call_is_kept_within_bounds(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "MOST_KEPT", 2)
    others = [f'{{"op": "publish", "id": "{number}"}}' for number in range(5)]
    response = '{"op": "service_response", "id": "call:1", "values": {}}'
    with stranger(*others, response) as url, Link("test", url) as link:
        link.call("/s")
        assert [(link.receive(20) or {}).get("id") for _ in range(2)] == ["3", "4"]
