"""Providing services."""

from __future__ import annotations

from typing import Any

import pytest

from fibws.hub.graph.service import OwnProvider

from ..fakes import ADD, FakeHub
from .adding import (
    adder,
    adder_and_caller,
    answers,
    calls,
    hears_failure,
    hears_sums,
    is_asked,
    is_asked_once,
)

DEFINITION = "int8 one\n---\nint8 two\n"


def test_a_provided_service_is_in_the_graph_with_its_type_and_its_node() -> None:
    hub = FakeHub()
    provider = adder(hub, "/adder", "~add")
    service = hub.graph.services["/adder/add"]
    assert (service.name, service.type.name, service.node) == ("/adder/add", ADD, "/adder")
    assert list(provider.session.providing()) == ["/adder/add"]


@pytest.mark.parametrize("type_", [ADD, "rospy_tutorials/srv/AddTwoInts"])
def test_a_type_may_be_spelled_as_in_ros_1_or_2(type_: str) -> None:
    hub = FakeHub()
    hub.client().says("advertise_service", service="/add", type=type_)
    assert hub.graph.services["/add"].type.name == ADD


def test_what_a_client_provides_is_acknowledged_at_level_info() -> None:
    client = FakeHub().client("/adder")
    client.says("set_level", level="info")
    client.says("advertise_service", service="add", type=ADD, id=5)
    assert client.hears() == [
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
        ({"service": "/add#77"}, "'/add#77' is not a legal name"),
        ({"definition": "int33 x\n---\n", "type": "my_srvs/Do"}, "int33"),
    ],
)
def test_a_service_that_cannot_be_is_refused_and_leaves_nothing_behind(
    fields: dict[str, Any], fault: str
) -> None:
    hub = FakeHub()
    client = hub.client()
    client.says("advertise_service", **{"service": "/add", "type": ADD, **fields})
    [status] = client.hears_statuses()
    assert status.startswith("advertise_service: ")
    assert fault in status
    assert hub.graph.services == {}
    assert client.forgotten


def test_a_refused_service_leaves_the_provider_that_there_was() -> None:
    hub, provider, caller = adder_and_caller()
    other = hub.client()
    other.says("advertise_service", service="/add", type="std_srvs/Nothing")
    assert len(other.hears_statuses()) == 1
    calls(caller)
    answers(provider, is_asked_once(provider))
    assert hears_sums(caller) == [3]


def test_who_provides_a_service_of_an_unknown_package_is_warned() -> None:
    client = FakeHub().client()
    client.says("set_level", level="warning")
    client.says("advertise_service", service="/do", type="my_srvs/Do", id=1)
    [status] = client.hears()
    assert (status["id"], status["level"]) == (1, "warning")
    assert status["msg"] == "/do: calls of type my_srvs/Do are not checked"


def test_strict_types_refuse_an_unknown_package() -> None:
    hub = FakeHub(strict_types=True)
    client = hub.client()
    client.says("advertise_service", service="/do", type="my_srvs/Do")
    assert client.hears_statuses() == [
        "advertise_service: Unable to load the manifest for package my_srvs. "
        "Caused by: no folder of definitions holds it"
    ]
    assert hub.graph.services == {}


def test_a_provider_may_bring_the_definition() -> None:
    hub = FakeHub(strict_types=True)
    provider, caller = hub.client(), hub.client()
    provider.says("advertise_service", service="/do", type="my_srvs/Do", definition=DEFINITION)
    caller.says("call_service", service="/do", args=[5])
    asked = provider.hears_one("call_service")
    assert asked["args"] == {"one": 5}
    provider.says("service_response", service="/do", id=asked["id"], result=True)
    assert caller.hears_one("service_response")["values"] == {"two": 0}
    caller.says("call_service", service="/do", args=[500])
    assert "500 is not in -128..127" in hears_failure(caller)


# Headers.


def test_a_provider_that_asks_is_told_who_calls_and_what_the_caller_says_of_itself() -> None:
    hub = FakeHub()
    provider, caller = hub.client(), hub.client("/caller")
    provider.says("advertise_service", service="add", type=ADD, headers=True)
    calls(caller, headers={"user": "ann"})
    calls(caller)
    told = [each["header"] for each in provider.hears()]
    assert told == [{"callerid": "/caller", "user": "ann"}, {"callerid": "/caller"}]


def test_another_provider_is_told_nothing_of_that() -> None:
    _, provider, caller = adder_and_caller()
    calls(caller, headers={"user": "ann"}, header={"user": "bob"})
    asked = provider.hears_one("call_service")
    assert asked.keys() == {"op", "id", "service", "args"}


def test_the_newest_advertisement_decides_on_headers() -> None:
    _, provider, caller = adder_and_caller()
    for headers in (True, False):
        provider.says("advertise_service", service="/add", type=ADD, headers=headers)
        calls(caller)
        assert ("header" in provider.hears_one("call_service")) == headers


def test_a_call_whose_headers_are_none_is_refused() -> None:
    _, provider, caller = adder_and_caller()
    calls(caller, headers={"age": 5}, id=1)
    status, response = caller.hears()
    assert status["msg"].startswith("call_service: Expected field headers to be one of an object")
    assert (response["id"], response["result"]) == (1, False)
    assert provider.hears() == []


# Several providers of one name.


def test_a_newer_provider_takes_the_service_over() -> None:
    hub, older, caller = adder_and_caller()
    newer = adder(hub, "/newer")
    assert older.hears() == []
    assert hub.graph.services["/add"].node == "/newer"
    calls(caller)
    assert older.hears() == []
    answers(newer, is_asked_once(newer))
    assert hears_sums(caller) == [3]


def test_the_older_provider_is_warned_if_it_wants_to_know() -> None:
    hub, older, _ = adder_and_caller()
    older.says("set_level", level="warning")
    adder(hub, "/newer")
    assert older.hears_statuses("warning") == ["/add has another provider now"]
    assert list(older.session.providing()) == []


@pytest.mark.parametrize("fate", ["answers", "is late", "leaves"])
def test_calls_that_the_older_provider_has_are_still_its_own(fate: str) -> None:
    hub, older, caller = adder_and_caller()
    calls(caller)
    asked = is_asked_once(older)
    newer = adder(hub, "/newer")
    assert caller.hears() == newer.hears() == []
    if fate == "answers":
        answers(older, asked)
        assert hears_sums(caller) == [3]
    elif fate == "leaves":
        older.leaves()
        assert hears_failure(caller) == "service [/add] unavailable: /adder has left"
    else:
        hub.clock.advance(60)
        assert "did not answer within 60 s" in hears_failure(caller)
    assert hub.graph.services["/add"].node == "/newer"


@pytest.mark.parametrize("end", ["unadvertise", "leave"])
def test_the_older_provider_takes_nothing_from_the_newer(end: str) -> None:
    hub, older, caller = adder_and_caller()
    newer = adder(hub, "/newer")
    if end == "leave":
        older.leaves()
    else:
        older.says("unadvertise_service", service="/add")
    calls(caller)
    answers(newer, is_asked_once(newer))
    assert hears_sums(caller) == [3]


def test_a_service_may_change_hands_and_type() -> None:
    hub, _, caller = adder_and_caller()
    other = hub.client()
    other.says("advertise_service", service="/add", type="std_srvs/SetBool")
    caller.says("call_service", service="/add", args={"data": True})
    assert other.hears_one("call_service")["args"] == {"data": True}


def test_a_client_may_provide_its_service_again_under_another_spelling() -> None:
    hub, provider, caller = adder_and_caller()
    calls(caller, id="before")
    before = is_asked_once(provider)
    provider.says("advertise_service", service="add", type=ADD)
    calls(caller, id="after")
    asked = provider.hears_one("call_service")
    assert asked["service"] == "add"
    answers(provider, before)
    answers(provider, asked["id"])
    assert [each["id"] for each in caller.hears()] == ["before", "after"]
    calls(caller)
    provider.says("unadvertise_service", service="/add")
    assert hears_failure(caller) == "Service /add was unadvertised"
    assert hub.graph.services == {}


def test_nobody_takes_over_what_is_the_hubs_own() -> None:
    hub = FakeHub()
    hub.graph.offer("/rosapi/x", "std_srvs/Empty", "/rosapi", lambda request, caller: {})
    client = hub.client()
    client.says("advertise_service", service="/rosapi/x", type="std_srvs/Empty")
    assert client.hears_statuses() == [
        "advertise_service: Service /rosapi/x is the hub's own (/rosapi)"
    ]
    assert client.forgotten
    assert isinstance(hub.graph.services["/rosapi/x"].provider, OwnProvider)
    client.says("call_service", service="/rosapi/x")
    assert client.hears_one("service_response")["values"] == {}


# The end.


@pytest.mark.parametrize("spelling", ["/add", "add"])
def test_what_was_asked_of_a_service_that_is_taken_back_fails_at_once(spelling: str) -> None:
    hub, provider, caller = adder_and_caller()
    provider.says("advertise_service", service="/other", type=ADD)
    calls(caller, service="/other", id="other")
    calls(caller, id="x")
    _, asked = is_asked(provider)
    provider.says("unadvertise_service", service=spelling)
    response = caller.hears_one("service_response")
    assert (response["id"], response["result"]) == ("x", False)
    assert response["values"] == "Service /add was unadvertised"
    calls(caller)
    assert hears_failure(caller) == "Service /add does not exist"
    answers(provider, asked)
    assert (caller.hears(), provider.hears()) == ([], [])
    assert list(hub.graph.services) == ["/other"]


@pytest.mark.parametrize("service", [None, "/nope", "nope"])
def test_what_was_never_provided_may_be_taken_back(service: str | None) -> None:
    hub, provider, caller = adder_and_caller()
    provider.says("unadvertise_service", service=service)
    caller.says("unadvertise_service", service="/add")
    assert provider.hears() == caller.hears() == []
    assert list(hub.graph.services) == ["/add"]


def test_calls_of_a_provider_that_leaves_fail_at_once() -> None:
    hub, provider, caller = adder_and_caller()
    for id_ in "ab":
        calls(caller, id=id_)
    provider.leaves()
    assert [(each["id"], each["values"]) for each in caller.hears()] == [
        (id_, "service [/add] unavailable: /adder has left") for id_ in "ab"
    ]
    assert hub.graph.services == {}
    assert caller.forgotten


def test_calls_of_a_provider_that_loses_its_name_fail_at_once() -> None:
    hub, provider, caller = adder_and_caller()
    calls(caller)
    newer = adder(hub, "/adder")
    assert len(provider.closings) == 1
    assert hears_failure(caller) == "service [/add] unavailable: /adder has left"
    calls(caller)
    answers(newer, is_asked_once(newer))
    assert hears_sums(caller) == [3]


def test_a_caller_that_leaves_needs_no_answer() -> None:
    hub, provider, caller = adder_and_caller()
    calls(caller)
    asked = is_asked_once(provider)
    caller.leaves()
    assert hub.clock.timers == 0
    assert not provider.kept["calls to answer"]
    answers(provider, asked)
    assert provider.hears() == caller.hears() == []


# How much one client may have.


def test_a_client_may_provide_so_many_services_and_no_more() -> None:
    hub = FakeHub(max_advertisements=2)
    client = hub.client()
    for service in ("/a", "/b", "/c", "a", "/b"):
        client.says("advertise_service", service=service, type=ADD)
    assert client.hears_statuses() == [
        "advertise_service: One client may have 2 advertisements, not more "
        "(--max-advertisements of the hub)"
    ]
    client.says("unadvertise_service", service="/a")
    client.says("advertise_service", service="/c", type=ADD)
    assert client.hears() == []
    assert sorted(hub.graph.services) == ["/b", "/c"]


def test_a_provider_that_does_not_read_is_asked_no_more_than_it_may_be_sent() -> None:
    _, provider, caller = adder_and_caller(max_queued_bytes=1000)
    provider.outbox.pause()
    for id_ in range(20):
        calls(caller, id=id_)
    refused = caller.hears()
    assert 0 < len(refused) < 20
    assert {each["values"] for each in refused} == {
        "service [/add] unavailable: /adder reads too slowly"
    }
    assert not provider.outbox.overfull
    provider.outbox.resume()
    asked = is_asked(provider)
    assert len(asked) + len(refused) == 20
    for due in asked:
        answers(provider, due)
    assert len(hears_sums(caller)) == len(asked)
