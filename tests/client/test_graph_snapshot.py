"""The graph as a tool sees it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import pytest
from hub_in_thread import HubThread

from fibws.client.graph_snapshot import Snapshot, within
from fibws.client.hub_client import HubClient
from fibws.errors import UnknownName

OWN = ["/rosapi", "/rosbridge_websocket", "/rosout"]


def names(entries: Iterable[Mapping[str, object]]) -> list[object]:
    return [entry["name"] for entry in entries]


def names_of_nodes(parts: Iterable[Mapping[str, object]]) -> list[object]:
    return [part["node"] for part in parts]


def test_the_tool_itself_is_not_in_it(hub: HubThread, client: HubClient) -> None:
    client.send({"op": "advertise", "topic": "/x", "type": "std_msgs/Int32"})
    client.send({"op": "subscribe", "topic": "/x", "type": "std_msgs/Int32"})
    own = Snapshot(client)
    assert names(own.nodes) == OWN
    (topic,) = (topic for topic in own.topics if topic["name"] == "/x")
    assert topic["publishers"] == topic["subscriptions"] == []
    with HubClient("other", hub.url) as other:
        seen = Snapshot(other)
        assert client.node in names(seen.nodes)
        (topic,) = (topic for topic in seen.topics if topic["name"] == "/x")
        assert names_of_nodes(topic["publishers"]) == [client.node]
        assert names_of_nodes(topic["subscriptions"]) == [client.node]


def test_the_hubs_own_nodes_are_where_the_hub_is(hub: HubThread, client: HubClient) -> None:
    snapshot = Snapshot(client)
    assert snapshot.address("/rosapi") == f"127.0.0.1:{hub.port}"
    assert snapshot.address("/nobody") == "unknown address"


def test_a_namespace_is_no_mere_beginning() -> None:
    entries = [{"name": name} for name in ("/a", "/a/b", "/ab", "/c/a")]
    assert names(within("/a", entries)) == ["/a", "/a/b"]
    assert names(within("/", entries)) == names(entries)
    assert names(within(None, entries)) == names(entries)


def test_what_is_not_there_is_an_error_with_the_nearest_name(client: HubClient) -> None:
    with pytest.raises(UnknownName) as caught:
        Snapshot(client).node("/rosapy")
    assert str(caught.value) == "Unknown node /rosapy; did you mean /rosapi?"
