"""Sinks: any object that subscribes to a topic is a subscriber like all others."""

from __future__ import annotations

from struct import pack
from typing import Any

import pytest

from fibws.hub.graph.graph import Graph
from fibws.hub.graph.publication import Publication
from fibws.hub.graph.topic import Source, Topic
from fibws.hub.graph.types import CheckedType
from fibws.hub.rosbridge.peers import PeerReports
from fibws.interfaces import Interfaces
from fibws.protocol.operations import Subscribe
from fibws.protocol.serialized import publish_head

from ..fakes import INT32, NANOSECONDS, FakeHub, number, talker_and_listener
from ..rosapi.rosapi_client import RosapiClient
from .recorder import Recorder


def topic_and_source(*, latch: bool = False) -> tuple[Graph, Topic, Source]:
    graph = Graph(Interfaces(), lambda: NANOSECONDS)
    source = graph.advertise(graph.topic("/a"), "/talker", INT32, latch=latch)
    return graph, source.topic, source


# Delivery.


def test_sink_gets_every_message_of_json_and_serialized_publishers() -> None:
    hub = FakeHub()
    recorder = Recorder()
    hub.graph.subscribe(hub.graph.topic("/fib"), recorder, INT32)
    json_talker, talker = hub.client("/json"), hub.client("/serialized", serialized=True)
    json_talker.send("advertise", "/fib", type=INT32)
    talker.send("advertise", "/fib", type=INT32, publisher=3)
    json_talker.send("publish", "/fib", msg=number(1))
    talker.send_binary(publish_head(3) + pack("<i", 2))
    json_talker.send("publish", "/fib", msg=number(3))
    assert [bytes(each.ros1()) for each in recorder.received] == [
        pack("<i", 1),
        pack("<i", 2),
        pack("<i", 3),
    ]
    assert recorder.numbers == [1, 2, 3]
    assert [each.node for each in recorder.received] == ["/json", "/serialized", "/json"]


def test_serialized_bytes_reach_a_sink_without_being_decoded(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    _, topic, source = topic_and_source()
    recorder = Recorder()
    topic.attach(recorder, recorder)
    monkeypatch.setattr(CheckedType, "deserialize", _fail)
    source.publish_serialized(pack("<i", 5))
    assert recorder.received[0].ros1() == pack("<i", 5)


def test_all_sinks_get_the_same_publication() -> None:
    graph, topic, source = topic_and_source()
    recorders = [Recorder(), Recorder(), Recorder("/other")]
    for recorder in recorders:
        graph.subscribe(topic, recorder)
    source.publish({"data": 1})
    first, *others = [recorder.received for recorder in recorders]
    assert len(first) == 1
    assert all(each[0] is first[0] for each in others)


def test_sinks_that_share_a_receiver_get_each_message_through_it_once() -> None:
    graph, topic, source = topic_and_source()
    group, sinks = Recorder(), [Recorder("/x"), Recorder("/y")]
    for sink in sinks:
        graph.subscribe(topic, sink, receiver=lambda _: group)
    source.publish({"data": 1})
    graph.unsubscribe(topic, sinks[0])
    source.publish({"data": 2})
    graph.subscribe(topic, sinks[1])
    source.publish({"data": 3})
    assert (group.numbers, sinks[0].numbers, sinks[1].numbers) == ([1, 2], [], [3])


def test_sink_that_raises_does_not_silence_the_others(caplog: pytest.LogCaptureFixture) -> None:
    graph, topic, source = topic_and_source()

    class Broken(Recorder):
        def receive(self, publication: Publication) -> None:
            raise KeyError("injected")

    before, after = Recorder(), Recorder()
    for sink in (before, Broken(), after):
        graph.subscribe(topic, sink)
    source.publish({"data": 1})
    source.publish_serialized(pack("<i", 2))
    assert (before.numbers, after.numbers) == ([1, 2], [1, 2])
    assert "injected" in caplog.text
    assert "/a" in caplog.text


def test_sink_that_raises_is_not_the_publishers_fault(caplog: pytest.LogCaptureFixture) -> None:
    hub = FakeHub()
    talker, listener = talker_and_listener(hub)

    class Broken(Recorder):
        def receive(self, publication: Publication) -> None:
            raise ValueError("injected")

    hub.graph.subscribe(hub.graph.topics["/fib"], Broken())
    talker.send("publish", "/fib", msg=number(1))
    assert talker.receive() == []
    assert listener.receive_numbers("/fib") == [1]
    assert "injected" in caplog.text


def test_sink_may_unsubscribe_itself_while_it_receives() -> None:
    graph, topic, source = topic_and_source()

    class Once(Recorder):
        def receive(self, publication: Publication) -> None:
            super().receive(publication)
            graph.unsubscribe(topic, self)

    once, others = Once(), [Recorder(), Recorder()]
    for sink in (others[0], once, others[1]):
        graph.subscribe(topic, sink)
    for value in (1, 2):
        source.publish({"data": value})
    assert once.numbers == [1]
    assert [other.numbers for other in others] == [[1, 2], [1, 2]]


def test_sink_may_add_another_while_it_receives() -> None:
    graph, topic, source = topic_and_source()
    added = Recorder("/added")

    class Adding(Recorder):
        def receive(self, publication: Publication) -> None:
            super().receive(publication)
            if not added.received:
                graph.subscribe(topic, added)

    adding, last = Adding(), Recorder()
    for sink in (adding, last):
        graph.subscribe(topic, sink)
    for value in (1, 2):
        source.publish({"data": value})
    assert (adding.numbers, last.numbers, added.numbers) == ([1, 2], [1, 2], [2])


def test_last_sink_may_leave_and_the_source_with_it_while_it_receives() -> None:
    graph, topic, source = topic_and_source()

    class Leaving(Recorder):
        def receive(self, publication: Publication) -> None:
            super().receive(publication)
            graph.unsubscribe(topic, self)
            graph.remove_source(source)

    leaving = Leaving()
    graph.subscribe(topic, leaving)
    source.publish({"data": 1})
    assert leaving.numbers == [1]
    assert graph.topics == {}


# A message for one node.


def test_message_for_one_node_reaches_only_its_sinks() -> None:
    graph, topic, source = topic_and_source()
    mine, other = [Recorder("/mine"), Recorder("/mine")], Recorder("/other")
    for sink in (*mine, other):
        graph.subscribe(topic, sink)
    source.publish({"data": 1}, to="/mine")
    source.publish_serialized(pack("<i", 2), to="/mine")
    source.publish({"data": 3}, to="/nobody")
    assert [sink.numbers for sink in mine] == [[1, 2], [1, 2]]
    assert other.numbers == []
    assert source.messages == 3


def test_sinks_of_one_node_that_raise_or_leave_do_not_silence_the_others(
    caplog: pytest.LogCaptureFixture,
) -> None:
    graph, topic, source = topic_and_source()

    class Leaving(Recorder):
        def receive(self, publication: Publication) -> None:
            graph.unsubscribe(topic, self)
            raise ValueError("injected")

    last = Recorder("/mine")
    for sink in (Leaving("/mine"), Leaving("/mine"), last):
        graph.subscribe(topic, sink)
    source.publish({"data": 1}, to="/mine")
    assert last.numbers == [1]
    assert list(topic.sinks()) == [last]
    assert "injected" in caplog.text


# Latched messages.


@pytest.mark.parametrize("serialized", [False, True])
def test_latched_message_is_replayed_to_a_late_sink(serialized: bool) -> None:
    graph, topic, source = topic_and_source(latch=True)
    early, late = Recorder(), Recorder()
    graph.subscribe(topic, early)
    if serialized:
        source.publish_serialized(pack("<i", 5))
    else:
        source.publish({"data": 5})
    graph.subscribe(topic, late)
    topic.replay(late)
    assert [each.values() for each in late.replayed] == [{"data": 5}]
    assert [bytes(each.ros1()) for each in late.replayed] == [pack("<i", 5)]
    assert (late.received, early.replayed) == ([], [])


def test_latched_messages_of_all_sources_are_replayed() -> None:
    graph, topic, source = topic_and_source(latch=True)
    late = Recorder()
    other = graph.advertise(topic, "/other", INT32, latch=False)
    third = graph.advertise(topic, "/third", INT32, latch=True)
    topic.replay(late)
    assert late.replayed == []
    for value, each in enumerate((source, other, third)):
        each.publish({"data": value})
    topic.replay(late)
    assert [each.values()["data"] for each in late.replayed] == [0, 2]


def test_latched_message_that_fails_does_not_hide_those_of_other_sources() -> None:
    graph, topic, source = topic_and_source(latch=True)
    other = graph.advertise(topic, "/other", INT32, latch=True)
    for value, each in enumerate((source, other)):
        each.publish({"data": value})

    class Picky(Recorder):
        def replay(self, publication: Publication) -> None:
            if publication.values()["data"] == 0:
                raise KeyError("injected")
            super().replay(publication)

    late = Picky()
    graph.subscribe(topic, late)
    with pytest.raises(KeyError, match="injected"):
        topic.replay(late)
    assert [each.values()["data"] for each in late.replayed] == [1]


def test_latched_message_goes_with_its_source() -> None:
    graph, topic, source = topic_and_source(latch=True)
    late = Recorder()
    graph.subscribe(topic, late)
    source.publish({"data": 1})
    graph.remove_source(source)
    topic.replay(late)
    assert late.replayed == []


def test_source_may_make_the_message_for_late_sinks() -> None:
    _, topic, source = topic_and_source()
    source.make_latest = lambda: {"data": 7}
    late = Recorder()
    topic.replay(late)
    assert [each.values() for each in late.replayed] == [{"data": 7}]


# A sink counts as a subscriber.


def test_topic_is_idle_without_sources_and_sinks() -> None:
    graph = Graph(Interfaces(), lambda: NANOSECONDS)
    topic, recorder = graph.topic("/a"), Recorder()
    idle = [topic.idle]
    graph.subscribe(topic, recorder)
    idle.append(topic.idle)
    assert graph.topics == {"/a": topic}
    assert (list(topic.sinks()), list(topic.subscribers())) == ([recorder], ["/recorder"])
    assert list(topic.sinks_of("/recorder")) == [recorder]
    assert list(topic.sinks_of("/other")) == []
    graph.unsubscribe(topic, recorder)
    assert [*idle, topic.idle] == [True, False, True]
    assert graph.topics == {}
    assert (list(topic.sinks()), list(topic.subscribers())) == ([], [])


@pytest.mark.parametrize(("type_", "held"), [(INT32, True), (None, False)])
def test_sink_that_names_the_type_holds_the_topic_to_it(type_: str | None, held: bool) -> None:
    graph, topic, source = topic_and_source()
    recorder = Recorder()
    graph.subscribe(topic, recorder, type_)
    assert topic.main.members() == ["/talker"]
    graph.remove_source(source)
    assert topic.held == held
    assert (topic.type is not None) == held
    if held:
        assert topic.main.members() == ["/recorder"]
    graph.unsubscribe(topic, recorder)
    assert topic.type is None or not topic.held
    assert graph.topics == {}


def test_sink_may_keep_the_type_that_it_has_named_before() -> None:
    graph, topic, source = topic_and_source()
    recorder = Recorder()
    graph.subscribe(topic, recorder, INT32)
    graph.subscribe(topic, recorder, keeps_type=True)
    graph.remove_source(source)
    assert topic.type is not None


def test_node_is_one_subscriber_until_its_last_sink_leaves() -> None:
    graph, topic, _ = topic_and_source()
    sinks = [Recorder(), Recorder()]
    for sink in sinks:
        graph.subscribe(topic, sink)
    assert list(topic.subscribers()) == ["/recorder"]
    graph.unsubscribe(topic, sinks[0])
    assert list(topic.subscribers()) == ["/recorder"]
    graph.unsubscribe(topic, sinks[1])
    assert list(topic.subscribers()) == []


def test_publishers_that_watch_their_peers_see_sinks_come_and_go() -> None:
    hub = FakeHub()
    talker = hub.client("/talker")
    talker.send("advertise", "/fib", type=INT32, peers=True)
    assert talker.receive_one("peers")["nodes"] == []
    topic, sinks = hub.graph.topics["/fib"], [Recorder(), Recorder()]
    hub.graph.subscribe(topic, sinks[0])
    assert talker.receive_one("peers")["nodes"] == ["/recorder"]
    hub.graph.subscribe(topic, sinks[1])
    hub.graph.unsubscribe(topic, sinks[0])
    assert talker.receive() == []
    hub.graph.unsubscribe(topic, sinks[1])
    assert talker.receive_one("peers")["nodes"] == []


def test_sink_may_watch_the_publishers() -> None:
    hub = FakeHub()
    recorder = Recorder()
    topic = hub.graph.topic("/fib")
    hub.graph.subscribe(topic, recorder)
    client = hub.client("/watcher")
    request = Subscribe(id="1", topic="/fib")
    watching = topic.watching(recorder)
    reports = PeerReports(watching, request, client.queue, hub.clock)
    watching.add(recorder, "1", reports)
    talker = hub.client("/talker")
    talker.send("advertise", "/fib", type=INT32)
    assert [each["nodes"] for each in client.receive()] == [[], ["/talker"]]
    talker.disconnect()
    assert client.receive_one("peers")["nodes"] == []
    hub.graph.unsubscribe(topic, recorder)
    assert not watching


def test_rosapi_lists_a_sink_as_a_subscriber() -> None:
    rosapi = RosapiClient()
    graph, recorder = rosapi.graph, Recorder()
    topic = graph.topic("/fib")
    graph.subscribe(topic, recorder, INT32)
    talker = rosapi.add_client("/talker")
    talker.send("advertise", "/fib", type=INT32)
    talker.send("publish", "/fib", msg=number(1))

    def entry(service: str, key: str) -> dict[str, Any]:
        [found] = [each for each in rosapi.call(service)["topics"] if each[key] == "/fib"]
        assert isinstance(found, dict)
        return found

    assert rosapi.call("/rosapi/subscribers", topic="/fib") == {"subscribers": ["/recorder"]}
    assert rosapi.call("/rosapi/topic_type", topic="/fib") == {"type": INT32}
    assert entry("/rosapi/graph", "name")["subscriptions"] == [
        {"node": "/recorder", "queue_length": 7, "throttle_rate": 0, "compression": "ros1"}
    ]
    assert entry("/rosapi/statistics", "topic")["subscriptions"] == [
        {"node": "/recorder", "messages": 1, "dropped": 2, "throttled": 0}
    ]
    talker.disconnect()
    assert rosapi.call("/rosapi/topic_type", topic="/fib") == {"type": INT32}
    graph.unsubscribe(topic, recorder)
    assert rosapi.call("/rosapi/subscribers", topic="/fib") == {"subscribers": []}
    assert "/fib" not in rosapi.call("/rosapi/topics")["topics"]


def _fail(*args: object) -> None:
    raise AssertionError("must not be called")
