"""A tool's connection to the hub."""

from __future__ import annotations

import json
import socket
import threading
from contextlib import suppress
from types import SimpleNamespace
from typing import Any

import pytest
from hub_in_thread import HubThread, Publish
from websockets.exceptions import ConnectionClosed
from websockets.sync.server import ServerConnection

from client.servers import replying_server, websocket_server
from fibws.client import hub_client as module
from fibws.client import websocket
from fibws.client.hub_client import HubClient, Operation, RawMessage, check, is_hub_running
from fibws.errors import (
    HubUnreachable,
    InvalidAddress,
    MessageTooLarge,
    OperationRejected,
    ServiceError,
    ServiceTimeout,
    UnknownService,
)
from fibws.hub import Settings
from fibws.protocol.serialized import SUBPROTOCOL, deliver_head
from fibws.protocol.websocket import TEXT, server_frame


@pytest.mark.parametrize(
    "operation",
    [
        {"op": "publish", "topic": "/large", "msg": {"data": "x" * 20_000}},
        {"op": "call_service", "service": "/large", "args": {"data": "x" * 20_000}},
    ],
)
def test_what_the_hub_does_not_take_is_an_error(operation: dict[str, Any]) -> None:
    with HubThread(Settings(port=0, max_message_size=20_000)) as hub:
        with HubClient("tool", hub.url) as client:
            with pytest.raises(MessageTooLarge, match=r"/large: .* \(limit 20000, "):
                client.send(operation)
            assert "time" in client.call("/rosapi/get_time")


def test_client_is_a_node_while_it_is_open(hub: HubThread, client: HubClient) -> None:
    with HubClient("other", hub.url) as other:
        assert other.node in client.call("/rosapi/nodes")["nodes"]
    assert other.node not in client.call("/rosapi/nodes")["nodes"]


def test_hub_address_is_read_from_the_environment(
    hub: HubThread, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("FIBWS_HUB", hub.url)
    with HubClient("test") as client:
        assert client.url == hub.url


def test_names_are_relative_to_the_namespace(
    hub: HubThread, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("ROS_NAMESPACE", "/robot")
    with HubClient("test", hub.url) as client:
        assert client.resolve("arm") == "/robot/arm"
        assert client.resolve("/arm") == "/arm"
        assert client.resolve("~arm") == f"{client.node}/arm"
        assert client.resolve_namespace("arm/") == "/robot/arm"
        assert client.resolve_namespace("/") == "/"


def test_messages_are_received_in_order(client: HubClient, publish: Publish) -> None:
    publish("/number", "std_msgs/Int32", {"data": 1})
    client.subscribe("/number")
    for number in (2, 3):
        client.send({"op": "publish", "topic": "/number", "msg": {"data": number}})
    messages = client.messages("/number", 20)
    assert [next(messages)["data"] for _ in range(3)] == [1, 2, 3]


def test_messages_received_during_a_call_are_kept(client: HubClient, publish: Publish) -> None:
    publish("/number", "std_msgs/Int32", {"data": 1})
    client.subscribe("/number")
    assert "time" in client.call("/rosapi/get_time")
    assert next(client.messages("/number", 0)) == {"data": 1}


def test_operations_received_during_a_call_stay_in_order() -> None:
    def handle(connection: ServerConnection) -> None:
        call = json.loads(connection.recv())
        response = {"op": "service_response", "id": call["id"], "values": {}, "result": True}
        operations = ({"op": "1"}, {"op": "2"}, response, {"op": "3"})
        # At once, so that the last one is there when the call ends.
        frames = [server_frame(TEXT, json.dumps(operation).encode()) for operation in operations]
        connection.socket.sendall(b"".join(frames))
        connection.recv()

    with websocket_server(handle) as url, HubClient("test", url) as client:
        client.call("/x")
        received = [client.receive(20) for _ in range(3)]
        client.send({"op": "end"})
    assert received == [{"op": "1"}, {"op": "2"}, {"op": "3"}]


def test_waiting_ends_after_the_timeout(client: HubClient) -> None:
    assert client.receive(0) is None
    assert list(client.messages("/number", 0.01)) == []


def test_raw_messages_are_serialized(client: HubClient, publish: Publish) -> None:
    received: list[RawMessage] = []
    client.subscribe_raw("/number", received.append)
    publish("/number", "std_msgs/Int32", {"data": 8})
    publish("/other", "std_msgs/Int32", {"data": 9})
    assert received == [RawMessage(b"\x08\0\0\0", "std_msgs/Int32")]
    assert client.receive(0) is None


def test_raw_messages_of_several_topics_are_distinguished(
    client: HubClient, publish: Publish
) -> None:
    received: dict[str, list[RawMessage]] = {"/a": [], "/b": []}
    for topic, messages in received.items():
        client.subscribe_raw(topic, messages.append)
    publish("/b", "std_msgs/UInt8", {"data": 2})
    publish("/a", "std_msgs/Char", {"data": 1})
    assert received["/a"] == [RawMessage(b"\1", "std_msgs/Char")]
    assert received["/b"] == [RawMessage(b"\2", "std_msgs/UInt8")]


def test_raw_messages_have_the_type_that_the_topic_has_at_the_time(
    hub: HubThread, client: HubClient
) -> None:
    received: list[RawMessage] = []
    client.subscribe_raw("/changing", received.append)
    for type_, data in (("std_msgs/UInt8", 8), ("std_msgs/String", "x")):
        with HubClient("publisher", hub.url) as publisher:
            publisher.send({"op": "advertise", "topic": "/changing", "type": type_})
            publisher.send({"op": "publish", "topic": "/changing", "msg": {"data": data}})
        client.call("/rosapi/get_time")
    assert received == [
        RawMessage(b"\x08", "std_msgs/UInt8"),
        RawMessage(b"\1\0\0\0x", "std_msgs/String"),
    ]


@pytest.mark.parametrize("is_published", [True, False])
def test_raw_messages_of_an_undefined_type_are_json(
    is_published: bool, client: HubClient, publish: Publish
) -> None:
    received: list[RawMessage] = []
    if is_published:
        publish("/undefined", "nobodys_msgs/Thing", {"data": 8})
    client.subscribe_raw("/undefined", received.append)
    if not is_published:
        publish("/undefined", "nobodys_msgs/Thing", {"data": 8})
    for _ in range(2):  # The refusal comes before the first response, the message before the next.
        client.call("/rosapi/get_time")
    assert received == [RawMessage(b'{"data":8}', None)]
    assert client.receive(0) is None


def test_refused_subscription_to_raw_messages_is_an_error(client: HubClient) -> None:
    client.subscribe_raw("not a name", lambda message: None)
    with pytest.raises(OperationRejected, match="not a name"):
        client.process(60)


def test_unsubscribed_topic_is_not_received(client: HubClient, publish: Publish) -> None:
    received: list[RawMessage] = []
    client.subscribe_raw("/number", received.append)
    publish("/number", "std_msgs/UInt8", {"data": 1})
    client.unsubscribe("/number")
    publish("/number", "std_msgs/UInt8", {"data": 2})
    assert received == [RawMessage(b"\1", "std_msgs/UInt8")]


def test_failed_call_raises_the_error(client: HubClient) -> None:
    with pytest.raises(UnknownService, match="/nobodys"):
        client.call("/nobodys")
    with pytest.raises(ServiceError, match="std_msgs/Strin"):
        client.call("/rosapi/message_details", {"type": "std_msgs/Strin"})


def test_call_without_a_response_times_out(hub: HubThread, client: HubClient) -> None:
    with HubClient("silent", hub.url) as silent:
        silent.send({"op": "advertise_service", "service": "/s", "type": "std_srvs/Empty"})
        silent.call("/rosapi/get_time")
        with pytest.raises(ServiceTimeout, match=r"/s did not answer within 0\.1 s"):
            client.call("/s", timeout=0.1)


@pytest.mark.parametrize(
    ("code", "error"),
    [
        ("unknown_service", UnknownService),
        ("timeout", ServiceTimeout),
        ("server_lost", ServiceError),
        (None, ServiceError),
        ([], ServiceError),
    ],
)
def test_error_of_a_failed_call_depends_on_the_code(code: object, error: type[Exception]) -> None:
    response = {"op": "service_response", "id": "call:1", "result": False, "code": code}
    response["values"] = "Service /s does not exist"
    with replying_server(json.dumps(response)) as url, HubClient("test", url) as client:
        with pytest.raises(ServiceError, match="Service /s does not exist") as raised:
            client.call("/s")
    assert raised.type is error


def test_text_of_a_server_is_not_taken_for_an_error_of_the_hub(
    hub: HubThread, client: HubClient
) -> None:
    call = {"op": "call_service", "id": "c", "service": "/s"}
    with HubClient("server", hub.url) as server, HubClient("caller", hub.url) as caller:
        server.send({"op": "advertise_service", "service": "/s", "type": "std_srvs/Empty"})
        server.call("/rosapi/get_time")
        caller.send(call)
        asked = server.receive(20)
        assert asked is not None
        text = "Service /s does not exist"
        reply = {"op": "service_response", "service": "/s", "id": asked["id"]}
        server.send({**reply, "result": False, "values": text, "code": "unknown_service"})
        response = caller.receive(20)
    assert response is not None
    assert (response["values"], response["code"]) == (text, "server_failed")


def test_refusal_is_an_operation_until_it_is_checked(client: HubClient) -> None:
    client.send({"op": "advertise", "topic": "/x", "type": "std_msgs/Strin"})
    refusal = client.receive(20)
    assert refusal is not None
    with pytest.raises(OperationRejected, match="std_msgs/Strin"):
        check(refusal)
    check({"op": "publish"})


@pytest.mark.parametrize(("number", "waits"), [(1, [1.0, 0.6]), (9, [1.0, 0.6, 0.1])])
def test_process_ends_in_time_however_many_operations_are_received(
    number: int, waits: list[float], client: HubClient, monkeypatch: pytest.MonkeyPatch
) -> None:
    waited: list[float | None] = []
    times, operations = iter([0.0, 0.4, 0.9, 1.2]), iter([{"op": "publish"}] * number)

    def receive(timeout: float | None = None) -> Operation | None:
        waited.append(timeout)
        return next(operations, None)

    monkeypatch.setattr(client, "receive", receive)
    monkeypatch.setattr(module, "time", SimpleNamespace(monotonic=lambda: next(times)))
    client.process(1.0)
    assert waited == [pytest.approx(each) for each in waits]


@pytest.mark.parametrize("seconds", [60, None])
def test_refusal_during_process_is_an_error(client: HubClient, seconds: float | None) -> None:
    client.send({"op": "advertise", "topic": "/x", "type": "std_msgs/Strin"})
    with pytest.raises(OperationRejected, match="std_msgs/Strin"):
        client.process(seconds)


def test_invalid_address_is_an_error() -> None:
    with pytest.raises(InvalidAddress):
        HubClient("test", "http://127.0.0.1:1")


def test_raw_messages_of_a_plain_rosbridge_server_are_json() -> None:
    received: list[RawMessage] = []
    requests: list[dict[str, Any]] = []

    def reply(connection: ServerConnection) -> None:
        requests.append(json.loads(connection.recv()))
        connection.send('{"op": "publish", "msg": {"data": 8}, "topic": "/x"}')
        connection.send('{"op":"publish","topic":"/x","msg":{"data":9}}')
        connection.send('{"op": "end"}')

    with websocket_server(reply) as url, HubClient("test", url) as client:
        client.subscribe_raw("/x", received.append)
        assert client.receive(60) == {"op": "end"}
    assert received == [RawMessage(b'{"data": 8}', None), RawMessage(b'{"data":9}', None)]
    assert [request.get("compression") for request in requests] == [None]


def test_refusal_of_a_plain_rosbridge_server_is_an_error() -> None:
    refusal = '{"op": "status", "level": "error", "id": "raw:1", "msg": "no"}'
    with replying_server(refusal) as url, HubClient("test", url) as client:
        client.subscribe_raw("/x", lambda message: None)
        with pytest.raises(OperationRejected, match="no"):
            client.process(60)


@pytest.mark.parametrize(
    ("frame", "fault"),
    [
        (b"", "kind must be 1, 2 or 3, got None"),
        (b"\x04", "kind must be 1, 2 or 3, got 4"),
        (b"\x01\0", "2 bytes are too few"),
    ],
)
def test_invalid_binary_frame_is_an_error(frame: bytes, fault: str) -> None:
    with replying_server(frame, subprotocol=SUBPROTOCOL) as url, HubClient("test", url) as client:
        with pytest.raises(HubUnreachable, match=f"the server is not a hub .*{fault}"):
            client.call("/rosapi/get_time")


def test_serialized_message_of_an_unknown_topic_is_ignored() -> None:
    frames = deliver_head(5, 0) + b"message", '{"op": "end"}'
    with replying_server(*frames, subprotocol=SUBPROTOCOL) as url, HubClient("test", url) as client:
        client.subscribe_raw("/x", lambda message: pytest.fail("received"))
        assert client.receive(60) == {"op": "end"}


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("{garbage", "it sent invalid JSON"),
        (b"\xff\xfe{", "it sent invalid JSON"),
        ("[" * 100_000, "it sent invalid JSON"),
        ("9" * 5_000, "it sent invalid JSON"),
        ("[1, 2]", r"it sent '\[1, 2\]', expected a JSON object"),
        ([""] * 5_000, "it sent a message of more than 4096 fragments"),
        ("x" * 2_000, "exceeds limit of 1000 bytes"),
        (["x"] * 2_000, "exceeds limit of 1000 bytes"),
    ],
)
def test_protocol_violation_is_an_error(
    text: str | bytes | list[str], fault: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    if "exceeds" in fault:
        monkeypatch.setattr(websocket, "MOST_BYTES", 1_000)
    with replying_server(text) as url, HubClient("test", url) as client:
        with pytest.raises(HubUnreachable, match=f"the server is not a hub .*{fault}"):
            client.call("/rosapi/get_time")


def test_reading_a_missing_field_of_a_response_is_an_error() -> None:
    response = '{"op": "service_response", "id": "call:1", "values": {"one": 1}}'
    with replying_server(response) as url, HubClient("test", url) as client:
        values = client.call("/s")
        assert (values["one"], values.get("two")) == (1, None)
        with pytest.raises(
            ServiceError, match="/s returned no two: this may be another kind of hub"
        ):
            values["two"]


def test_malformed_message_is_ignored() -> None:
    bad = ('{"op": "publish", "topic": "/t"}', '{"op": "publish", "topic": "/t", "msg": 5}')
    with replying_server(*bad, '{"op": "publish", "topic": "/t", "msg": {}}') as url:
        with HubClient("test", url) as client:
            client.subscribe("/t")
            assert next(client.messages("/t", 20)) == {}


def test_call_times_out_while_other_operations_are_received() -> None:
    def send(connection: ServerConnection) -> None:
        connection.recv()
        with suppress(ConnectionClosed):
            while True:
                connection.send("{}")

    with websocket_server(send) as url:
        client = HubClient("test", url)
        with pytest.raises(ServiceTimeout, match=r"no response within 0\.01 s"):
            client.call("/s", timeout=0.01)
        client._socket.abort()


def test_oldest_operations_received_during_a_call_are_dropped_at_the_limit(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(module, "MOST_KEPT", 2)
    others = [f'{{"op": "publish", "id": "{number}"}}' for number in range(5)]
    response = '{"op": "service_response", "id": "call:1", "values": {}}'
    with replying_server(*others, response) as url, HubClient("test", url) as client:
        client.call("/s")
        assert [(client.receive(20) or {}).get("id") for _ in range(2)] == ["3", "4"]


def test_running_hub_is_found(hub: HubThread) -> None:
    assert is_hub_running(hub.url)
    hub.stop()
    assert not is_hub_running(hub.url)


def test_other_servers_are_not_taken_for_a_hub() -> None:
    with socket.create_server(("127.0.0.1", 0)) as server:

        def refuse() -> None:
            connection, _ = server.accept()
            connection.close()

        thread = threading.Thread(target=refuse)
        thread.start()
        with pytest.raises(HubUnreachable):
            is_hub_running(f"ws://127.0.0.1:{server.getsockname()[1]}")
        thread.join(60)
