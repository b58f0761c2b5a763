"""Providing services."""

from __future__ import annotations

from itertools import product
from typing import Any

import pytest

from fibws.hub.graph.service import InternalServer

from ..fakes import ADD, FakeHub
from .service_clients import (
    adder,
    adder_and_caller,
    call_add,
    received_call,
    received_calls,
    received_failure,
    received_sums,
    respond,
)

DEFINITION = "int8 one\n---\nint8 two\n"


def test_served_service_is_in_the_graph() -> None:
    hub = FakeHub()
    service_server = adder(hub, "/adder", "~add")
    service = hub.graph.services["/adder/add"]
    assert (service.name, service.type.name, service.node) == ("/adder/add", ADD, "/adder")
    assert list(service_server.session.providing()) == ["/adder/add"]


@pytest.mark.parametrize("type_", [ADD, "rospy_tutorials/srv/AddTwoInts"])
def test_type_may_be_spelled_as_in_ros_1_or_2(type_: str) -> None:
    hub = FakeHub()
    hub.client().send("advertise_service", service="/add", type=type_)
    assert hub.graph.services["/add"].type.name == ADD


def test_advertise_service_is_acknowledged_at_level_info() -> None:
    client = FakeHub().client("/adder")
    client.send("set_level", level="info")
    client.send("advertise_service", service="add", type=ADD, id=5)
    assert client.receive() == [
        {"op": "status", "id": 5, "level": "info", "msg": f"/adder provides /add ({ADD})"}
    ]


@pytest.mark.parametrize(
    ("fields", "fault"),
    [
        ({"type": "AddTwoInts"}, "AddTwoInts is not a valid type string"),
        ({"type": ""}, " is not a valid type string"),
        (
            {"type": "rospy_tutorials/AddTwoInt"},
            "Unable to import srv class AddTwoInt from package rospy_tutorials. "
            "Caused by: no such srv in rospy_tutorials; did you mean rospy_tutorials/AddTwoInts?",
        ),
        (
            {"type": "std_msgs/Int32"},
            "Unable to import srv class Int32 from package std_msgs. "
            "Caused by: no such srv in std_msgs",
        ),
        ({"type": None}, "Expected a type field but none was found."),
        ({"service": None}, "Expected a service field but none was found."),
        ({"service": "a b"}, "'a b' is not a legal name"),
        ({"service": "/add#77"}, "'/add#77' is not a legal name: in calls, an id follows the #"),
        ({"definition": "int33 x\n---\n", "type": "my_srvs/Do"}, "int33"),
    ],
)
def test_invalid_service_is_refused_and_leaves_nothing(fields: dict[str, Any], fault: str) -> None:
    hub = FakeHub()
    client = hub.client()
    client.send("advertise_service", **{"service": "/add", "type": ADD, **fields})
    [status] = client.receive_statuses()
    assert status.startswith("advertise_service: ")
    assert fault in status
    assert hub.graph.services == {}
    assert client.forgotten


def test_refused_service_does_not_change_the_server() -> None:
    hub, service_server, caller = adder_and_caller()
    other = hub.client()
    other.send("advertise_service", service="/add", type="std_srvs/Nothing")
    assert len(other.receive_statuses()) == 1
    call_add(caller)
    respond(service_server, received_call(service_server))
    assert received_sums(caller) == [3]


def test_service_of_an_unknown_package_gives_a_warning() -> None:
    client = FakeHub().client()
    client.send("set_level", level="warning")
    client.send("advertise_service", service="/do", type="my_srvs/Do", id=1)
    [status] = client.receive()
    assert (status["id"], status["level"]) == (1, "warning")
    assert status["msg"] == "/do: calls of type my_srvs/Do are not checked"


def test_strict_types_refuse_an_unknown_package() -> None:
    hub = FakeHub(strict_types=True)
    client = hub.client()
    client.send("advertise_service", service="/do", type="my_srvs/Do")
    assert client.receive_statuses() == [
        "advertise_service: Unable to load the manifest for package my_srvs. "
        "Caused by: no folder of definitions contains it (FIBWS_INTERFACES names them)"
    ]
    assert hub.graph.services == {}


def test_service_server_may_bring_the_definition() -> None:
    hub = FakeHub(strict_types=True)
    service_server, caller = hub.client(), hub.client()
    service_server.send(
        "advertise_service", service="/do", type="my_srvs/Do", definition=DEFINITION
    )
    caller.send("call_service", service="/do", args=[5])
    asked = service_server.receive_one("call_service")
    assert asked["args"] == {"one": 5}
    service_server.send("service_response", service="/do", id=asked["id"], result=True)
    assert caller.receive_one("service_response")["values"] == {"two": 0}
    caller.send("call_service", service="/do", args=[500])
    assert "500 is not in -128..127" in received_failure(caller)


# Headers.


def test_server_that_asks_for_headers_gets_the_callers_header() -> None:
    hub = FakeHub()
    service_server, caller = hub.client(), hub.client("/caller")
    service_server.send("advertise_service", service="add", type=ADD, headers=True)
    call_add(caller, headers={"user": "ann"})
    call_add(caller)
    headers = [each["header"] for each in service_server.receive()]
    assert headers == [{"callerid": "/caller", "user": "ann"}, {"callerid": "/caller"}]


def test_server_that_does_not_ask_gets_no_header() -> None:
    _, service_server, caller = adder_and_caller()
    call_add(caller, headers={"user": "ann"}, header={"user": "bob"})
    asked = service_server.receive_one("call_service")
    assert asked.keys() == {"op", "id", "service", "args"}


def test_caller_that_sends_headers_gets_the_servers_header() -> None:
    _, service_server, caller = adder_and_caller()
    for headers in ({"user": "ann"}, {}, None):
        call_add(caller, headers=headers)
        respond(service_server, received_call(service_server))
        response = caller.receive_one("service_response")
        assert response.get("header") == (None if headers is None else {"callerid": "/adder"})


def test_newest_advertisement_decides_on_headers() -> None:
    _, service_server, caller = adder_and_caller()
    for headers in (True, False):
        service_server.send("advertise_service", service="/add", type=ADD, headers=headers)
        call_add(caller)
        assert ("header" in service_server.receive_one("call_service")) == headers


def test_call_with_invalid_headers_is_refused() -> None:
    _, service_server, caller = adder_and_caller()
    call_add(caller, headers={"age": 5}, id=1)
    status, response = caller.receive()
    assert status["msg"].startswith("call_service: Expected field headers to be one of an object")
    assert (response["id"], response["result"]) == (1, False)
    assert service_server.receive() == []


# Several providers of one name.


def test_newer_server_takes_the_service_over() -> None:
    hub, older, caller = adder_and_caller()
    newer = adder(hub, "/newer")
    assert len(older.receive_statuses("warning")) == 1
    assert hub.graph.services["/add"].node == "/newer"
    call_add(caller)
    assert older.receive() == []
    respond(newer, received_call(newer))
    assert received_sums(caller) == [3]


@pytest.mark.parametrize("level", [None, "error", "warning", "none"])
def test_older_server_and_the_log_are_warned(
    level: str | None, caplog: pytest.LogCaptureFixture
) -> None:
    hub, older, _ = adder_and_caller()
    if level is not None:
        older.send("set_level", level=level)
    adder(hub, "/newer")
    text = "/add has another server now: /newer"
    assert older.receive_statuses("warning") == ([text] if level != "none" else [])
    assert list(older.session.providing()) == []
    [record] = caplog.records
    assert record.levelname == "WARNING"
    assert record.getMessage().startswith(f"/adder: {text}")


def test_two_servers_that_displace_each_other_do_not_fill_the_log(
    caplog: pytest.LogCaptureFixture,
) -> None:
    hub = FakeHub()
    servers = hub.client("/a"), hub.client("/b")
    for each in 100 * servers:
        each.send("advertise_service", service="/add", type=ADD)
    assert len(caplog.records) == 3 + 2
    assert [len(each.receive_statuses("warning")) for each in servers] == [100, 99]


@pytest.mark.parametrize("fate", ["answers", "is late", "leaves"])
def test_older_server_still_answers_the_calls_it_has(fate: str) -> None:
    hub, older, caller = adder_and_caller()
    call_add(caller)
    asked = received_call(older)
    newer = adder(hub, "/newer")
    assert caller.receive() == newer.receive() == []
    if fate == "answers":
        respond(older, asked)
        assert received_sums(caller) == [3]
    elif fate == "leaves":
        older.disconnect()
        assert received_failure(caller) == "service [/add] unavailable: /adder has left"
    else:
        hub.clock.advance(60)
        assert "did not answer within 60 s" in received_failure(caller)
    assert hub.graph.services["/add"].node == "/newer"


@pytest.mark.parametrize("end", ["unadvertise", "leave"])
def test_older_service_server_cannot_remove_the_newer(end: str) -> None:
    hub, older, caller = adder_and_caller()
    newer = adder(hub, "/newer")
    if end == "leave":
        older.disconnect()
    else:
        older.send("unadvertise_service", service="/add")
    call_add(caller)
    respond(newer, received_call(newer))
    assert received_sums(caller) == [3]


def test_newer_server_may_change_the_services_type() -> None:
    hub, _, caller = adder_and_caller()
    other = hub.client()
    other.send("advertise_service", service="/add", type="std_srvs/SetBool")
    caller.send("call_service", service="/add", args={"data": True})
    assert other.receive_one("call_service")["args"] == {"data": True}


def test_service_may_be_advertised_again_under_another_spelling() -> None:
    hub, service_server, caller = adder_and_caller()
    call_add(caller, id="before")
    before = received_call(service_server)
    service_server.send("advertise_service", service="add", type=ADD)
    call_add(caller, id="after")
    asked = service_server.receive_one("call_service")
    assert asked["service"] == "add"
    respond(service_server, before)
    respond(service_server, asked["id"])
    assert [each["id"] for each in caller.receive()] == ["before", "after"]
    call_add(caller)
    service_server.send("unadvertise_service", service="/add")
    assert received_failure(caller) == "Service /add was unadvertised"
    assert hub.graph.services == {}


def test_calls_are_answered_by_their_server_even_after_it_is_replaced() -> None:
    for later in product(("a serves", "a ends", "b serves", "b ends"), repeat=3):
        events = ("a serves", *later)
        hub = FakeHub()
        caller, servers = hub.client("/caller"), {name: hub.client(f"/{name}") for name in "ab"}
        calls: dict[str, dict[str, int]] = {"a": {}, "b": {}}
        """The calls that each server has: their ids there, and at the caller."""
        current = None
        for number, event in enumerate(events):
            name, _, verb = event.partition(" ")
            if verb == "serves":
                servers[name].send("advertise_service", service="/add", type=ADD)
                current = name
            else:
                servers[name].send("unadvertise_service", service="/add")
                if name == current:
                    failed = {each["id"] for each in caller.receive() if not each["result"]}
                    assert failed == set(calls[name].values())
                    calls[name].clear()
                    current = None
            if current is not None:
                call_add(caller, id=number)
                [asked] = [each for each in servers[current].receive() if "args" in each]
                calls[current][asked["id"]] = number
        for name, each in servers.items():
            for id_, number in calls[name].items():
                respond(each, id_, number)
                response = caller.receive_one("service_response")
                assert (response["id"], response["values"]) == (number, {"sum": number}), events
        assert caller.forgotten


def test_services_of_the_hub_cannot_be_taken_over() -> None:
    hub = FakeHub()
    hub.graph.serve_internally("/rosapi/x", "std_srvs/Empty", "/rosapi", lambda request, caller: {})
    client = hub.client()
    client.send("advertise_service", service="/rosapi/x", type="std_srvs/Empty")
    assert client.receive_statuses() == [
        "advertise_service: Service /rosapi/x is the hub's own (/rosapi)"
    ]
    assert client.forgotten
    assert isinstance(hub.graph.services["/rosapi/x"].server, InternalServer)
    client.send("call_service", service="/rosapi/x")
    assert client.receive_one("service_response")["values"] == {}


# The end.


@pytest.mark.parametrize("spelling", ["/add", "add"])
def test_calls_fail_when_the_service_is_unadvertised(spelling: str) -> None:
    hub, service_server, caller = adder_and_caller()
    service_server.send("advertise_service", service="/other", type=ADD)
    call_add(caller, service="/other", id="other")
    call_add(caller, id="x")
    _, asked = received_calls(service_server)
    service_server.send("unadvertise_service", service=spelling)
    response = caller.receive_one("service_response")
    assert (response["id"], response["result"]) == ("x", False)
    assert response["values"] == "Service /add was unadvertised"
    call_add(caller)
    assert received_failure(caller) == "Service /add does not exist"
    respond(service_server, asked)
    assert (caller.receive(), service_server.receive()) == ([], [])
    assert list(hub.graph.services) == ["/other"]


@pytest.mark.parametrize("service", [None, "/nope", "nope"])
def test_unadvertising_an_unknown_service_is_harmless(service: str | None) -> None:
    hub, service_server, caller = adder_and_caller()
    service_server.send("unadvertise_service", service=service)
    caller.send("unadvertise_service", service="/add")
    assert service_server.receive() == caller.receive() == []
    assert list(hub.graph.services) == ["/add"]


def test_calls_fail_when_the_server_leaves() -> None:
    hub, service_server, caller = adder_and_caller()
    for id_ in "ab":
        call_add(caller, id=id_)
    service_server.disconnect()
    assert [(each["id"], each["values"]) for each in caller.receive()] == [
        (id_, "service [/add] unavailable: /adder has left") for id_ in "ab"
    ]
    assert hub.graph.services == {}
    assert caller.forgotten


def test_calls_fail_when_the_server_is_replaced() -> None:
    hub, service_server, caller = adder_and_caller()
    call_add(caller)
    newer = adder(hub, "/adder")
    assert len(service_server.closings) == 1
    assert received_failure(caller) == "service [/add] unavailable: /adder has left"
    call_add(caller)
    respond(newer, received_call(newer))
    assert received_sums(caller) == [3]


def test_calls_of_a_client_that_leaves_are_forgotten() -> None:
    hub, service_server, caller = adder_and_caller()
    call_add(caller)
    asked = received_call(service_server)
    caller.disconnect()
    assert hub.clock.timers == 0
    assert not service_server.kept["calls to answer"]
    respond(service_server, asked)
    assert service_server.receive() == caller.receive() == []


# How much one client may have.


def test_number_of_services_of_a_client_is_limited() -> None:
    hub = FakeHub(max_advertisements=2)
    client = hub.client()
    for service in ("/a", "/b", "/c", "a", "/b"):
        client.send("advertise_service", service=service, type=ADD)
    [text] = client.receive_statuses()
    assert text.startswith("advertise_service: ")
    assert "limit 2" in text
    assert "--max-advertisements" in text
    client.send("unadvertise_service", service="/a")
    client.send("advertise_service", service="/c", type=ADD)
    assert client.receive() == []
    assert sorted(hub.graph.services) == ["/b", "/c"]


def test_calls_for_a_server_that_does_not_read_are_limited() -> None:
    _, service_server, caller = adder_and_caller(max_queued_bytes=1000)
    service_server.queue.pause()
    for id_ in range(20):
        call_add(caller, id=id_)
    refused = caller.receive()
    assert 0 < len(refused) < 20
    assert {each["values"] for each in refused} == {
        "service [/add] unavailable: /adder reads too slowly"
    }
    assert not service_server.queue.overfull
    service_server.queue.resume()
    asked = received_calls(service_server)
    assert len(asked) + len(refused) == 20
    for due in asked:
        respond(service_server, due)
    assert len(received_sums(caller)) == len(asked)
