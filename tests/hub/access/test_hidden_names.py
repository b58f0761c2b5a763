"""What a client may not see is in no answer whatever that it gets."""

from __future__ import annotations

import json
import random
from collections.abc import Iterator
from typing import Any

import pytest

from fibws.access.rights import RIGHTS, Principal, Right, Rights
from fibws.hub.access.policy import AccessPolicy
from fibws.hub.graph.policy import RIGHTS_OF, Kind

from ..fakes import ADD, FIBONACCI, INT32, Client
from ..rosapi.rosapi_client import RosapiClient

KINDS: list[Kind] = ["topic", "service", "action", "parameter"]
ADMIN = Principal("admin", Rights(admin=True))
GRACE = 10.0
"""Seconds after which a message to a topic without a type is refused at once."""


class World:
    """A hub with random nodes that use random names, and a client that may use some of these.

    Every name is a word that occurs nowhere else.
    """

    def __init__(self, chance: random.Random) -> None:
        self.chance = chance
        self.rosapi = RosapiClient("/admin_tool", principal=ADMIN, policy=AccessPolicy())
        self.names: dict[Kind, list[str]] = {
            kind: [self._new_name(kind) for _ in range(6)] for kind in KINDS
        }
        self.used_by: dict[str, set[tuple[Kind, str]]] = {}
        self.rights = self._new_rights()
        for number in range(5):
            self._add_node(number)
        spy = Principal("spy", self.rights)
        self.spy = self.rosapi.hub.client("/spy", principal=spy, serialized=True)
        self.spy.send("set_level", level="info")
        self.rosapi.hub.clock.advance(GRACE)

    def _new_name(self, kind: Kind) -> str:
        word = f"{kind}{self.chance.getrandbits(40):010x}"
        # In a namespace that others have, too, and sometimes deeper.
        return f"/{self.chance.choice('ab')}{self.chance.choice(('', '/x'))}/{word}"

    def _new_rights(self) -> Rights:
        allow: dict[Right, list[str]] = {right: [] for right in RIGHTS if right != "node"}
        deny: dict[Right, list[str]] = {right: [] for right in RIGHTS}
        for kind, names in self.names.items():
            for name in names:
                for right in RIGHTS_OF[kind]:
                    if self.chance.random() < 0.25:
                        allow[right].append(name)
        if self.chance.random() < 0.3:  # Everything of a namespace, but for some.
            right = self.chance.choice([*allow])
            allow[right].append("/a/**")
            deny[right] += [name for names in self.names.values() for name in names[:3]]
        return Rights(allow, deny)

    def _add_node(self, number: int) -> None:
        node = f"/node{self.chance.getrandbits(40):010x}"
        connection = self.rosapi.connect(node, principal=ADMIN)
        client, uses = connection.client, self.used_by.setdefault(node, set())
        for kind, names in self.names.items():
            name = self.chance.choice(names)
            uses.add((kind, name))
            if kind == "topic":
                self._use_topic(client, name)
            elif kind == "service":
                client.send("advertise_service", service=name, type=ADD)
            elif kind == "action":
                client.send("advertise_action", action=name, type=FIBONACCI)
            else:
                self.rosapi.graph.set_parameter(node, name, number)
        client.send("advertise", "/rosout", type="rosgraph_msgs/Log", peers=True)
        client.receive()

    def _use_topic(self, client: Client, name: str) -> None:
        op = self.chance.choice(("advertise", "subscribe", "own type"))
        if op == "own type":
            client.send("advertise", name, type="own_msgs/Shared", definition="int32 data")
        else:
            client.send(op, name, type=INT32)

    def is_visible(self, kind: Kind, name: str) -> bool:
        return any(self.rights.allows(right, name) for right in RIGHTS_OF[kind])

    def hidden_words(self) -> set[str]:
        """The last parts of all names that the spy may not see."""
        hidden = {
            name
            for names in self.names.values()
            for name in names
            # The spy itself may use a name for another kind of thing.
            if not any(self.is_visible(kind, name) for kind in KINDS)
        }
        for node in self.used_by:
            # A node counts by what it still has: another may have taken over a service.
            present = self.rosapi.graph.nodes[node]
            topics = {*present.publishing(), *present.subscribing()} - {"/rosout"}
            uses = [("topic", each) for each in topics]
            uses += [("service", each) for each in present.providing()]
            if not any(self._is_use_visible(kind, name) for kind, name in uses):
                hidden.add(node)
        return {name.rpartition("/")[2] for name in hidden}

    def _is_use_visible(self, kind: str, name: str) -> bool:
        if name.endswith("/_action/cancel_goal"):
            return self.is_visible("action", name.removesuffix("/_action/cancel_goal"))
        return self.is_visible("topic" if kind == "topic" else "service", name)


def operations(world: World) -> Iterator[dict[str, Any]]:
    """Operations that use every name in every way, and every service of rosapi."""
    names = [name for names in world.names.values() for name in names] + ["/a", "/b/", "/", "/none"]
    names += world.used_by
    for name in names:
        yield {"op": "advertise", "topic": name, "type": "std_msgs/String", "peers": True}
        yield {"op": "advertise", "topic": name, "type": INT32, "peers": True}
        yield {"op": "publish", "topic": name, "msg": {"data": "x"}}
        yield {"op": "subscribe", "topic": name, "type": "std_msgs/String", "peers": True}
        yield {"op": "subscribe", "topic": name, "peers": True, "headers": True}
        yield {"op": "call_service", "service": name, "args": {"a": "x"}}
        yield {"op": "call_service", "service": name, "headers": {}, "timeout": 1e-3}
        yield {"op": "advertise_service", "service": name, "type": ADD}
        yield {"op": "advertise_action", "action": name, "type": FIBONACCI}
        yield {"op": "send_action_goal", "action": name, "action_type": ADD, "id": f"g{name}"}
        cancel = f"{name}/_action/cancel_goal"
        yield {"op": "call_service", "service": cancel, "args": {}}
    yield {"op": "advertise", "topic": "/rosout", "type": "rosgraph_msgs/Log", "peers": True}
    # A type of one's own that collides with those of others.
    shared = {"type": "own_msgs/Shared", "definition": "int32 other"}
    yield {"op": "advertise", "topic": "/a", **shared}
    for name in names:
        yield {"op": "advertise", "topic": name, **shared}
    for service, own in world.rosapi.graph.services.items():
        if not service.startswith("/rosapi/"):
            continue
        fields = [field.name for field in _request_fields(world, own.type.name)]
        if "logger" in fields:
            continue
        types = (INT32, ADD, "own_msgs/Shared", FIBONACCI)
        for text in (*names, *types) if fields else ("",):
            args = {field: "1" if field in ("value", "default") else text for field in fields}
            yield {"op": "call_service", "service": service, "args": args}


def _request_fields(world: World, type_: str) -> Any:
    return world.rosapi.graph.definitions.service(type_).request.fields


@pytest.mark.parametrize("seed", range(12))
def test_no_answer_holds_a_hidden_name(seed: int) -> None:
    world = World(random.Random(seed))
    hidden = world.hidden_words()
    assert hidden
    seen: set[str] = set()
    everything = list(operations(world))
    world.chance.shuffle(everything)
    for operation in everything:
        asked = json.dumps(operation)
        world.spy.send_text(asked)
        world.rosapi.hub.clock.advance(0.01)
        answer = b"".join(payload for _, payload in world.spy.receive_frames()).decode("latin-1")
        for word in hidden:
            assert word not in answer or word in asked, (operation, answer)
        hidden &= world.hidden_words()
        seen |= {
            name
            for names in world.names.values()
            for name in names
            if name in answer and name not in asked
        }
    assert seen  # The answers are not just empty.
