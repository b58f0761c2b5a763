"""The graph at one moment."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import pytest
from hub_in_thread import HubThread

from fibws.client.graph_snapshot import GraphSnapshot, in_namespace
from fibws.client.hub_client import HubClient
from fibws.errors import UnknownName

OWN = ["/rosapi", "/rosbridge_websocket", "/rosout"]


def names(entries: Iterable[Mapping[str, object]]) -> list[object]:
    return [entry["name"] for entry in entries]


def names_of_nodes(parts: Iterable[Mapping[str, object]]) -> list[object]:
    return [part["node"] for part in parts]


def test_snapshot_excludes_the_tool_itself(hub: HubThread, client: HubClient) -> None:
    client.send({"op": "advertise", "topic": "/x", "type": "std_msgs/Int32"})
    client.send({"op": "subscribe", "topic": "/x", "type": "std_msgs/Int32"})
    own = GraphSnapshot(client)
    assert names(own.nodes) == OWN
    (topic,) = (topic for topic in own.topics if topic["name"] == "/x")
    assert topic["publishers"] == topic["subscriptions"] == []
    with HubClient("other", hub.url) as other:
        seen = GraphSnapshot(other)
        assert client.node in names(seen.nodes)
        (topic,) = (topic for topic in seen.topics if topic["name"] == "/x")
        assert names_of_nodes(topic["publishers"]) == [client.node]
        assert names_of_nodes(topic["subscriptions"]) == [client.node]


def test_own_nodes_of_the_hub_have_its_address(hub: HubThread, client: HubClient) -> None:
    snapshot = GraphSnapshot(client)
    assert snapshot.address("/rosapi") == f"127.0.0.1:{hub.port}"
    assert snapshot.address("/nobody") == "unknown address"


def test_namespace_is_not_a_prefix_of_characters() -> None:
    entries = [{"name": name} for name in ("/a", "/a/b", "/ab", "/c/a")]
    assert names(in_namespace("/a", entries)) == ["/a", "/a/b"]
    assert names(in_namespace("/", entries)) == names(entries)
    assert names(in_namespace(None, entries)) == names(entries)


def test_unknown_name_suggests_a_similar_one(client: HubClient) -> None:
    with pytest.raises(UnknownName) as caught:
        GraphSnapshot(client).node("/rosapy")
    assert "/rosapy" in str(caught.value) and "/rosapi?" in str(caught.value)
