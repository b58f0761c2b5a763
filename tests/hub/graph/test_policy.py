"""The policy: what nodes may do, and which names they may list."""

from __future__ import annotations

import json
from collections.abc import Callable, Hashable
from typing import Any

import pytest

from fibws.access.rights import Right
from fibws.hub.errors import NotAllowed
from fibws.hub.graph.graph import Graph
from fibws.hub.graph.policy import RIGHTS_OF, AllowAll
from fibws.interfaces import Interfaces
from fibws.protocol.serialized import publish_head

from ..fakes import ADD, FIBONACCI, INT32, NANOSECONDS, Client, FakeHub, number
from ..rosapi.rosapi_client import RosapiClient
from ..rosbridge import service_clients
from .recorder import Recorder


class Forbid(AllowAll):
    """A `Policy` that forbids some combinations of node, right and name."""

    allows_all = False

    def __init__(self, *forbidden: tuple[str, Right, str]) -> None:
        self.forbidden = set(forbidden)
        self.questions: list[tuple[str, Right, str]] = []

    def may(self, node: str, right: Right, name: str) -> bool:
        self.questions.append((node, right, name))
        return (node, right, name) not in self.forbidden

    def view(self, node: str) -> Hashable:
        return node, frozenset(self.forbidden)


class HideSecrets(AllowAll):
    """A `Policy` that hides every name with ``secret`` in it from /guest, which owns nothing."""

    allows_all = False

    def may(self, node: str, right: Right, name: str) -> bool:
        return node != "/guest" or "secret" not in name

    def is_admin(self, node: str) -> bool:
        return node != "/guest"

    def is_same_owner(self, node: str, other: str) -> bool:
        return node == other


# Operations.

ADVERTISE = {"op": "advertise", "topic": "/a", "type": INT32}
CALL = {"op": "call_service", "service": "/a", "args": {}, "id": "1"}
GOAL = {"op": "send_action_goal", "action": "/a", "action_type": FIBONACCI, "id": "1"}

REFUSED: list[tuple[Right, dict[str, Any]]] = [
    ("publish", ADVERTISE),
    ("publish", {"op": "publish", "topic": "/typed", "msg": {"data": 1}}),
    ("subscribe", {"op": "subscribe", "topic": "/a", "type": INT32}),
    ("subscribe", {"op": "subscribe", "topic": "/a"}),
    ("call", CALL),
    ("call", GOAL),
    ("provide", {"op": "advertise_service", "service": "/a", "type": ADD}),
    ("provide", {"op": "advertise_action", "action": "/a", "type": FIBONACCI}),
]


def refusal(client: Client) -> tuple[str, str]:
    """The code and the text of the one error that a client got.

    It comes in the response to a call or a goal, otherwise in a status.
    """
    [received] = client.receive()
    if received["op"] == "status":
        assert received["level"] == "error"
        return received["code"], received["msg"]
    assert (received["id"], received["result"]) == ("1", False)
    return received["code"], received["values"]


@pytest.mark.parametrize(
    ("right", "operation"), REFUSED, ids=[f"{right} {each['op']}" for right, each in REFUSED]
)
def test_forbidden_operation_is_refused_and_changes_nothing(
    right: Right, operation: dict[str, Any]
) -> None:
    name = operation.get("topic") or operation.get("service") or operation["action"]
    policy = Forbid(("/guest", right, name))
    hub = FakeHub(policy=policy)
    hub.client("/listener").send("subscribe", "/typed", type=INT32)
    guest, member = (hub.client(node, serialized=True) for node in ("/guest", "/member"))
    graph = hub.graph
    before = (
        graph.revision,
        list(graph.topics),
        list(graph.services),
        list(graph.actions),
    )
    guest.send_text(json.dumps(operation))
    code, text = refusal(guest)
    assert code == "not_allowed"
    assert all(each in text for each in ("/guest", right, name))
    after = (graph.revision, list(graph.topics), list(graph.services), list(graph.actions))
    assert after == before
    assert guest.forgotten
    assert ("/guest", right, name) in policy.questions
    member.send_text(json.dumps(operation))
    assert ("/member", right, name) in policy.questions
    assert all(each.get("code") != "not_allowed" for each in member.receive())


def test_plain_rosbridge_client_gets_the_refusal_without_a_code() -> None:
    hub = FakeHub(policy=Forbid(("/guest", "publish", "/a")))
    guest = hub.client("/guest")
    guest.send_text(json.dumps(ADVERTISE))
    [status] = guest.receive_statuses()
    assert "/guest" in status
    assert "/a" in status


def test_client_that_may_not_publish_may_still_subscribe() -> None:
    hub = FakeHub(policy=Forbid(("/guest", "publish", "/a")))
    guest, member = hub.client("/guest", serialized=True), hub.client("/member")
    member.send("advertise", "/a", type=INT32)
    guest.send("advertise", "/a", type=INT32, publisher=1)
    assert refusal(guest)[0] == "not_allowed"
    guest.send_binary(publish_head(1) + bytes(4))
    assert refusal(guest)[0] == "unknown_publisher"
    guest.send("subscribe", "/a")
    member.send("publish", "/a", msg=number(5))
    assert guest.receive_numbers("/a") == [5]


def test_forbidden_server_does_not_displace_the_present_one() -> None:
    hub = FakeHub(policy=Forbid(("/guest", "provide", "/add"), ("/guest", "provide", "/fib")))
    member, guest = hub.client("/member"), hub.client("/guest", serialized=True)
    for client in (member, guest):
        client.send("advertise_service", service="/add", type=ADD)
        client.send("advertise_action", action="/fib", type=FIBONACCI)
    assert [each["code"] for each in guest.receive()] == ["not_allowed", "not_allowed"]
    assert hub.graph.services["/add"].node == hub.graph.actions["/fib"].node == "/member"
    assert member.receive() == []


@pytest.mark.parametrize("fields", [{"result": True, "values": {"sum": 9}}, {"result": 1}])
def test_client_that_may_not_provide_a_service_cannot_respond_for_its_server(
    fields: dict[str, Any],
) -> None:
    hub = FakeHub(policy=Forbid(("/guest", "provide", "/add")))
    service_server, caller = service_clients.adder(hub), hub.client()
    guest = hub.client("/guest")
    service_clients.call_add(caller)
    asked = service_clients.received_call(service_server)
    guest.send("service_response", service="/add", id=asked, **fields)
    assert len(guest.receive_statuses()) == 1
    assert caller.receive() == []
    service_clients.respond(service_server, asked)
    assert service_clients.received_sums(caller) == [3]


def test_forbidden_call_does_not_reveal_whether_the_service_exists() -> None:
    hub = FakeHub(policy=Forbid(("/guest", "call", "/there"), ("/guest", "call", "/missing")))
    hub.client("/member").send("advertise_service", service="/there", type=ADD)
    guest = hub.client("/guest", serialized=True)
    answers = []
    for service in ("/there", "/missing"):
        guest.send("call_service", service=service, args={"wrong": 1}, id="1")
        answers.append(refusal(guest)[1].replace(service, "/x"))
    assert answers[0] == answers[1]


def test_forbidden_sink_gets_nothing() -> None:
    graph = Graph(
        Interfaces(), lambda: NANOSECONDS, policy=Forbid(("/recorder", "subscribe", "/a"))
    )
    source = graph.advertise(graph.topic("/a"), "/talker", INT32)
    recorder = Recorder()
    with pytest.raises(NotAllowed) as caught:
        graph.subscribe(source.topic, recorder)
    assert (caught.value.node, caught.value.right, caught.value.name) == (
        "/recorder",
        "subscribe",
        "/a",
    )
    source.publish({"data": 1})
    assert recorder.received == []
    assert list(source.topic.subscribers()) == []


# Parameters.


def parameter_calls(name: str) -> list[tuple[Right, str, dict[str, str]]]:
    return [
        ("param_read", "get_param", {"name": name}),
        ("param_write", "set_param", {"name": name, "value": "2"}),
        ("param_write", "delete_param", {"name": name}),
    ]


@pytest.mark.parametrize("spelling", ["/robot/arm", "robot/arm", "/robot//arm/"])
@pytest.mark.parametrize(
    ("right", "service"), [(right, service) for right, service, _ in parameter_calls("")]
)
def test_forbidden_parameter_can_be_neither_read_nor_changed(
    right: Right, service: str, spelling: str
) -> None:
    policy = Forbid(("/guest", right, "/robot/arm"))
    rosapi = RosapiClient("/guest", policy=policy)
    rosapi.graph.parameters.set("/robot/arm", 1)
    [args] = [args for _, each, args in parameter_calls(spelling) if each == service]
    refusal = rosapi.refusal(f"/rosapi/{service}", **args)
    assert all(each in refusal for each in ("/guest", right, "/robot/arm"))
    assert rosapi.graph.parameters.get("/robot/arm") == 1
    policy.forbidden.clear()
    rosapi.call(f"/rosapi/{service}", **args)


@pytest.mark.parametrize("right", ["param_read", "param_write"])
def test_graph_asks_the_policy_about_parameters(right: Right) -> None:
    graph = Graph(Interfaces(), lambda: NANOSECONDS, policy=Forbid(("/guest", right, "/x")))
    graph.set_parameter("/member", "/x", 1)
    actions: dict[str, list[Callable[[str], object]]] = {
        "param_read": [lambda node: graph.view(node).parameter("/x")],
        "param_write": [
            lambda node: graph.set_parameter(node, "/x", 2),
            lambda node: graph.delete_parameter(node, "/x"),
        ],
    }
    for action in actions[right]:
        with pytest.raises(NotAllowed) as caught:
            action("/guest")
        assert caught.value.code == "not_allowed"
        assert graph.view("/member").parameter("/x") == b"1"
    for action in actions[right]:
        action("/member")


# Listings.


@pytest.fixture
def rosapi() -> RosapiClient:
    """A hub with open and secret names of every kind; its client is /guest."""
    rosapi = RosapiClient("/guest", policy=HideSecrets())
    for kind in ("open", "secret"):
        client = rosapi.connect(f"/{kind}_node").client
        client.send("advertise", f"/{kind}", type=INT32)
        client.send("subscribe", f"/{kind}")
        client.send("advertise_service", service=f"/{kind}_add", type=ADD)
        client.send("advertise_action", action=f"/{kind}_fib", type=FIBONACCI)
        for topic in ("goal", "cancel", "feedback", "status", "result"):
            client.send("advertise", f"/{kind}_move/{topic}", type=INT32)
        rosapi.graph.set_parameter(f"/{kind}_node", f"/{kind}/param", 1)
        assert client.receive() == []
    return rosapi


def respond(rosapi: RosapiClient, client: Client, service: str, args: dict[str, str]) -> Any:
    client.send("call_service", service=f"/rosapi/{service}", args=args)
    response = client.receive_one("service_response")
    assert response["result"], response
    return response["values"]


NOTHING: dict[str, Any] = {"publishing": [], "subscribing": [], "services": []}

LISTINGS: list[tuple[str, dict[str, str]]] = [
    ("topics", {}),
    ("topics_and_raw_types", {}),
    ("topics_for_type", {"type": INT32}),
    ("services", {}),
    ("services_for_type", {"type": ADD}),
    ("service_providers", {"service": ADD}),
    ("nodes", {}),
    ("action_servers", {}),
    ("graph", {}),
    ("statistics", {}),
    ("get_param_names", {}),
]


@pytest.mark.parametrize("guest_first", [True, False])
@pytest.mark.parametrize(("service", "args"), LISTINGS, ids=[service for service, _ in LISTINGS])
def test_listing_leaves_out_names_that_the_caller_may_not_list(
    rosapi: RosapiClient, service: str, args: dict[str, str], guest_first: bool
) -> None:
    member = rosapi.add_client("/member")
    clients = [("/guest", rosapi.client), ("/member", member)]
    for node, client in (clients if guest_first else clients[::-1]) * 2:
        text = json.dumps(respond(rosapi, client, service, args))
        assert "open" in text
        assert ("secret" in text) == (node == "/member"), (node, text)


LOOKUPS: list[tuple[str, dict[str, str], Any]] = [
    ("topic_type", {"topic": "/secret"}, {"type": ""}),
    ("publishers", {"topic": "/secret"}, {"publishers": []}),
    ("subscribers", {"topic": "/secret"}, {"subscribers": []}),
    ("service_type", {"service": "/secret_add"}, {"type": ""}),
    ("service_node", {"service": "/secret_add"}, {"node": ""}),
    ("service_host", {"service": "/secret_add"}, {"host": ""}),
    ("node_details", {"node": "/secret_node"}, NOTHING),
    ("has_param", {"name": "/secret/param"}, {"exists": False}),
    ("has_param", {"name": "//secret//param/"}, {"exists": False}),
    ("search_param", {"name": "/secret/param"}, {"global_name": ""}),
]


@pytest.mark.parametrize(
    ("service", "args", "hidden"), LOOKUPS, ids=[f"{each[0]} {each[1]}" for each in LOOKUPS]
)
def test_name_that_the_caller_may_not_list_looks_unknown(
    rosapi: RosapiClient, service: str, args: dict[str, str], hidden: Any
) -> None:
    member = rosapi.add_client("/member")
    for _ in range(2):
        assert respond(rosapi, rosapi.client, service, args) == hidden
        assert respond(rosapi, member, service, args) != hidden


@pytest.mark.parametrize("service", ["ping_node", "kill_node", "unregister_node"])
def test_hidden_node_can_be_neither_pinged_nor_killed(rosapi: RosapiClient, service: str) -> None:
    hidden = respond(rosapi, rosapi.client, service, {"node": "/secret_node"})
    unknown = respond(rosapi, rosapi.client, service, {"node": "/nobody"})
    assert hidden["message"] == unknown["message"].replace("/nobody", "/secret_node")
    assert not hidden["success"]
    assert "/secret_node" in rosapi.graph.nodes


def test_details_of_a_node_leave_out_hidden_names(rosapi: RosapiClient) -> None:
    mixed = rosapi.add_client("/mixed")
    for kind in ("open", "secret"):
        mixed.send("advertise", f"/{kind}", type=INT32)
        mixed.send("subscribe", f"/{kind}")
        mixed.send("advertise_service", service=f"/{kind}_mixed", type=ADD)
    assert respond(rosapi, rosapi.client, "node_details", {"node": "/mixed"}) == {
        "publishing": ["/open"],
        "subscribing": ["/open"],
        "services": ["/open_mixed"],
    }
    member = rosapi.add_client("/member")
    details = respond(rosapi, member, "node_details", {"node": "/mixed"})
    assert details["publishing"] == ["/open", "/secret"]


def test_action_over_topics_is_hidden_with_any_of_its_topics() -> None:
    policy = Forbid(*(("/guest", right, "/move/status") for right in RIGHTS_OF["topic"]))
    rosapi = RosapiClient("/guest", policy=policy)
    server, member = rosapi.add_client("/server"), rosapi.add_client("/member")
    for topic in ("goal", "cancel", "feedback", "status", "result"):
        server.send("advertise", f"/move/{topic}", type=INT32)
    listed = [
        respond(rosapi, client, "action_servers", {})["action_servers"]
        for client in (rosapi.client, member)
    ]
    assert listed == [[], ["/move"]]
    assert [
        len(respond(rosapi, client, "graph", {})["actions"]) for client in (rosapi.client, member)
    ] == [0, 1]


def test_names_are_listed_again_once_the_policy_allows_it() -> None:
    policy = Forbid(*(("/guest", right, "/a") for right in RIGHTS_OF["topic"]))
    rosapi = RosapiClient("/guest", policy=policy)
    rosapi.add_client("/talker").send("advertise", "/a", type=INT32)
    assert "/a" not in rosapi.call("/rosapi/topics")["topics"]
    policy.forbidden.clear()
    assert "/a" in rosapi.call("/rosapi/topics")["topics"]


def test_without_a_policy_everything_is_allowed() -> None:
    graph = Graph(Interfaces(), lambda: NANOSECONDS)
    assert isinstance(graph.policy, AllowAll)
    rights: list[Right] = ["publish", "subscribe", "call", "provide", "param_read", "param_write"]
    assert all(graph.policy.may("/guest", right, "/a") for right in rights)
    assert graph.view("/guest").sees("topic", "/a")


@pytest.mark.parametrize(
    "service",
    [
        "topics",
        "topics_and_raw_types",
        "nodes",
        "services",
        "action_servers",
        "graph",
        "statistics",
    ],
)
def test_policy_is_asked_once_for_each_change_however_often_lists_are_asked_for(
    service: str,
) -> None:
    policy = Forbid()
    rosapi = RosapiClient("/guest", policy=policy)
    talker = rosapi.add_client("/talker")
    for each in range(20):
        talker.send("advertise", f"/a_{each}", type=INT32)
    rosapi.call(f"/rosapi/{service}")
    policy.questions.clear()
    rosapi.call(f"/rosapi/{service}")
    assert len(policy.questions) < 5
