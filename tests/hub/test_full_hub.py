"""On a hub with many topics, parameters and services no operation keeps others waiting.

Neither for one without rights, who is shown nothing of it, nor for one with all.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any, get_args

import pytest

from fibws.access.rights import Principal, Rights
from fibws.hub.access.policy import AccessPolicy
from fibws.hub.graph.policy import Policy
from fibws.hub.log.audit import Audit
from fibws.hub.rosapi.nodes import OwnNodes
from fibws.protocol.decoding import REQUESTS
from fibws.protocol.operations import Request

from .fakes import ADD, INT32
from .foxglove.foxglove_client import FoxgloveHub
from .test_long_lists import LISTS, Reading, operations

FIELDS = {
    model.model_fields["op"].default: model.model_fields.keys() for model in get_args(Request)
}
TOPICS, PARAMETERS, SERVICES = 1000, 1000, 100
FEW = 20
MOST_WORK = 100_000
"""Calls of functions between two looks at the clock: some 20 ms, where 100 would be too many."""
MOST_WORK_FOR_ONE = 5_000
ANYTHING = Rights(
    {
        right: ["/**"]
        for right in (
            *("publish", "subscribe", "call", "provide"),
            *("param_read", "param_write"),
        )
    }
)
SIZE = 2**18
"""Bytes of a value; a text may be 64 times as long, so that its work may be 64 times as much."""
LARGEST: dict[str, Any] = {
    "a long text": "a" * SIZE,
    "a name of many parts": "/a" * (SIZE // 2),
    "a list": [0] * (SIZE // 3),
    "an object": {f"{each:05x}": 0 for each in range(SIZE // 11)},
    "deep": json.loads("[" * 100 + "]" * 100),
}
RIGHTS = {"open": None, "no rights": Rights(), "all rights": ANYTHING}


class FullHub(FoxgloveHub):
    """A hub with a robot that has much, and a stranger who has the given rights; None if open."""

    def __init__(self, rights: Rights | None) -> None:
        policy: Policy | None = None if rights is None else AccessPolicy()
        super().__init__(policy=policy, max_parameter_bytes=2**24)
        OwnNodes(
            self.graph,
            self.clock,
            Audit(self.clock.time),
            host="localhost",
            port=9090,
            address="127.0.0.1",
            run_id="run",
            hubs=lambda caller: {},
        )
        self.stranger = None if rights is None else Principal("stranger", rights)
        robot = self.client("/robot", principal=Principal("robot", ANYTHING))
        for each in range(TOPICS):
            robot.send("advertise", f"/robot/topic_{each}", type=INT32)
        for each in range(SERVICES):
            robot.send("advertise_service", service=f"/robot/service_{each}", type=ADD)
        for each in range(PARAMETERS):
            self.graph.parameters.set(f"/robot/param_{each}", each)


def rosapi_services() -> list[str]:
    services = FullHub(None).graph.services
    return sorted(name for name in services if name.startswith("/rosapi/"))


@pytest.fixture(scope="module", params=RIGHTS)
def hub(request: pytest.FixtureRequest) -> FullHub:
    """A hub for all tests, since it takes long to fill; each has a client of its own."""
    return FullHub(RIGHTS[request.param])


def in_robot(text: bytes) -> bytes:
    """Return a text that means what the robot has, in place of names of its own."""
    replaced = text.replace(b"/name_", b"/robot/topic_").replace(b"/space/name_", b"/robot/param_")
    return replaced.replace(b"/nothing", b"/robot/service_0")


def work_of(reading: Reading, text: bytes) -> int:
    """Return the most work between two looks at the clock while a text is handled."""
    reading.receive(text)
    return reading.clock.longest


@pytest.mark.parametrize("op", REQUESTS)
def test_operations_of_rosbridge(hub: FullHub, op: str) -> None:
    client = hub.client(principal=hub.stranger)
    assert work_of(Reading(client.session), in_robot(operations(op, FEW))) < MOST_WORK
    client.disconnect()


@pytest.mark.long
@pytest.mark.parametrize("op", REQUESTS)
def test_items_of_the_largest_size(hub: FullHub, op: str) -> None:
    """One operation with a large value in a field: what it takes does not grow with the value."""
    longest = {}
    fields = json.loads(operations(op, 1))
    for name in FIELDS[op] - {"op"}:
        for what, value in LARGEST.items():
            client = hub.client(principal=hub.stranger)
            text = json.dumps({**fields, name: value}).encode()
            longest[name, what] = work_of(Reading(client.session), text)
            client.disconnect()
    assert max(longest.values()) < MOST_WORK_FOR_ONE, longest


@pytest.mark.long
def test_calls_of_rosapi(hub: FullHub) -> None:
    """Each service, by many calls in one text, all of which are answered."""
    client = hub.client(principal=hub.stranger)
    reading = Reading(client.session)
    longest = {}
    for service in rosapi_services():
        arguments: dict[str, Any] = {"name": "/robot", "topic": "/robot/topic_0", "node": "/robot"}
        type_ = hub.graph.services[service].type.arguments
        fields = {key: value for key, value in arguments.items() if key in str(type_)}
        call = {"op": "call_service", "service": service, "args": fields}
        text = "".join(json.dumps({**call, "id": f"{each}"}) for each in range(FEW))
        reading.clock.longest = 0
        longest[service] = work_of(reading, text.encode())
        answers = [each["id"] for each in client.receive() if each["op"] == "service_response"]
        assert answers == [f"{each}" for each in range(FEW)], service
    assert max(longest.values()) < MOST_WORK, longest


def lists() -> Iterator[tuple[str, dict[str, Any]]]:
    for op, make in LISTS.items():
        yield op, make(FEW)
        for key, items in make(FEW).items():
            if items and key in ("parameterNames", "parameters"):  # The whole namespace.
                item: Any = "/robot" if key == "parameterNames" else {"name": "/robot", "value": 1}
                yield op, {**make(1), key: [item]}


@pytest.mark.parametrize(("op", "fields"), [*lists()])
def test_lists_of_foxglove(hub: FullHub, op: str, fields: dict[str, Any]) -> None:
    client = hub.foxglove_client(principal=hub.stranger)
    text = json.dumps({"op": op, **fields}).encode()
    assert work_of(Reading(client.session), in_robot(text)) < MOST_WORK
