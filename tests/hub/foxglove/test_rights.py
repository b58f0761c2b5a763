"""What a client may not do it cannot do, and what it may not see is nowhere."""

from __future__ import annotations

import json
import random
import struct
from typing import Any

import pytest

from fibws.access.rights import RIGHTS, Principal, Right, Rights
from fibws.hub.access.policy import AccessPolicy
from fibws.hub.graph.policy import RIGHTS_OF, Kind

from ..fakes import ADD, INT32, finish, number
from .foxglove_client import FoxgloveClient, FoxgloveHub

ADMIN = Principal("admin", Rights(admin=True))


def hub_with(**allow: list[str]) -> tuple[FoxgloveHub, Any, FoxgloveClient]:
    """Return a hub, an admin's client, and one of Foxglove's with some rights."""
    hub = FoxgloveHub(policy=AccessPolicy())
    rights: dict[Right, list[str]] = {right: allow.get(right, []) for right in RIGHTS}
    admin = hub.client("/admin", principal=ADMIN)
    admin.send("advertise", "/open", type=INT32)
    admin.send("advertise", "/secret", type=INT32)
    admin.send("advertise_service", service="/open_service", type=ADD)
    admin.send("advertise_service", service="/secret_service", type=ADD)
    hub.graph.set_parameter("/admin", "/open", 1)
    hub.graph.set_parameter("/admin", "/secret", 2)
    client = hub.foxglove_client(None, principal=Principal("guest", Rights(rights)))
    client.receive()
    return hub, admin, client


def test_only_topics_that_may_be_subscribed_to_are_channels() -> None:
    hub, _, client = hub_with(subscribe=["/open"], publish=["/secret"])
    assert set(client.channels) == {"/open"}
    secret = hub.graph.topics["/secret"].number
    client.send("subscribe", subscriptions=[{"id": 1, "channelId": secret}])
    assert client.receive_statuses() == [f"subscribe: Unknown channel ID: {secret}"]


def test_publishing_needs_the_right() -> None:
    _, _, client = hub_with(publish=["/mine"])
    client.advertise("/mine", INT32, 1)
    client.advertise("/open", INT32, 2)
    [status] = client.receive_statuses()
    assert "/open" in status
    assert client.session.publishing() == {"/mine"}


def test_calls_need_the_right() -> None:
    _, admin, client = hub_with(call=["/open_service"])
    assert set(client.services) == {"/open_service"}
    client.call(client.services["/open_service"]["id"], bytes(16))
    assert admin.receive_one("call_service")["service"] == "/open_service"


def test_parameters_need_the_rights() -> None:
    hub, _, client = hub_with(param_read=["/open"], param_write=["/mine"])
    client.send("getParameters", parameterNames=[], id="1")
    assert [each["name"] for each in client.receive_one("parameterValues")["parameters"]] == [
        "/open"
    ]
    client.send("getParameters", parameterNames=["/secret", "/unset"])
    first, second, answer = client.receive()
    assert isinstance(first, dict)
    assert isinstance(second, dict)
    assert isinstance(answer, dict)
    assert first["message"].replace("/secret", "/unset") == second["message"]
    assert answer["parameters"] == []
    changes = [{"name": "/mine", "value": 1}, {"name": "/secret", "value": 1}, {"name": "/open"}]
    client.send("setParameters", parameters=changes, id="2")
    *statuses, answer = client.receive()
    assert len(statuses) == 2
    assert isinstance(answer, dict)
    assert answer["parameters"] == [{"name": "/open", "value": 1}]
    assert hub.graph.parameters.get("/") == {"open": 1, "secret": 2, "mine": 1}
    client.send("subscribeParameterUpdates", parameterNames=["/open", "/secret", "/"])
    hub.graph.set_parameter("/admin", "/secret", 3)
    hub.graph.set_parameter("/admin", "/open", 3)
    update = client.receive_one("parameterValues")
    assert {"name": "/open", "value": 3} in update["parameters"]
    assert "secret" not in json.dumps(update)


def test_rights_that_are_lost_take_everything_with_them() -> None:
    _, admin, client = hub_with(subscribe=["/**"], publish=["/**"], call=["/**"])
    client.subscribe("/open", 1)
    client.subscribe("/secret", 2)
    client.advertise("/mine", INT32)
    client.send("subscribeConnectionGraph")
    client.receive()
    fewer = Rights({"subscribe": ["/open"], "call": ["/open_service"]})
    finish(client.session.authorize(Principal("guest", fewer)))
    received = client.receive()
    statuses = [each for each in received if isinstance(each, dict) and each["op"] == "status"]
    assert len(statuses) == 2
    assert set(client.channels) == {"/open"}
    assert set(client.services) == {"/open_service"}
    assert client.session.subscribing() == {"/open"}
    assert client.session.publishing() == set()
    [update] = [each for each in received if isinstance(each, dict) and "removedTopics" in each]
    assert {"/secret", "/mine"} == set(update["removedTopics"])
    assert update["removedServices"] == ["/secret_service"]
    admin.send("publish", "/secret", msg=number(1))
    admin.send("publish", "/open", msg=number(2))
    assert [data for *_, data in client.receive_messages()] == [struct.pack("<i", 2)]
    finish(client.session.authorize(Principal("guest", Rights({"subscribe": ["/**"]}))))
    client.receive()
    assert set(client.channels) == {"/open", "/secret"}


@pytest.mark.parametrize("seed", range(4))
def test_hidden_names_are_in_nothing_that_is_sent(seed: int) -> None:
    chance = random.Random(seed)
    hub = FoxgloveHub(policy=AccessPolicy())
    names: dict[Kind, list[str]] = {
        kind: [f"/a/{kind}{chance.getrandbits(40):010x}" for _ in range(12)]
        for kind in ("topic", "service", "parameter")
    }
    allow: dict[Right, list[str]] = {right: [] for right in RIGHTS}
    for kind, of_kind in names.items():
        for name in of_kind:
            for right in RIGHTS_OF[kind]:
                if chance.random() < 0.25:
                    allow[right].append(name)
    spy = hub.foxglove_client(
        "/spy", principal=Principal("spy", Rights({**allow, "node": ["/spy"]}))
    )
    spy.send("subscribeConnectionGraph")
    everything = [name for of_kind in names.values() for name in of_kind]
    spy.send("subscribeParameterUpdates", parameterNames=everything)
    sent = bytearray()

    def flush() -> None:
        for _ in range(3):
            hub.clock.advance(0)
            hub.clock.turn()
        sent.extend(b"".join(spy.writes))
        spy.writes.clear()

    for number_ in range(4):
        admin = hub.client(f"/admin{number_}", principal=ADMIN)
        for name in chance.sample(names["topic"], 6):
            admin.send("advertise", name, type=chance.choice((INT32, "my_msgs/Unknown")))
            admin.send("subscribe", chance.choice(names["topic"]))
        for name in chance.sample(names["service"], 6):
            admin.send("advertise_service", service=name, type=ADD)
        for name in names["parameter"]:
            hub.graph.set_parameter(f"/admin{number_}", name, number_)
        flush()
        spy.send("getParameters", parameterNames=[])
        flush()
        if chance.random() < 0.5:
            admin.disconnect()
        flush()
    for kind, of_kind in names.items():
        for name in of_kind:
            is_visible = any(name in allow[right] for right in RIGHTS_OF[kind])
            assert is_visible or name.encode() not in sent, name
    assert any(name.encode() in sent for name in everything)


def test_call_ends_with_the_right_to_it() -> None:
    _, admin, client = hub_with(call=["/open_service"])
    client.call(client.services["/open_service"]["id"], bytes(16))
    call = admin.receive_one("call_service")
    finish(client.session.authorize(Principal("guest", Rights())))
    failure, *_ = client.receive()
    assert isinstance(failure, dict)
    assert failure["op"] == "serviceCallFailure"
    assert "missing right call for /open_service" in failure["message"]
    values = {"sum": 1}
    admin.send(
        "service_response", service="/open_service", id=call["id"], values=values, result=True
    )
    assert client.receive() == []
