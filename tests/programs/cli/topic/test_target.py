"""What an argument TOPIC names, asked of a real hub."""

from __future__ import annotations

import threading

import click
import pytest

from fibws.cli.link import Link
from fibws.cli.topic import target
from fibws.errors import InvalidName, ServiceError

from ..conftest import HubThread, Publish


@pytest.mark.parametrize(
    ("argument", "name"),
    [("/a/b", "/a/b"), ("a", "/a"), ("a/", "/a"), ("a/b[0]/c", "/a/b[0]/c"), ("/a[1:]", "/a[1:]")],
)
def test_an_argument_is_a_global_name(link: Link, argument: str, name: str) -> None:
    assert target.global_name(link, argument) == name


def test_what_is_no_name_is_refused(link: Link) -> None:
    with pytest.raises(InvalidName):
        target.global_name(link, "a b")


def test_the_longest_topic_that_has_the_field_is_meant(link: Link, publish: Publish) -> None:
    publish("/a", "geometry_msgs/PoseStamped")
    publish("/a/pose", "std_msgs/Int32")
    found = target.find(link, "/a/pose/position")
    assert found is not None
    assert (found.topic, str(found.path)) == ("/a", "pose/position")
    exact = target.find(link, "/a/pose")
    assert exact is not None
    assert (exact.topic, exact.type, bool(exact.path)) == ("/a/pose", "std_msgs/Int32", False)


def test_what_nobody_publishes_is_not_found(link: Link, publish: Publish) -> None:
    publish("/a", "std_msgs/Int32")
    link.subscribe("/heard")
    assert target.find(link, "/b") is None
    assert target.find(link, "/heard") is None
    with pytest.raises(click.ClickException, match="no field named b in std_msgs/Int32"):
        target.find(link, "/a/b")


def test_another_type_is_known_though_it_has_no_such_field(link: Link, publish: Publish) -> None:
    publish("/a", "std_msgs/Int32")
    found = target.find(link, "/a/data")
    assert found is not None
    changed = target.retarget(link, found, "geometry_msgs/Point")
    assert (changed.type, changed.path, changed.field) == (
        "geometry_msgs/Point",
        found.path,
        found.field,
    )
    with pytest.raises(LookupError, match="no field named data in geometry_msgs/Point"):
        changed.path.pick({"x": 1.0, "y": 0.0, "z": 0.0}, changed.typedefs)


def test_topics_without_their_types_are_another_hub_s(
    link: Link, monkeypatch: pytest.MonkeyPatch
) -> None:
    told = {"topics": ["/a", "/b"], "types": ["std_msgs/Int32"]}
    monkeypatch.setattr(link, "call", lambda service: told)
    with pytest.raises(ServiceError, match="2 topics, but 1 types"):
        target.all_types(link)


def test_a_topic_is_waited_for(hub: HubThread, link: Link, publish: Publish) -> None:
    with Link("other", hub.url) as other:
        found: list[target.Target] = []
        waiting = threading.Thread(target=lambda: found.append(target.wait(other, "/late/data")))
        waiting.start()
        while (
            other.node
            not in link.call("/rosapi/subscribers", {"topic": "/late/data"})["subscribers"]
        ):
            pass
        publish("/late", "std_msgs/Int32", {"data": 8})
        waiting.join(60)
        assert [(each.topic, str(each.path)) for each in found] == [("/late", "data")]
        assert next(other.messages("/late", 20)) == {"data": 8}
