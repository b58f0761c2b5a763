"""The hub's own topics and services have its own types, whatever the user's folders define."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from fibws.interfaces import Interfaces

from .rosapi_client import RosapiClient

CHANGED = {
    "std_msgs/msg/Int32.msg": "string data",
    "std_msgs/msg/Header.msg": "builtin_interfaces/Time stamp\nstring frame_id",
    "rosgraph_msgs/msg/Log.msg": "string line",
    "rosgraph_msgs/msg/Clock.msg": "builtin_interfaces/Time clock",
    "rosbridge_msgs/msg/ConnectedClients.msg": "int8 number",
    "rosapi/srv/Topics.srv": "---\nint8 number",
    "rosapi/srv/GetTime.srv": "int8 needed\n---\n",
    "roscpp/srv/GetLoggers.srv": "---\nint8 number",
    "action_msgs/srv/CancelGoal.srv": "---\nint8 number",
    "rcl_interfaces/msg/Log.msg": "builtin_interfaces/Time stamp\nuint8 level\nstring name",
}
FEW = {
    "rosgraph_msgs/msg/Clock.msg": "builtin_interfaces/Time clock",
    "rosapi/srv/Own.srv": "---",
    "rosbridge_msgs/msg/Own.msg": "",
    "std_msgs/msg/Own.msg": "",
    "roscpp/msg/Own.msg": "",
}
"""Packages without types that the hub needs."""


@pytest.fixture(params=[CHANGED, FEW], ids=["changed", "few"])
def rosapi(tmp_path: Path, request: pytest.FixtureRequest) -> RosapiClient:
    """A client of a hub with such definitions."""
    files: dict[str, str] = request.param
    for name, text in files.items():
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    return RosapiClient(interfaces=Interfaces([tmp_path]))


def latched(rosapi: RosapiClient, topic: str, **fields: Any) -> list[dict[str, Any]]:
    """Return the messages that a new subscriber gets."""
    client = rosapi.add_client(None)
    client.send("subscribe", topic, **fields)
    return client.receive_messages(topic)


@pytest.mark.parametrize("type_", [None, "rosgraph_msgs/Log"])
def test_log_has_the_types_of_ros1(rosapi: RosapiClient, type_: str | None) -> None:
    console, node = rosapi.add_client("/console"), rosapi.add_client("/node")
    console.send("subscribe", "/rosout", type=type_)
    console.send("subscribe", "/rosout_agg", type=type_)
    node.send("advertise", "/rosout", type="rosgraph_msgs/Log")
    node.send("publish", "/rosout", msg={"level": 2, "name": "/node", "msg": "ready"})
    received = console.receive()
    assert [each["topic"] for each in received] == ["/rosout_agg", "/rosout"]
    for each in received:
        assert (each["msg"]["msg"], each["msg"]["header"]["seq"]) == ("ready", 1)
    node.send("nonsense")
    assert {each["msg"]["level"] for each in console.receive()} == {4}


def test_clients_are_listed(rosapi: RosapiClient) -> None:
    rosapi.connect("/one")
    rosapi.hub.clock.advance(10)
    for type_ in (None, "rosbridge_msgs/ConnectedClients"):
        [message] = latched(rosapi, "/connected_clients", type=type_)
        assert message["clients"][0]["ip_address"] == "10.0.0.1"
    assert latched(rosapi, "/client_count", type="std_msgs/Int32") == [{"data": 1}]


def test_services_have_their_types(rosapi: RosapiClient) -> None:
    assert "/rosout" in rosapi.call("/rosapi/topics")["topics"]
    assert rosapi.call("/rosapi/get_time")["time"]["secs"]
    types = {
        name: service.type
        for name, service in rosapi.graph.services.items()
        if service.node in rosapi.graph.rights.internal
    }
    standard = Interfaces()
    assert {name: type_.md5sum for name, type_ in types.items()} == {
        name: standard.service_md5(type_.name) for name, type_ in types.items()
    }


def test_goals_are_cancelled_by_the_hubs_own_service(rosapi: RosapiClient) -> None:
    server = rosapi.add_client("/server")
    server.send("advertise_action", action="/fib", type="example_interfaces/Fibonacci")
    client = rosapi.add_client("/client")
    client.send("call_service", service="/fib/_action/cancel_goal", args={})
    assert client.receive_one("service_response")["values"]["return_code"] == 0


def test_simulated_time_is_that_of_clock(rosapi: RosapiClient) -> None:
    player = rosapi.add_client("/player")
    rosapi.call("/rosapi/set_param", name="/use_sim_time", value="true")
    player.send("advertise", "/clock", type="rosgraph_msgs/Clock")
    player.send("publish", "/clock", msg={"clock": {"secs": 5, "nsecs": 6}})
    assert rosapi.call("/rosapi/get_time")["time"] == {"secs": 5, "nsecs": 6}
