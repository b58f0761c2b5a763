"""The argument TOPIC of tools, at a real hub."""

from __future__ import annotations

import threading

import click
import pytest
from hub_in_thread import HubThread, Publish

from fibws.cli.topic.topic_argument import (
    FoundTopic,
    all_types,
    find_topic,
    global_name,
    wait_for_topic,
    with_type,
)
from fibws.client.hub_client import HubClient
from fibws.errors import InvalidName, ServiceError, UnknownField


@pytest.mark.parametrize(
    ("argument", "name"),
    [("/a/b", "/a/b"), ("a", "/a"), ("a/", "/a"), ("a/b[0]/c", "/a/b[0]/c"), ("/a[1:]", "/a[1:]")],
)
def test_argument_is_a_global_name(client: HubClient, argument: str, name: str) -> None:
    assert global_name(client, argument) == name


def test_invalid_name_is_refused(client: HubClient) -> None:
    with pytest.raises(InvalidName):
        global_name(client, "a b")


def test_longest_topic_with_the_field_is_found(client: HubClient, publish: Publish) -> None:
    publish("/a", "geometry_msgs/PoseStamped")
    publish("/a/pose", "std_msgs/Int32")
    found = find_topic(client, "/a/pose/position")
    assert found is not None
    assert (found.topic, str(found.path)) == ("/a", "pose/position")
    exact = find_topic(client, "/a/pose")
    assert exact is not None
    assert (exact.topic, exact.type, bool(exact.path)) == ("/a/pose", "std_msgs/Int32", False)


def test_unpublished_topic_is_not_found(client: HubClient, publish: Publish) -> None:
    publish("/a", "std_msgs/Int32")
    client.subscribe("/subscribed")
    assert find_topic(client, "/b") is None
    assert find_topic(client, "/subscribed") is None
    with pytest.raises(click.ClickException, match="b in std_msgs/Int32"):
        find_topic(client, "/a/b")


def test_another_type_may_lack_the_field(client: HubClient, publish: Publish) -> None:
    publish("/a", "std_msgs/Int32")
    found = find_topic(client, "/a/data")
    assert found is not None
    changed = with_type(client, found, "geometry_msgs/Point")
    assert (changed.type, changed.path, changed.field) == (
        "geometry_msgs/Point",
        found.path,
        found.field,
    )
    with pytest.raises(UnknownField, match="data in geometry_msgs/Point"):
        changed.path.pick({"x": 1.0, "y": 0.0, "z": 0.0}, changed.typedefs)


def test_topics_without_types_are_an_error(
    client: HubClient, monkeypatch: pytest.MonkeyPatch
) -> None:
    response = {"topics": ["/a", "/b"], "types": ["std_msgs/Int32"]}
    monkeypatch.setattr(client, "call", lambda service: response)
    with pytest.raises(ServiceError, match=r"2 .*1 "):
        all_types(client)


def test_waiting_ends_when_the_topic_is_published(
    hub: HubThread, client: HubClient, publish: Publish
) -> None:
    with HubClient("other", hub.url) as other:
        found: list[FoundTopic] = []
        waiting = threading.Thread(target=lambda: found.append(wait_for_topic(other, "/late/data")))
        waiting.start()
        while (
            other.node
            not in client.call("/rosapi/subscribers", {"topic": "/late/data"})["subscribers"]
        ):
            pass
        publish("/late", "std_msgs/Int32", {"data": 8})
        waiting.join(60)
        assert [(each.topic, str(each.path)) for each in found] == [("/late", "data")]
        assert next(other.messages("/late", 20)) == {"data": 8}
