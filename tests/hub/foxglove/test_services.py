"""Calls of services."""

from __future__ import annotations

import struct
from typing import Any

import pytest

from ..fakes import ADD, Client
from .foxglove_client import FoxgloveClient, FoxgloveHub

REQUEST = struct.pack("<qq", 2, 3)
SUM = struct.pack("<q", 5)


def serving(**settings: Any) -> tuple[FoxgloveHub, Client, FoxgloveClient, int]:
    """Return a hub, a client that serves /add, one of Foxglove's, and the service's id."""
    hub = FoxgloveHub(**settings)
    server = hub.client("/server")
    server.send("advertise_service", service="/add", type=ADD)
    client = hub.foxglove_client()
    client.receive()
    return hub, server, client, client.services["/add"]["id"]


def answer(server: Client, *, result: bool = True, **values: object) -> None:
    """Let the server respond to the call that has come."""
    call = server.receive_one("call_service")
    assert call["args"] == {"a": 2, "b": 3}
    server.send(
        "service_response", service="/add", id=call["id"], result=result, values=values or "no"
    )


def test_response_comes_in_the_encoding_of_the_request() -> None:
    _, server, client, service = serving()
    client.call(service, REQUEST, call=7)
    answer(server, sum=5)
    assert client.receive_response() == (service, 7, "ros1", SUM)
    client.call(service, b'{"a":2,"b":3}', call=8, encoding="json")
    answer(server, sum=5)
    assert client.receive_response() == (service, 8, "json", b'{"sum":5}')


def test_empty_json_stands_for_an_empty_request() -> None:
    _, server, client, service = serving()
    client.call(service, b"", encoding="json")
    assert server.receive_one("call_service")["args"] == {"a": 0, "b": 0}


def test_calls_may_be_answered_in_any_order() -> None:
    _, server, client, service = serving()
    client.call(service, REQUEST, call=1)
    client.call(service, REQUEST, call=2)
    first, second = server.receive()
    for call in (second, first):
        values = {"sum": 1}
        server.send("service_response", service="/add", id=call["id"], result=True, values=values)
    received = client.receive()
    assert [each[5] for each in received if isinstance(each, bytes)] == [2, 1]


@pytest.mark.parametrize(
    ("request_", "encoding", "fault"),
    [
        (b"\1", "ros1", "bytes"),
        (REQUEST + b"\1", "ros1", "too many"),
        (b"{", "json", "invalid JSON"),
        (b'{"a":"x"}', "json", "a"),
        (REQUEST, "cdr", "ros1 or json"),
    ],
)
def test_invalid_request_fails_at_once(request_: bytes, encoding: str, fault: str) -> None:
    hub, server, client, service = serving()
    client.call(service, request_, call=3, encoding=encoding)
    failure = client.receive_one("serviceCallFailure")
    assert (failure["serviceId"], failure["callId"]) == (service, 3)
    assert fault in failure["message"]
    assert server.receive() == []
    assert hub.clock.timers == 0


def test_unknown_service_fails() -> None:
    _, server, client, service = serving()
    client.call(99, REQUEST)
    assert client.receive_one("serviceCallFailure")["message"] == "Unknown service ID: 99"
    server.disconnect()
    client.call(service, REQUEST)
    failure = client.receive_one("serviceCallFailure")
    assert failure["message"] == "Service /add does not exist"
    client.call(service, REQUEST)
    failure = client.receive_one("serviceCallFailure")
    assert failure["message"] == f"Unknown service ID: {service}"


def test_service_with_another_type_by_now_fails() -> None:
    hub, _, client, service = serving()
    hub.client("/other").send("advertise_service", service="/add", type="std_srvs/Empty")
    client.call(service, REQUEST)
    assert "another type" in client.receive_one("serviceCallFailure")["message"]


def test_error_of_the_server_is_passed_on() -> None:
    _, server, client, service = serving()
    client.call(service, REQUEST)
    answer(server, result=False)
    assert client.receive_one("serviceCallFailure")["message"] == "no"
    client.call(service, REQUEST)
    answer(server, sum="x")
    assert "sum" in client.receive_one("serviceCallFailure")["message"]


def test_call_times_out() -> None:
    hub, server, client, service = serving(service_timeout=2.0)
    client.call(service, REQUEST)
    hub.clock.advance(1)
    assert client.receive() == []
    hub.clock.advance(2)
    assert "2 s" in client.receive_one("serviceCallFailure")["message"]
    answer(server, sum=5)
    assert client.receive() == []
    assert hub.clock.timers == 0


def test_call_fails_when_its_server_leaves() -> None:
    hub, server, client, service = serving()
    client.call(service, REQUEST)
    server.disconnect()
    assert "/server has left" in client.receive_one("serviceCallFailure")["message"]
    assert hub.clock.timers == 0


def test_too_many_calls_are_refused() -> None:
    _, server, client, service = serving(max_calls=2)
    for call in range(3):
        client.call(service, REQUEST, call=call)
    failure = client.receive_one("serviceCallFailure")
    assert failure["callId"] == 2
    assert "limit 2" in failure["message"]
    assert len(server.receive()) == 2


def test_calls_of_a_client_that_has_left_are_abandoned() -> None:
    hub, server, client, service = serving()
    client.call(service, REQUEST)
    client.disconnect()
    answer(server, sum=5)
    assert client.receive() == []
    server.disconnect()
    assert hub.empty


def test_internal_service_is_called() -> None:
    hub = FoxgloveHub()
    hub.graph.serve_internally("/double", ADD, "/hub", lambda request, caller: b'{"sum": 9}')
    client = hub.foxglove_client()
    client.receive()
    client.call(client.services["/double"]["id"], REQUEST)
    assert client.receive_response()[3] == struct.pack("<q", 9)


def test_response_that_cannot_be_serialized_is_a_failure(caplog: pytest.LogCaptureFixture) -> None:
    hub = FoxgloveHub()
    hub.graph.serve_internally("/wrong", ADD, "/hub", lambda request, caller: b'{"sum": "x"}')
    client = hub.foxglove_client()
    client.receive()
    client.call(client.services["/wrong"]["id"], REQUEST)
    assert "log" in client.receive_one("serviceCallFailure")["message"]
    assert "/wrong" in caplog.text
    caplog.clear()
