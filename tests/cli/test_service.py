"""``fibws service``."""

from __future__ import annotations

import asyncio
import json
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from math import inf, nan

import pytest
from hub_in_thread import HubThread, Run
from node_in_thread import Peer, peer

import fibws
from fibws.client.hub_client import HubClient
from fibws.errors import FibwsError
from fibws.srv.control_msgs import (
    QueryTrajectoryState,
    QueryTrajectoryStateRequest,
    QueryTrajectoryStateResponse,
)
from fibws.srv.rospy_tutorials import AddTwoInts, AddTwoIntsRequest, AddTwoIntsResponse
from fibws.srv.std_srvs import SetBool, SetBoolRequest, SetBoolResponse


async def serve(node: fibws.Node) -> None:
    """Serve a service that works, one that fails, and one that never responds."""

    def add(request: AddTwoIntsRequest) -> AddTwoIntsResponse:
        return AddTwoIntsResponse(request.a + request.b)

    def fail(request: SetBoolRequest) -> SetBoolResponse:
        raise FibwsError("the switch is stuck")

    async def hang(request: SetBoolRequest) -> SetBoolResponse:
        await asyncio.Event().wait()
        raise AssertionError

    def joints(request: QueryTrajectoryStateRequest) -> QueryTrajectoryStateResponse:
        return QueryTrajectoryStateResponse(position=[inf, -inf, nan])

    await node.service("/joints", QueryTrajectoryState, joints)
    await node.service("/math/add", AddTwoInts, add)
    await node.service("/fail", SetBool, fail)
    await node.service("/hang", SetBool, hang)


@pytest.fixture
def adder(hub: HubThread) -> Iterator[Peer]:
    with peer(hub.url, "adder", serve) as adder:
        yield adder


pytestmark = pytest.mark.usefixtures("adder")


def test_logger_services_are_listed_on_request(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    listed = run("service", "list").output.splitlines()
    assert "/math/add" in listed
    assert not [name for name in listed if name.endswith(("get_loggers", "set_logger_level"))]
    everything = run("service", "list", "-a").output.splitlines()
    assert {"/adder/get_loggers", "/adder/set_logger_level", *listed} <= {*everything}
    monkeypatch.setattr("fibws.command_names._called_alias", "rosservice")
    assert run("service", "list").output.splitlines() == everything


def test_list_prints_names(run: Run) -> None:
    found = run("service", "list").output.splitlines()
    assert found == sorted(found)
    assert {"/math/add", "/rosapi/nodes"} <= set(found)
    assert run("service", "list", "/math").output == "/math/add\n"
    assert run("service", "list", "-n", "/math").output == "/math/add /adder\n"
    assert json.loads(run("service", "list", "--json", "/math").output) == {
        "name": "/math/add",
        "type": "rospy_tutorials/AddTwoInts",
        "node": "/adder",
    }


def test_info_prints_as_rosservice(run: Run, client: HubClient) -> None:
    nodes = client.call("/rosapi/graph")["nodes"]
    address = next(each["address"] for each in nodes if each["name"] == "/adder")
    assert run("service", "info", "math/add").output.splitlines() == [
        "Node: /adder",
        f"Address: {address}",
        "Type: rospy_tutorials/AddTwoInts",
        "Args: a b",
    ]
    value = json.loads(run("service", "info", "math/add", "--json").output)
    assert (value["address"], value["args"]) == (address, ["a", "b"])


def test_type_node_and_find(run: Run) -> None:
    assert run("service", "type", "math/add").output == "rospy_tutorials/AddTwoInts\n"
    assert run("service", "node", "math/add").output == "/adder\n"
    assert run("service", "find", "rospy_tutorials/AddTwoInts").output == "/math/add\n"
    assert run("service", "find", "rospy_tutorials/srv/AddTwoInts", "--json").output == (
        '"/math/add"\n'
    )
    assert run("service", "find", "rospy_tutorials/AddTwo").output == ""


def test_args_include_nested_fields(run: Run, client: HubClient) -> None:
    type_ = "nav_msgs/GetPlan"
    client.send({"op": "advertise_service", "service": "/plan", "type": type_})
    client.call("/rosapi/get_time")
    args = run("service", "args", "plan").output.split()
    assert args[:4] == [
        "start.header.seq",
        "start.header.stamp",
        "start.header.frame_id",
        "start.pose.position.x",
    ]
    assert args[-1] == "tolerance"


@pytest.mark.parametrize("verb", ["info", "type", "node", "args"])
def test_unknown_service_is_an_error(run: Run, verb: str) -> None:
    result = run("service", verb, "math/ad")
    assert (result.exit_code, result.stdout) == (1, "")
    assert "/math/ad; did you mean /math/add?" in result.stderr


# call


@pytest.mark.parametrize(
    "words", [["1", "2"], ["{a: 1, b: 2}"], ["a: 1\nb: 2"], ["--", "5", "-2"], ["-2", "5"]]
)
def test_call_prints_the_response(run: Run, words: list[str]) -> None:
    result = run("service", "call", "math/add", *words)
    assert (result.exit_code, result.output) == (0, "sum: 3\n")


def test_call_can_print_the_request_too(run: Run) -> None:
    assert run("service", "call", "-v", "math/add", "1", "2").output == "a: 1\nb: 2\n---\nsum: 3\n"


def test_call_prints_json(run: Run) -> None:
    assert run("service", "call", "--json", "math/add", "1", "2").output == '{"sum":3}\n'


def test_call_prints_infinity_and_nan(run: Run) -> None:
    arguments = ["service", "call", "/joints", "0"]
    assert "position: [inf, -inf, nan]\n" in run(*arguments).output
    assert '"position":[1e999,-1e999,null]' in run(*arguments, "--json").output


def test_call_reads_arguments_from_a_pipe(run: Run) -> None:
    result = run("service", "call", "math/add", input="a: 1\nb: 2\n---\n[3, 4]\n")
    assert (result.exit_code, result.output) == (0, "sum: 3\nsum: 7\n")


def test_call_without_arguments_lists_them(run: Run) -> None:
    result = run("service", "call", "math/add", input="")
    assert result.exit_code == 2
    assert "Please specify service arguments: a b" in result.stderr


def test_service_without_fields_needs_no_arguments(run: Run) -> None:
    assert "  - /adder\n" in run("service", "call", "rosapi/nodes").output


@pytest.mark.parametrize(
    ("words", "code", "text"),
    [
        (["1"], 2, "Not enough arguments"),
        (["{c: 1}"], 2, "No field name [c]"),
        (["[1"], 2, "Invalid YAML"),
        (["x", "1"], 1, "requires an int64 for field a"),
        (["-x"], 2, "No such option"),
    ],
)
def test_wrong_arguments_are_errors(run: Run, words: list[str], code: int, text: str) -> None:
    result = run("service", "call", "math/add", *words)
    assert (result.exit_code, result.stdout) == (code, "")
    assert text in result.stderr


def test_failing_service_is_an_error_with_its_reason(run: Run) -> None:
    result = run("service", "call", "/fail", "true")
    assert (result.exit_code, result.stdout) == (1, "")
    assert "/fail" in result.stderr and "the switch is stuck" in result.stderr


def test_call_times_out(run: Run) -> None:
    result = run("service", "call", "--timeout", "0.05", "/hang", "true")
    assert (result.exit_code, result.stdout) == (1, "")
    assert result.stderr.startswith("Error: ")
    assert "/hang" in result.stderr


def test_unavailable_service_is_an_error(run: Run) -> None:
    result = run("service", "call", "/math/sub")
    assert result.exit_code == 1
    assert "[/math/sub] is not available; did you mean /math/add?" in result.stderr
    result = run("service", "call", "/qqq")
    assert "[/qqq] is not available" in result.stderr


def test_service_of_an_unknown_type_takes_an_object(run: Run, hub: HubThread) -> None:
    with HubClient("provider", hub.url) as provider:
        provider.send({"op": "advertise_service", "service": "/odd", "type": "odd_msgs/Odd"})
        provider.call("/rosapi/get_time")
        with ThreadPoolExecutor() as threads:
            result = threads.submit(run, "service", "call", "/odd", "{x: [1, 2]}")
            call = next(found for found in iter(provider.receive, None) if "service" in found)
            assert call["args"] == {"x": [1, 2]}
            provider.send(
                {
                    "op": "service_response",
                    "service": "/odd",
                    "id": call["id"],
                    "values": {"y": "z"},
                    "result": True,
                }
            )
            assert result.result().output == 'y: "z"\n'


def test_call_can_wait_for_the_service(run: Run, hub: HubThread, client: HubClient) -> None:
    async def provide(node: fibws.Node) -> None:
        await node.service("/late", AddTwoInts, lambda request: AddTwoIntsResponse(request.a))

    with ThreadPoolExecutor() as threads:
        result = threads.submit(run, "service", "call", "--wait", "/late", "4", "0")
        while not any("fibws_service" in name for name in client.call("/rosapi/nodes")["nodes"]):
            assert not result.done()
        with peer(hub.url, "late", provide):
            assert result.result(20).output == "sum: 4\n"
