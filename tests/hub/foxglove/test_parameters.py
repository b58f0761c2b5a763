"""Parameters: read, set, deleted and followed."""

from __future__ import annotations

from typing import Any

import pytest

from fibws.hub.foxglove.parameters import MOST_WATCHED

from .foxglove_client import FoxgloveClient, FoxgloveHub


def parameters(client: FoxgloveClient, id_: str | None = None) -> dict[str, Any]:
    """Return the parameters of the one answer that came, by name."""
    received = client.receive_one("parameterValues")
    assert received.get("id") == id_
    return {each.pop("name"): each for each in received["parameters"]}


VALUES: dict[str, tuple[Any, dict[str, Any]]] = {
    "/integer": (7, {"value": 7}),
    "/float": (7.0, {"value": 7.0, "type": "float64"}),
    "/text": ("a\n", {"value": "a\n"}),
    "/flag": (True, {"value": True}),
    "/bytes": (b"\0\xff", {"value": "AP8=", "type": "byte_array"}),
    "/floats": ([1.0, 2.5], {"value": [1.0, 2.5], "type": "float64_array"}),
    "/list": ([1, "a", [True]], {"value": [1, "a", [True]]}),
    "/empty": ([], {"value": []}),
}


def test_all_parameters_are_read_as_the_applications_do_it() -> None:
    hub = FoxgloveHub()
    for name, (value, _) in VALUES.items():
        hub.graph.parameters.set(name, value)
    client = hub.foxglove_client()
    client.send("getParameters", parameterNames=[], id="get-all-params")
    assert parameters(client, "get-all-params") == {
        name: expected for name, (_, expected) in VALUES.items()
    }


@pytest.mark.parametrize("name", VALUES)
def test_parameter_that_is_set_as_it_was_read_is_the_same(name: str) -> None:
    value, expected = VALUES[name]
    hub = FoxgloveHub()
    client = hub.foxglove_client()
    sent = {"name": name, **expected}
    if expected.get("type") == "float64":
        sent["value"] = 7  # As JavaScript writes it.
    client.send("setParameters", parameters=[sent], id="set")
    assert parameters(client, "set") == {name: expected}
    other = FoxgloveHub()
    other.graph.parameters.set(name, value)
    assert hub.graph.parameters.text(name) == other.graph.parameters.text(name)


def test_named_parameters_are_read_and_unknown_ones_left_out() -> None:
    hub = FoxgloveHub()
    hub.graph.parameters.set("/a", {"b": 1, "c": "x"})
    client = hub.foxglove_client()
    client.send("getParameters", parameterNames=["/a/b", "/nothing", "/a"])
    assert parameters(client) == {"/a/b": {"value": 1}, "/a": {"value": {"b": 1, "c": "x"}}}
    client.send("getParameters", parameterNames=["relative"], id="1")
    status, answer = client.receive()
    assert isinstance(status, dict)
    assert isinstance(answer, dict)
    assert "relative" in status["message"]
    assert answer == {"op": "parameterValues", "id": "1", "parameters": []}


def test_parameter_without_a_value_is_deleted() -> None:
    hub = FoxgloveHub()
    hub.graph.parameters.set("/a", 1)
    client = hub.foxglove_client()
    client.send("setParameters", parameters=[{"name": "/a"}, {"name": "/b"}])
    assert client.receive() == []
    assert not hub.graph.parameters.has("/a")
    client.send("setParameters", parameters=[{"name": "/a"}], id="1")
    assert parameters(client, "1") == {"/a": {}}


@pytest.mark.parametrize(
    "parameter",
    [
        {"name": "/a", "value": "x", "type": "float64"},
        {"name": "/a", "value": True, "type": "float64"},
        {"name": "/a", "value": 1, "type": "float64_array"},
        {"name": "/a", "value": ["x"], "type": "float64_array"},
        {"name": "/a", "value": "!", "type": "byte_array"},
        {"name": "/", "value": 1},
    ],
)
def test_invalid_value_is_an_error_and_others_are_set(parameter: dict[str, Any]) -> None:
    hub = FoxgloveHub()
    client = hub.foxglove_client()
    client.send("setParameters", parameters=[parameter, {"name": "/b", "value": 2}])
    [status] = client.receive_statuses()
    assert status.startswith("setParameters: ")
    assert hub.graph.parameters.names() == ["/b"]


def test_changes_are_followed_and_sent_together() -> None:
    hub = FoxgloveHub()
    values = hub.graph.parameters
    client = hub.foxglove_client()
    client.send("subscribeParameterUpdates", parameterNames=["/a", "/n/b", "/space"])
    client.receive()
    values.set("/a", 1)
    values.set("/a", 2)
    values.set("/unwatched", 1)
    values.set("/n/b/", "x")
    assert parameters(client) == {"/a": {"value": 2}, "/n/b": {"value": "x"}}
    values.delete("/n")
    values.set("/space/deep/c", 1)
    assert parameters(client) == {"/n/b": {}, "/space": {"value": {"deep": {"c": 1}}}}
    client.send("unsubscribeParameterUpdates", parameterNames=["/a"])
    values.set("/a", 3)
    assert client.receive() == []
    values.set("/", {"n": {"b": 5}})
    assert parameters(client) == {"/n/b": {"value": 5}, "/space": {}}
    client.send("unsubscribeParameterUpdates", parameterNames=[])
    values.set("/n/b", 6)
    assert client.receive() == []


def test_client_that_does_not_read_is_sent_the_last_values() -> None:
    hub = FoxgloveHub()
    client = hub.foxglove_client()
    client.send("subscribeParameterUpdates", parameterNames=["/a"])
    client.pause()
    for value in range(100):
        hub.graph.parameters.set("/a", value)
        hub.clock.advance(0)
    client.queue.resume()
    assert parameters(client) == {"/a": {"value": 99}}


def test_long_values_are_sent_in_several_pieces() -> None:
    hub = FoxgloveHub()
    client = hub.foxglove_client()
    names = [f"/text{number}" for number in range(4)]
    client.send("subscribeParameterUpdates", parameterNames=names)
    client.receive()
    for name in names:
        hub.graph.parameters.set(name, "x" * 600_000)
    updates = [each for each in client.receive() if isinstance(each, dict)]
    assert [len(each["parameters"]) for each in updates] == [2, 2]


def test_too_many_names_are_refused() -> None:
    hub = FoxgloveHub()
    client = hub.foxglove_client()
    names = [f"/a{number}" for number in range(MOST_WATCHED + 1)]
    client.send("subscribeParameterUpdates", parameterNames=names)
    [status] = client.receive_statuses()
    assert str(MOST_WATCHED) in status
    client.send("subscribeParameterUpdates", parameterNames=["bad"])
    [status] = client.receive_statuses()
    assert "bad" in status


def test_answer_is_bounded_although_namespaces_repeat_their_values() -> None:
    hub = FoxgloveHub()
    value: Any = "x" * 100_000
    for _ in range(50):
        value = {"a": value}
    hub.graph.parameters.set("/", value)
    client = hub.foxglove_client()
    names = ["/" + "a/" * depth for depth in range(50)]
    hub.graph.parameters.max_bytes = 500_000
    client.send("getParameters", parameterNames=names * 20)
    status, answer = client.receive()
    assert isinstance(status, dict)
    assert "too many values" in status["message"]
    assert isinstance(answer, dict)
    assert 10 <= len(answer["parameters"]) < 15
    parameters_ = [{"name": name, "value": 1, "type": "float64_array"} for name in names * 20]
    client.send("setParameters", parameters=parameters_, id="x")
    *_, answer = client.receive()
    assert isinstance(answer, dict)
    assert len(answer["parameters"]) < 15


def test_spellings_of_one_name_are_one_name() -> None:
    hub = FoxgloveHub()
    hub.graph.parameters.set("/space", {"a": 1})
    client = hub.foxglove_client()
    spellings = ["/space", "//space", "/space/", "space", "space"]
    client.send("getParameters", parameterNames=spellings, id="1")
    status, answer = client.receive()
    assert isinstance(status, dict)
    assert isinstance(answer, dict)
    assert "space" in status["message"]
    assert answer["parameters"] == [{"name": "/space", "value": {"a": 1}}]
