"""What tools make of a hub that answers as no hub does."""

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
from fibws.client.hub_client import Values
from fibws.client.rosapi_schemas import ANSWERS, LOG, MOST_SHOWN, Shape, fault
from fibws.errors import ServiceError
from fibws.interfaces import Interfaces

TYPES = {
    "/rosapi/graph": "fibws_msgs/GetGraph",
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
}
GOOD: dict[str, Any] = {"string": "x", "bool": True, "float64": 1.5, "int8": -1}
OTHERS: tuple[Any, ...] = (None, "x", True, [5], {"a": 5}, 10**400, -(10**400), 1e999)


def made(shape: Shape) -> Any:
    """What fits a shape."""
    if isinstance(shape, str):
        return GOOD.get(shape, 1)
    if isinstance(shape, list):
        return [made(shape[0]), made(shape[0])]
    return {name: made(each) for name, each in shape.items()}


def spoilt(good: Any) -> Iterator[Any]:
    """What fits in all places but for one, where there is something else, or nothing."""
    if not isinstance(good, dict | list):
        yield from (each for each in OTHERS if type(each) is not type(good) or each != good)
        return
    yield from (None, "x", 5, [5] if isinstance(good, dict) else {})
    for place, value in good.items() if isinstance(good, dict) else enumerate(good):
        for other in spoilt(value):
            changed = deepcopy(good)
            changed[place] = other
            yield changed
        if isinstance(good, dict):
            yield {name: each for name, each in good.items() if name != place}


@pytest.mark.parametrize("service", ANSWERS)
def test_whatever_is_wrong_with_an_answer_is_an_error_when_it_is_asked_for(service: str) -> None:
    for name, shape in ANSWERS[service].items():
        good = made(shape)
        assert Values(service, {name: good})[name] == good
        for wrong in spoilt(good):
            with pytest.raises(
                ServiceError, match=rf"^{service} returned .*{name}.*another kind of"
            ):
                Values(service, {name: wrong})[name]


def test_the_error_says_where_it_is() -> None:
    shape = ANSWERS["/rosapi/graph"]["nodes"]
    assert fault([made(shape)[0], {}], shape, "nodes") == "nodes[1] has no name"
    assert fault(5, shape, "nodes") == "nodes is 5, no list"
    assert fault([5], shape, "nodes") == "nodes[0] is 5, no object"
    wrong = {**made(shape)[0], "own": "\x1b" * 100}
    found = fault([wrong], shape, "nodes")
    assert found is not None and found.startswith(r"nodes[0].own is '\x1b\x1b")
    assert found.endswith("..., no bool") and len(found) < MOST_SHOWN + 40


def test_what_else_there_is_does_not_matter() -> None:
    assert fault({**made(LOG), "more": 5}, LOG, "message") is None
    assert Values("/somebodys", {"nodes": 5})["nodes"] == 5


def test_tools_expect_what_the_definitions_say() -> None:
    interfaces = Interfaces()

    def check(shape: Mapping[str, Shape], definition: Any) -> None:
        fields = {each.name: each for each in definition.fields}
        assert shape.keys() <= fields.keys()
        for name, each in shape.items():
            is_list = isinstance(each, list)
            of = each[0] if isinstance(each, list) else each
            assert is_list == (fields[name].array is not None)
            if fields[name].type == "time":
                assert of == {"secs": "uint32", "nsecs": "uint32"}
            elif isinstance(of, Mapping):
                check(of, interfaces.message(fields[name].type))
            else:
                assert of == {"byte": "int8"}.get(fields[name].type, fields[name].type)

    assert TYPES.keys() == ANSWERS.keys()
    for service, type_ in TYPES.items():
        check(ANSWERS[service], interfaces.service(type_).response)
    assert isinstance(LOG, Mapping)
    check(LOG, interfaces.message("rosgraph_msgs/Log"))


@contextmanager
def liar(answers: Mapping[str, Any], message: Any = None) -> Iterator[str]:
    """The address of what answers calls so, and subscriptions with one message."""

    def answer(connection: ServerConnection) -> None:
        for text in connection:
            said = json.loads(text)
            if said["op"] == "call_service":
                values = answers.get(said["service"], {})
                response = {"op": "service_response", "id": said["id"], "result": True}
                connection.send(json.dumps({**response, "values": values}))
            elif said["op"] == "subscribe":
                said = {"op": "publish", "topic": said["topic"], "msg": message}
                connection.send(json.dumps(said))

    with serve(answer, "127.0.0.1", 0) as server:
        thread = threading.Thread(target=server.serve_forever)
        thread.start()
        yield f"ws://127.0.0.1:{server.socket.getsockname()[1]}"
        server.shutdown()
        thread.join(60)


def run(hub: str, *words: str) -> Result:
    return CliRunner().invoke(command, [*words, "--hub", hub], prog_name="fibws")


GRAPH = ("/rosapi/graph", {**made(dict(ANSWERS["/rosapi/graph"])), "nodes": [{"name": 5}]})
STATISTICS = ("/rosapi/statistics", {"stamp": {"secs": "now", "nsecs": 0}})


@pytest.mark.parametrize(
    ("words", "answer", "wrong"),
    [
        (("graph",), GRAPH, "nodes[0].name is 5, no string"),
        (("graph", "--json"), GRAPH, "nodes[0].name is 5, no string"),
        (("node", "list"), GRAPH, "nodes[0].name is 5, no string"),
        (("topic", "list"), GRAPH, "nodes[0].name is 5, no string"),
        (("top", "-n", "1", "-d", "0.1"), STATISTICS, "stamp.secs is 'now', no uint32"),
        (("topic", "type", "/x"), ("/rosapi/topic_type", {"type": 5}), "type is 5, no string"),
        (("param", "list"), ("/rosapi/get_param_names", {"names": {}}), "names is {}, no list"),
        (("param", "get", "/x"), ("/rosapi/get_param", {"value": 5}), "value is 5, no string"),
        (("param", "get", "/x"), ("/rosapi/get_param", {"value": "{"}), "'{', which is no JSON"),
    ],
)
def test_a_tool_says_in_one_line_what_is_wrong(
    words: tuple[str, ...], answer: tuple[str, Any], wrong: str
) -> None:
    with liar(dict([answer])) as hub:
        result = run(hub, *words)
    assert isinstance(result.exception, SystemExit) and result.exit_code == 1, result.exception
    *_, line = result.output.splitlines()
    assert line.startswith("Error: /rosapi/") and wrong in line
    assert line.endswith(": this may be another kind of hub")


def test_doctor_has_it_among_its_findings() -> None:
    time = ("/rosapi/get_time", {"time": {"secs": 5, "nsecs": 0}})
    with liar(dict([GRAPH, time])) as hub:
        result = run(hub, "doctor")
    assert isinstance(result.exception, SystemExit) and result.exit_code == 1, result.exception
    assert "nodes[0].name is 5, no string" in result.output


def test_a_log_with_what_is_no_message_of_it_is_an_error_in_one_line() -> None:
    good = {**made(LOG), "level": 2}
    for message in spoilt(good):
        if isinstance(message, dict):
            with liar({}, message) as hub:
                result = run(hub, "log", "-n", "1")
            assert isinstance(result.exception, SystemExit) and result.exit_code == 1
            assert result.output.startswith("Error: /rosout_agg has what is no rosgraph_msgs/Log: ")
            assert len(result.output.splitlines()) == 1
    with liar({}, good) as hub:
        assert run(hub, "log", "-n", "1").exit_code == 0


def test_topics_without_types_have_none() -> None:
    with liar({"/rosapi/topics": {"topics": ["/x", "/y"], "types": ["a_msgs/X"]}}) as hub:
        result = run(hub, "topic", "type", "/x")
    assert isinstance(result.exception, SystemExit), result.exception
