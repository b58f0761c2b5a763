"""What an argument TOPIC names, asked of a real hub."""

from __future__ import annotations

import threading

import click
import pytest
from hub_in_thread import HubThread, Publish

from fibws.cli.topic import target
from fibws.client.hub_client import HubClient
from fibws.errors import InvalidName, ServiceError


@pytest.mark.parametrize(
    ("argument", "name"),
    [("/a/b", "/a/b"), ("a", "/a"), ("a/", "/a"), ("a/b[0]/c", "/a/b[0]/c"), ("/a[1:]", "/a[1:]")],
)
def test_an_argument_is_a_global_name(client: HubClient, argument: str, name: str) -> None:
    assert target.global_name(client, argument) == name


def test_what_is_no_name_is_refused(client: HubClient) -> None:
    with pytest.raises(InvalidName):
        target.global_name(client, "a b")


def test_the_longest_topic_that_has_the_field_is_meant(client: HubClient, publish: Publish) -> None:
    publish("/a", "geometry_msgs/PoseStamped")
    publish("/a/pose", "std_msgs/Int32")
    found = target.find(client, "/a/pose/position")
    assert found is not None
    assert (found.topic, str(found.path)) == ("/a", "pose/position")
    exact = target.find(client, "/a/pose")
    assert exact is not None
    assert (exact.topic, exact.type, bool(exact.path)) == ("/a/pose", "std_msgs/Int32", False)


def test_what_nobody_publishes_is_not_found(client: HubClient, publish: Publish) -> None:
    publish("/a", "std_msgs/Int32")
    client.subscribe("/heard")
    assert target.find(client, "/b") is None
    assert target.find(client, "/heard") is None
    with pytest.raises(click.ClickException, match="no field named b in std_msgs/Int32"):
        target.find(client, "/a/b")


def test_another_type_is_known_though_it_has_no_such_field(
    client: HubClient, publish: Publish
) -> None:
    publish("/a", "std_msgs/Int32")
    found = target.find(client, "/a/data")
    assert found is not None
    changed = target.retarget(client, found, "geometry_msgs/Point")
    assert (changed.type, changed.path, changed.field) == (
        "geometry_msgs/Point",
        found.path,
        found.field,
    )
    with pytest.raises(LookupError, match="no field named data in geometry_msgs/Point"):
        changed.path.pick({"x": 1.0, "y": 0.0, "z": 0.0}, changed.typedefs)


def test_topics_without_their_types_are_another_hub_s(
    client: HubClient, monkeypatch: pytest.MonkeyPatch
) -> None:
    told = {"topics": ["/a", "/b"], "types": ["std_msgs/Int32"]}
    monkeypatch.setattr(client, "call", lambda service: told)
    with pytest.raises(ServiceError, match="2 topics, but 1 types"):
        target.all_types(client)


def test_a_topic_is_waited_for(hub: HubThread, client: HubClient, publish: Publish) -> None:
    with HubClient("other", hub.url) as other:
        found: list[target.Target] = []
        waiting = threading.Thread(target=lambda: found.append(target.wait(other, "/late/data")))
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
