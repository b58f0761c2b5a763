"""The services of a node: registration and calls, without a socket."""

from __future__ import annotations

from typing import Any

import pytest

from fibws.errors import AlreadyOffered, NodeClosed, OperationRejected
from fibws.node.services import NodeServices
from fibws.node.types import NodeTypes
from fibws.srv.std_srvs import Trigger, TriggerRequest

from .conftest import FakeSession, Lines, deliver, next_operation, reconnected, sent_operations


@pytest.fixture
def services(session: FakeSession, types: NodeTypes) -> NodeServices:
    return NodeServices(session, types)


def done(request: TriggerRequest) -> tuple[bool, str]:
    return True, "done"


def names(operations: list[dict[str, Any]]) -> list[tuple[str, str]]:
    return [(each["op"], each["service"]) for each in operations]


async def test_services_are_advertised_and_unadvertised(
    session: FakeSession, services: NodeServices
) -> None:
    server = services.serve("/go", Trigger, done)
    assert (server.name, server.type) == ("/go", "std_srvs/Trigger")
    assert repr(server) == "<ServiceServer /go [std_srvs/Trigger]>"
    for _ in range(2):
        server.close()
    advertised, unadvertised = sent_operations(session)
    assert advertised == {
        "op": "advertise_service",
        "id": server._operation.id,
        "service": "/go",
        "type": "std_srvs/Trigger",
    }
    assert unadvertised["op"] == "unadvertise_service"
    assert unadvertised["service"] == "/go"


async def test_remaining_services_are_advertised_on_a_new_connection(
    session: FakeSession, services: NodeServices
) -> None:
    session.on_disconnect()
    services.serve("/stay", Trigger, done)
    services.serve("/go", Trigger, done).close()
    assert sent_operations(session) == []
    assert names(reconnected(session)) == [("advertise_service", "/stay")]


async def test_second_server_of_a_service_is_refused(
    session: FakeSession, services: NodeServices
) -> None:
    server = services.serve("/go", Trigger, done)
    with pytest.raises(AlreadyOffered, match="/go"):
        services.serve("/go", Trigger, done)
    server.close()
    services.serve("/go", Trigger, done)


async def test_handler_must_be_callable(services: NodeServices) -> None:
    with pytest.raises(TypeError, match="a service's handler must be a function, got None"):
        services.serve("/go", Trigger, None)  # type: ignore[arg-type]


async def test_calls_reach_their_services(session: FakeSession, services: NodeServices) -> None:
    services.serve("/yes", Trigger, done)
    services.serve("/no", Trigger, lambda request: (False, "not done"))
    sent_operations(session)
    for name in ("/yes", "/no"):
        deliver(session, "call_service", id=f"to {name}", service=name, args={})
    answers = [await next_operation(session), await next_operation(session)]
    assert [(each["id"], each["values"]["success"]) for each in answers] == [
        ("to /yes", True),
        ("to /no", False),
    ]


async def test_late_call_is_answered_with_an_error(
    session: FakeSession, services: NodeServices
) -> None:
    services.serve("/go", Trigger, done).close()
    sent_operations(session)
    deliver(session, "call_service", id="late", service="/go", args={})
    assert sent_operations(session) == [
        {
            "op": "service_response",
            "id": "late",
            "service": "/go",
            "values": "service [/go] was withdrawn",
            "result": False,
        }
    ]


async def test_refusal_is_raised_and_logged(
    session: FakeSession, services: NodeServices, lines: Lines
) -> None:
    refused = services.serve("/go", Trigger, done)
    other = services.serve("/stay", Trigger, done)
    deliver(session, "status", level="error", id=refused._operation.id, msg="no room")
    with pytest.raises(OperationRejected, match="no room"):
        await refused.spin()
    assert lines.seen() == ["The hub refused the service /go: no room"]
    sent_operations(session)
    refused.close()
    assert sent_operations(session) == []
    assert reconnected(session)[0]["id"] == other._operation.id


async def test_service_after_the_end_of_the_node_is_refused(
    session: FakeSession, services: NodeServices
) -> None:
    server = services.serve("/go", Trigger, done)
    session.end()
    await server.spin()
    with pytest.raises(NodeClosed):
        services.serve("/stay", Trigger, done)


async def test_handler_may_receive_the_callers_header(
    session: FakeSession, services: NodeServices
) -> None:
    headers = []

    def note(request: TriggerRequest, header: dict[str, str]) -> tuple[bool, str]:
        headers.append(header)
        return True, ""

    services.serve("/go", Trigger, note, headers=True)
    [advertised] = sent_operations(session)
    assert advertised["headers"] is True
    for id_, header in (("1", {"callerid": "/caller", "user": "ann"}), ("2", None)):
        deliver(session, "call_service", id=id_, service="/go", args={}, header=header)
        assert (await next_operation(session))["result"]
    assert headers == [{"callerid": "/caller", "user": "ann"}, {}]
