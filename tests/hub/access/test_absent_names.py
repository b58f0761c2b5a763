"""A name that is hidden from a client looks as if nothing had it: each answer is the same.

Two hubs are asked the same, of which only one has a node that the client may not see.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import pytest

from fibws.access.rights import Principal, Rights
from fibws.hub.access.policy import AccessPolicy
from fibws.hub.errors import NotAllowed
from fibws.hub.foxglove.session import Foxglove
from fibws.hub.log.audit import Audit
from fibws.hub.rosbridge.session import RosbridgeSession

from ..fakes import ADD, FIBONACCI, INT32, Client, InlineWorkers
from ..foxglove.foxglove_client import FoxgloveClient
from ..rosapi.rosapi_client import RosapiClient

LOG = "rosgraph_msgs/Log"
BROUGHT = {
    "advertise": ("hidden_msgs/Thing", "int32 x"),
    "advertise_service": ("hidden_msgs/Do", "int32 a\n---\nint32 b"),
    "advertise_action": ("hidden_msgs/Go", "int32 a\n---\nint32 b\n---\nint32 c"),
}
"""Types that the hidden node has brought, by how it uses them."""
NAMES: tuple[str, ...] = (
    *("/hid/arm", "/hid/topic", "/hid/cmd", "/hid/log", "/hid/srv", "/hid/add", "/hid/act"),
    *("/hid/fib", "/hid/goal", "/hid", "/hid/param", "/hid/ns", "/hid/ns/deep", "hid/topic"),
    *("~arm", "param", "arm", "/open", "/guest", "/guest/param", "/", ""),
)
TYPES: tuple[str, ...] = (
    *(INT32, LOG, ADD, FIBONACCI, *(name for name, _ in BROUGHT.values())),
    *("hidden_msgs/DoRequest", "hidden_msgs/GoGoal", "hidden_msgs/Thin", "hidden_msgs/GoAction"),
)
OWNER = Principal(
    "owner",
    Rights(
        {
            "publish": ["/hid/**"],
            "subscribe": ["/hid/**", "/rosout"],
            "provide": ["/hid/**"],
            "param_write": ["/hid/**", "/open/secret", "/guest/param"],
            "node": ["/hid/**"],
        }
    ),
)
GUEST = Principal(
    "guest",
    Rights(
        {
            "publish": ["/open/**"],
            "subscribe": ["/open/**", "/rosout"],
            "call": ["/open/**"],
            "provide": ["/open/**"],
            "param_read": ["/open", "/open/a/**", "/param"],
            "param_write": ["/open/a/**"],
        },
    ),
)
ADMIN = Principal("admin", Rights(admin=True))


@dataclass
class World:
    """A hub and its guest.

    Attributes:
        hub: with rosapi.
        guest: a client of ``fibws.v1``.
    """

    hub: RosapiClient
    guest: Client

    def ask(self, operation: dict[str, Any]) -> bytes:
        """Return all that the hub answers to an operation."""
        self.guest.send_text(json.dumps(operation))
        self.hub.hub.clock.advance(1)
        return b"".join(payload for _, payload in self.guest.receive_frames())


def new_world(*, is_there: bool) -> World:
    """Return a hub on which the hidden node is, or is not."""
    hub = RosapiClient("/tool", principal=ADMIN, policy=AccessPolicy([OWNER]))
    hub.graph.set_parameter("/tool", "/param", 1)
    if is_there:
        _add_hidden(hub)
    guest = hub.hub.client("/guest", principal=GUEST, serialized=True)
    guest.send("set_level", level="info")
    return World(hub, guest)


def _add_hidden(hub: RosapiClient) -> None:
    hidden = hub.connect("/hid/arm", principal=OWNER).client
    for op, (type_, definition) in BROUGHT.items():
        kind = op.partition("_")[2] or "topic"
        name = {"topic": "/hid/topic", "service": "/hid/srv", "action": "/hid/act"}[kind]
        hidden.send(op, **{kind: name}, type=type_, definition=definition)
    hidden.send("subscribe", "/hid/cmd", type=INT32)
    hidden.send("advertise_service", service="/hid/add", type=ADD)
    hidden.send("advertise_action", action="/hid/fib", type=FIBONACCI)
    for part in ("goal", "cancel", "feedback", "status", "result"):
        hidden.send("advertise", f"/hid/goal/{part}", type=INT32)
    hidden.send("advertise", "/rosout", type=LOG)
    hidden.send("subscribe", "/rosout", type=LOG)
    assert hidden.receive() == []
    for name in ("/hid/param", "/hid/ns/deep", "/open/secret", "/guest/param"):
        hub.graph.set_parameter("/hid/arm", name, 5)


def plain(answer: bytes) -> bytes:
    """Return an answer without the number of changes of the graph, which count for all."""
    return re.sub(rb'"revision":\d+', b"", answer)


def check_alike(ask: Callable[[World], bytes]) -> bytes:
    """Check that a question has the same answer if the names are hidden and if they are absent."""
    hidden, absent = (plain(ask(new_world(is_there=is_there))) for is_there in (True, False))
    assert hidden == absent
    return hidden


def rosapi_calls() -> Iterator[tuple[str, dict[str, Any]]]:
    """Yield each service of rosapi with each hidden name or type in each of its fields."""
    world = new_world(is_there=False)
    for name, service in sorted(world.hub.graph.services.items()):
        if name.startswith("/rosapi/"):
            request = world.hub.graph.definitions.service(service.type.name).request
            fields = [field.name for field in request.fields]
            for text in (*NAMES, *TYPES) if fields else ("",):
                yield name, {key: "1" if key in ("value", "default") else text for key in fields}


@pytest.mark.parametrize("service", sorted({name for name, _ in rosapi_calls()}))
def test_rosapi(service: str) -> None:
    hidden, absent = (new_world(is_there=is_there) for is_there in (True, False))
    for name, args in rosapi_calls():
        if name == service:
            operation = {"op": "call_service", "service": name, "args": args, "id": "1"}
            answers = [plain(world.ask(operation)) for world in (hidden, absent)]
            assert answers[0] == answers[1], args
            assert answers[0]


def operations() -> Iterator[dict[str, Any]]:
    """Yield operations of rosbridge that name what is hidden."""
    for name in filter(None, NAMES):
        for type_ in (INT32, "std_msgs/String", "hidden_msgs/Thing"):
            yield {"op": "advertise", "topic": name, "type": type_, "peers": True, "publisher": 1}
            yield {"op": "subscribe", "topic": name, "type": type_, "peers": True}
            yield {"op": "set_will", "topic": name, "type": type_, "msg": {}}
        yield {"op": "publish", "topic": name, "msg": {"data": 1}}
        yield {"op": "subscribe", "topic": name, "peers": True, "headers": True}
        for args in ({}, {"a": "x"}):
            yield {"op": "call_service", "id": "1", "service": name, "args": args}
        for type_ in (FIBONACCI, "hidden_msgs/Go", ADD):
            goal = {"op": "send_action_goal", "id": "1", "action": name, "action_type": type_}
            yield {**goal, "args": {}}
        cancel = f"{name}/_action/cancel_goal"
        yield {"op": "call_service", "id": "1", "service": cancel, "args": {}}
        for kind in ("service", "action"):
            yield {"op": f"advertise_{kind}", kind: name, "type": ADD}


@pytest.mark.parametrize("op", sorted({each["op"] for each in operations()}))
def test_operations(op: str) -> None:
    hidden, absent = (new_world(is_there=is_there) for is_there in (True, False))
    for operation in operations():
        if operation["op"] == op:
            answers = [plain(world.ask(operation)) for world in (hidden, absent)]
            assert answers[0] == answers[1], operation


@pytest.mark.parametrize("to", ["/hid/arm", "/hid/none"])
def test_message_to_one_node(to: str) -> None:
    def ask(world: World) -> bytes:
        advertised = world.ask({"op": "advertise", "topic": "/open/t", "type": INT32})
        sent = {"op": "publish", "topic": "/open/t", "msg": {"data": 1}, "to": to}
        return advertised + world.ask(sent)

    check_alike(ask)


@pytest.mark.parametrize("changes", [False, True])
@pytest.mark.parametrize("op", ["advertise", "subscribe"])
def test_peers_of_the_log(op: str, changes: bool) -> None:
    asked = {"op": op, "topic": "/rosout", "type": LOG, "peers": True, "peer_changes": changes}

    def ask(world: World) -> bytes:
        answer = world.ask(asked)
        if node := world.hub.graph.nodes.get("/hid/arm"):
            assert isinstance(node, RosbridgeSession)
            node.leave()
        else:
            _add_hidden(world.hub)
        return answer + world.ask({"op": "unsubscribe", "topic": "/none"})

    assert b'"op":"peers"' in check_alike(ask)


@pytest.mark.parametrize("name", ["/hid/arm", "/hid/none", "/guest", "/rosapi", "/tool"])
def test_name_of_a_node(name: str) -> None:
    def ask(world: World) -> bytes:
        stranger = Principal("stranger", Rights({"node": ["/stranger/**"]}))
        with pytest.raises(NotAllowed) as refusal:
            world.hub.hub.client(name, principal=stranger)
        return str(refusal.value).encode()

    assert b"another principal" not in check_alike(ask)


TYPED: list[dict[str, Any]] = [
    *(
        {"op": op, "topic": "/open/t", "type": type_, "id": "1"}
        for op in ("advertise", "subscribe")
        for type_ in ("hidden_msgs/Thing", "hidden_msgs/Thin", "hidden_msgs/DoRequest")
    ),
    {"op": "advertise", "topic": "/open/t", "type": "hidden_msgs/Thing", "publisher": 1},
    {"op": "advertise_service", "service": "/open/s", "type": "hidden_msgs/Do"},
    {"op": "advertise_action", "action": "/open/a", "type": "hidden_msgs/Go"},
    # Nested in a type of the guest's.
    *(
        {"op": "advertise", "topic": "/open/t", "type": "own/Own", "definition": definition}
        for definition in ("hidden_msgs/Thing it", "hidden_msgs/DoRequest it")
    ),
]
"""Uses of hidden types by their names."""


@pytest.mark.parametrize("use", TYPED)
def test_type_that_is_named(use: dict[str, Any]) -> None:
    def ask(world: World) -> bytes:
        answers = [world.ask(use)]
        answers.append(world.ask({"op": "publish", "topic": "/open/t", "msg": {"x": "text"}}))
        subscription = {"op": "subscribe", "topic": "/open/t", "send_definition": True}
        answers.append(re.sub(rb'"topic_id":\d+', b"", world.ask(subscription)))
        calls = [("topics_and_raw_types", {}), ("message_details", {"type": "own/Own"})]
        calls += [("message_details", {"type": BROUGHT["advertise"][0]})]
        for service, args in calls:
            call = {"op": "call_service", "service": f"/rosapi/{service}", "args": args}
            answers.append(world.ask(call))
        call = {"op": "call_service", "service": "/open/s", "args": {"a": "text"}, "id": "1"}
        answers.append(world.ask(call))
        goal = {"op": "send_action_goal", "action": "/open/a", "action_type": "hidden_msgs/Go"}
        answers.append(world.ask({**goal, "args": {"a": "text"}, "id": "1"}))
        return re.sub(rb'"id":"[^"]*"', b"", b"".join(answers))  # Those of calls are random.

    check_alike(ask)


def test_type_may_be_brought_with_other_fields_than_a_hidden_one_has() -> None:
    def ask(world: World) -> bytes:
        brought = {"type": "hidden_msgs/Thing", "definition": "int64 y"}
        return world.ask({"op": "advertise", "topic": "/open/t", **brought})

    check_alike(ask)


def test_type_is_known_to_those_who_see_something_that_has_it() -> None:
    world = new_world(is_there=True)
    details = {
        **{"op": "call_service", "service": "/rosapi/message_details", "id": "1"},
        "args": {"type": "hidden_msgs/Thing"},
    }
    assert b'"result":false' in world.ask(details)
    world.hub.client.send("advertise", "/open/shown", type="hidden_msgs/Thing")
    assert json.loads(world.ask(details))["values"]["typedefs"][0]["fieldnames"] == ["x"]


def foxglove_answers(world: World) -> bytes:
    """Return all that a client of Foxglove's protocol gets, whatever it asks."""
    fake = world.hub.hub
    fake.foxglove = Foxglove(  # type: ignore[attr-defined]
        fake.graph,
        fake.clock,
        fake.settings,
        Audit(fake.clock.time),
        name="test",
        readers=InlineWorkers(),
    )
    client = FoxgloveClient(fake, None, GUEST)  # type: ignore[arg-type]
    names = list(NAMES)
    client.send("subscribeConnectionGraph")
    client.send("getParameters", parameterNames=[], id="all")
    client.send("getParameters", parameterNames=[*names, "/open", "/open/secret", "/"], id="some")
    client.send("subscribeParameterUpdates", parameterNames=["/hid/param", "/hid", "/", "/open"])
    for number, name in enumerate(names):
        client.send("setParameters", parameters=[{"name": name, "value": 1}], id="set")
        client.advertise(name, "hidden_msgs/Thing", number)
        client.send("fetchAsset", uri=f"package:/{name}", requestId=number)
    client.advertise("/open/t", "hidden_msgs/Thing", 99)
    fake.graph.set_parameter("/tool", "/hid/param", 7)
    fake.clock.advance(1)
    fake.clock.turn()
    frames = b"".join(bytes(each) for each in client.writes)
    varying = rb'"(sessionId|channelId)":"[^"]*"|client_\d+_\w+'
    return re.sub(varying, b"", frames)


def test_foxglove() -> None:
    assert b"connectionGraphUpdate" in check_alike(foxglove_answers)
