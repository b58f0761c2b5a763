"""Responses of other servers, which do not fit rosapi's schemas."""

from __future__ import annotations

import json
import threading
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from copy import deepcopy
from typing import Any

import pytest
from click.testing import CliRunner, Result
from websockets.sync.server import ServerConnection, serve

from fibws.cli.commands import command
from fibws.client.hub_client import Response
from fibws.client.rosapi_schemas import LOG, MAX_QUOTED, RESPONSES, Schema, schema_error
from fibws.errors import ServiceError
from fibws.interfaces import Interfaces

TYPES = {
    "/rosapi/graph": "fibws_msgs/GetGraph",
    "/rosapi/hubs": "fibws_msgs/GetHubs",
    "/rosapi/statistics": "fibws_msgs/GetStatistics",
    "/rosapi/topics": "rosapi/Topics",
    "/rosapi/topics_for_type": "rosapi/TopicsForType",
    "/rosapi/topic_type": "rosapi/TopicType",
    "/rosapi/service_type": "rosapi/ServiceType",
    "/rosapi/nodes": "rosapi/Nodes",
    "/rosapi/get_time": "rosapi/GetTime",
    "/rosapi/get_param": "rosapi/GetParam",
    "/rosapi/get_param_names": "rosapi/GetParamNames",
    "/rosapi/ping_node": "fibws_msgs/PingNode",
    "/rosapi/kill_node": "fibws_msgs/KillNode",
    "/rosapi/unregister_node": "fibws_msgs/UnregisterNode",
}
GOOD: dict[str, Any] = {"string": "x", "bool": True, "float64": 1.5, "int8": -1}
OTHERS: tuple[Any, ...] = (None, "x", True, [5], {"a": 5}, 10**400, -(10**400), 1e999)


def example(schema: Schema) -> Any:
    """Return a value that fits a schema."""
    if isinstance(schema, str):
        return GOOD.get(schema, 1)
    if isinstance(schema, list):
        return [example(schema[0]), example(schema[0])]
    return {name: example(each) for name, each in schema.items()}


def wrong_values(good: Any) -> Iterator[Any]:
    """Yield copies of a value with one place changed or removed."""
    if not isinstance(good, dict | list):
        yield from (each for each in OTHERS if type(each) is not type(good) or each != good)
        return
    yield from (None, "x", 5, [5] if isinstance(good, dict) else {})
    for place, value in good.items() if isinstance(good, dict) else enumerate(good):
        for other in wrong_values(value):
            changed = deepcopy(good)
            changed[place] = other
            yield changed
        if isinstance(good, dict):
            yield {name: each for name, each in good.items() if name != place}


@pytest.mark.parametrize("service", RESPONSES)
def test_reading_a_wrong_field_raises_a_service_error(service: str) -> None:
    for name, schema in RESPONSES[service].items():
        good = example(schema)
        assert Response(service, {name: good})[name] == good
        for wrong in wrong_values(good):
            with pytest.raises(
                ServiceError, match=rf"^{service} returned .*{name}.*another kind of"
            ):
                Response(service, {name: wrong})[name]


def test_error_names_the_place() -> None:
    schema = RESPONSES["/rosapi/graph"]["nodes"]
    assert schema_error([example(schema)[0], {}], schema, "nodes") == "nodes[1] has no name"
    assert schema_error(5, schema, "nodes") == "nodes is 5, expected a list"
    assert schema_error([5], schema, "nodes") == "nodes[0] is 5, expected an object"
    wrong = {**example(schema)[0], "own": "\x1b" * 100}
    found = schema_error([wrong], schema, "nodes")
    assert found is not None and found.startswith(r"nodes[0].own is '\x1b\x1b")
    assert found.endswith("..., expected bool") and len(found) < MAX_QUOTED + 40


def test_additional_fields_and_unknown_services_are_ignored() -> None:
    assert schema_error({**example(LOG), "more": 5}, LOG, "message") is None
    assert Response("/other", {"nodes": 5})["nodes"] == 5


def test_schemas_agree_with_the_definitions() -> None:
    interfaces = Interfaces()

    def check(schema: Mapping[str, Schema], definition: Any) -> None:
        fields = {each.name: each for each in definition.fields}
        assert schema.keys() <= fields.keys()
        for name, each in schema.items():
            is_list = isinstance(each, list)
            of = each[0] if isinstance(each, list) else each
            assert is_list == (fields[name].array is not None)
            if fields[name].type == "time":
                assert of == {"secs": "uint32", "nsecs": "uint32"}
            elif isinstance(of, Mapping):
                check(of, interfaces.message(fields[name].type))
            else:
                assert of == {"byte": "int8"}.get(fields[name].type, fields[name].type)

    assert TYPES.keys() == RESPONSES.keys()
    for service, type_ in TYPES.items():
        check(RESPONSES[service], interfaces.service(type_).response)
    assert isinstance(LOG, Mapping)
    check(LOG, interfaces.message("rosgraph_msgs/Log"))


@contextmanager
def other_server(responses: Mapping[str, Any], message: Any = None) -> Iterator[str]:
    """Run a server that answers calls with these values, and subscriptions with one message."""

    def answer(connection: ServerConnection) -> None:
        for text in connection:
            request = json.loads(text)
            if request["op"] == "call_service":
                values = responses.get(request["service"], {})
                response = {"op": "service_response", "id": request["id"], "result": True}
                connection.send(json.dumps({**response, "values": values}))
            elif request["op"] == "subscribe":
                publish = {"op": "publish", "topic": request["topic"], "msg": message}
                connection.send(json.dumps(publish))

    with serve(answer, "127.0.0.1", 0) as server:
        thread = threading.Thread(target=server.serve_forever)
        thread.start()
        yield f"ws://127.0.0.1:{server.socket.getsockname()[1]}"
        server.shutdown()
        thread.join(60)


def run(hub: str, *words: str) -> Result:
    return CliRunner().invoke(command, [*words, "--hub", hub], prog_name="fibws")


GRAPH = ("/rosapi/graph", {**example(dict(RESPONSES["/rosapi/graph"])), "nodes": [{"name": 5}]})
STATISTICS = ("/rosapi/statistics", {"stamp": {"secs": "now", "nsecs": 0}})


@pytest.mark.parametrize(
    ("words", "answer", "wrong"),
    [
        (("graph",), GRAPH, "nodes[0].name is 5, expected string"),
        (("graph", "--json"), GRAPH, "nodes[0].name is 5, expected string"),
        (("node", "list"), GRAPH, "nodes[0].name is 5, expected string"),
        (("topic", "list"), GRAPH, "nodes[0].name is 5, expected string"),
        (("top", "-n", "1", "-d", "0.1"), STATISTICS, "stamp.secs is 'now', expected uint32"),
        (
            ("topic", "type", "/x"),
            ("/rosapi/topic_type", {"type": 5}),
            "type is 5, expected string",
        ),
        (
            ("param", "list"),
            ("/rosapi/get_param_names", {"names": {}}),
            "names is {}, expected a list",
        ),
        (
            ("param", "get", "/x"),
            ("/rosapi/get_param", {"value": 5}),
            "value is 5, expected string",
        ),
        (
            ("param", "get", "/x"),
            ("/rosapi/get_param", {"value": "{"}),
            "'{', which is invalid JSON",
        ),
    ],
)
def test_wrong_response_is_an_error_in_one_line(
    words: tuple[str, ...], answer: tuple[str, Any], wrong: str
) -> None:
    with other_server(dict([answer])) as hub:
        result = run(hub, *words)
    assert isinstance(result.exception, SystemExit) and result.exit_code == 1, result.exception
    *_, line = result.output.splitlines()
    assert line.startswith("Error: /rosapi/") and wrong in line
    assert line.endswith(": this may be another kind of hub")


@pytest.mark.long
def test_doctor_reports_a_wrong_response() -> None:
    time = ("/rosapi/get_time", {"time": {"secs": 5, "nsecs": 0}})
    with other_server(dict([GRAPH, time])) as hub:
        result = run(hub, "doctor")
    assert isinstance(result.exception, SystemExit) and result.exit_code == 1, result.exception
    assert "nodes[0].name is 5, expected string" in result.output


@pytest.mark.long
def test_wrong_log_message_is_an_error_in_one_line() -> None:
    good = {**example(LOG), "level": 2}
    for message in wrong_values(good):
        if isinstance(message, dict):
            with other_server({}, message) as hub:
                result = run(hub, "log", "-n", "1")
            assert isinstance(result.exception, SystemExit) and result.exit_code == 1
            (line,) = result.output.splitlines()
            assert line.startswith("Error: ") and "/rosout_agg" in line and "message" in line
    with other_server({}, good) as hub:
        assert run(hub, "log", "-n", "1").exit_code == 0


def test_lists_of_different_lengths_are_an_error() -> None:
    with other_server({"/rosapi/topics": {"topics": ["/x", "/y"], "types": ["a_msgs/X"]}}) as hub:
        result = run(hub, "topic", "type", "/x")
    assert isinstance(result.exception, SystemExit), result.exception
