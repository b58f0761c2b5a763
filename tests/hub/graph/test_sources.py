"""Sources: messages are checked, completed, numbered, counted and latched."""

from __future__ import annotations

import json
from collections.abc import Callable
from struct import pack
from typing import Any

import pytest

from fibws.errors import InvalidMessage, OperationError
from fibws.hub.graph.graph import Graph
from fibws.hub.graph.latched import LatchQuota
from fibws.hub.graph.publication import Publication
from fibws.hub.graph.topic import Source
from fibws.interfaces import Interfaces

from ..fakes import INT32, NANOSECONDS
from .recorder import Recorder

INTERFACES = Interfaces()
HEADER_STRING = "rospy_tutorials/HeaderString"


def source(type_: str = INT32, node: str = "/talker", **options: Any) -> Source:
    """A source on a new graph's topic /a."""
    graph = Graph(INTERFACES, lambda: NANOSECONDS)
    return graph.advertise(graph.topic("/a"), node, type_, **options)


def recorded(source: Source) -> Recorder:
    """A new subscriber of the source's topic."""
    recorder = Recorder()
    source.topic.attach(recorder, recorder)
    return recorder


def header_string(seq: int, data: str = "") -> bytes:
    """A HeaderString in ROS 1's serialization."""
    return pack("<IIII", seq, 1, 2, 0) + pack("<I", len(data)) + data.encode()


# Values.


def test_missing_fields_get_defaults() -> None:
    talker = source("geometry_msgs/Vector3")
    recorder = recorded(talker)
    talker.publish({"y": 2})
    talker.publish(None)
    assert recorder.values == [{"x": 0, "y": 2, "z": 0}, {"x": 0, "y": 0, "z": 0}]


def test_publication_names_its_publisher_its_type_and_its_time() -> None:
    talker = source()
    recorder = recorded(talker)
    talker.publish({"data": 1})
    talker.publish_serialized(pack("<i", 2))
    for publication in recorder.received:
        assert (publication.node, publication.type.name) == ("/talker", INT32)
        assert (publication.received, publication.header) == (NANOSECONDS, talker.header)


@pytest.mark.parametrize(
    ("asked", "kept"),
    [
        *((0, 0), (-1, 0), (-(2**63), 0), (1, 1), (2**31 - 1, 2**31 - 1), (2**31, 2**31 - 1)),
        *((2**64 - 1, 2**31 - 1), (10**300, 2**31 - 1)),
    ],
)
def test_queue_size_may_be_any_integer(asked: int, kept: int) -> None:
    assert source(queue_size=asked).queue_size == kept


@pytest.mark.parametrize("latch", [False, True])
def test_invalid_message_is_neither_delivered_nor_counted_nor_latched(latch: bool) -> None:
    talker = source(latch=latch)
    recorder = recorded(talker)
    with pytest.raises(InvalidMessage):
        talker.publish({"data": "x"})
    with pytest.raises(InvalidMessage):
        talker.publish_serialized(b"abc")
    assert recorder.received == []
    assert talker.recall() is None
    assert (talker.messages, talker.bytes) == (0, 0)


def test_messages_and_bytes_are_counted() -> None:
    talker = source()
    talker.publish({"data": 1})
    assert (talker.messages, talker.bytes) == (1, len(b'{"data":1}'))
    talker.publish({"data": 1}, size=100)
    assert (talker.messages, talker.bytes) == (2, 110)
    talker.publish_serialized(pack("<i", 1))
    assert (talker.messages, talker.bytes) == (3, 114)
    talker.publish_serialized(pack("<i", 1), to="/nobody")
    assert (talker.messages, talker.bytes) == (4, 118)


@pytest.mark.parametrize("latch", [False, True])
def test_connection_header_has_the_callerid_and_the_clients_fields(latch: bool) -> None:
    talker = source(latch=latch)
    own = {"callerid": "/talker", "latching": "1" if latch else "0"}
    assert json.loads(talker.header) == own
    talker.set_headers({"user": "ann"})
    assert json.loads(talker.header) == {**own, "user": "ann"}
    talker.set_headers({"callerid": "/me"})
    assert json.loads(talker.header) == {**own, "callerid": "/me"}


# Latching.


def test_latching_source_keeps_its_last_message() -> None:
    talker = source(latch=True)
    for number in range(3):
        talker.publish({"data": number})
    assert talker.recall() is not None
    talker.publish_serialized(pack("<i", 8))
    latched = talker.recall()
    assert latched is not None
    assert latched.values() == {"data": 8}


def test_source_that_does_not_latch_keeps_nothing() -> None:
    talker = source()
    talker.publish({"data": 1})
    talker.publish_serialized(pack("<i", 8))
    assert talker.recall() is None


def test_message_for_one_node_is_not_latched() -> None:
    talker = source(latch=True)
    talker.publish({"data": 1})
    talker.publish({"data": 2}, to="/listener")
    talker.publish_serialized(pack("<i", 3), to="/listener")
    latched = talker.recall()
    assert latched is not None
    assert latched.values() == {"data": 1}


@pytest.mark.parametrize("serialized", [False, True])
def test_source_that_a_subscriber_removes_keeps_no_latched_message(serialized: bool) -> None:
    """Otherwise the bytes would count for the node as long as it is connected."""
    graph = Graph(INTERFACES, lambda: NANOSECONDS)
    quota = LatchQuota(100)
    talker = graph.advertise(graph.topic("/a"), "/talker", INT32, latch=True, quota=quota)

    class Remover(Recorder):
        def receive(self, publication: Publication) -> None:
            super().receive(publication)
            graph.remove_source(talker)

    remover = Remover()
    talker.topic.attach(remover, remover)
    if serialized:
        talker.publish_serialized(pack("<i", 1))
    else:
        talker.publish({"data": 1})
    assert remover.numbers == [1]
    assert talker.recall() is None
    assert quota.used == 0


def test_source_that_is_removed_again_does_not_remove_its_successor() -> None:
    graph = Graph(INTERFACES, lambda: NANOSECONDS)
    older = graph.advertise(graph.topic("/a"), "/talker", INT32)
    graph.remove_source(older)
    newer = graph.advertise(graph.topic("/a"), "/talker", INT32)
    newer.publish({"data": 1})
    graph.remove_source(older)
    assert graph.topics["/a"].sources == {"/talker": newer}
    assert graph.messages.by_topic()[0]["/a"].messages == 1


def test_only_bytes_are_kept_of_a_latched_message() -> None:
    quota = LatchQuota(100)
    talker = source(latch=True, quota=quota)
    recorder = recorded(talker)
    ways: list[Callable[[], None]] = [
        lambda: talker.publish({"data": 5}),
        lambda: talker.publish_serialized(pack("<i", 5)),
    ]
    for publish in ways:
        publish()
        assert quota.used == len(pack("<i", 5))
        latched = talker.recall()
        assert latched is recorder.received[-1]
        assert latched is not None
        assert latched._values is None
    talker.forget_latched()
    assert quota.used == 0


@pytest.mark.parametrize("serialized", [False, True])
def test_message_beyond_the_quota_is_delivered_but_not_latched(serialized: bool) -> None:
    quota = LatchQuota(20)
    talker = source("std_msgs/String", latch=True, quota=quota)
    recorder = recorded(talker)
    talker.publish({"data": "short"})
    assert quota.used == 9
    with pytest.raises(OperationError, match="--max-latched-bytes") as caught:
        if serialized:
            talker.publish_serialized(pack("<I", 50) + b"x" * 50)
        else:
            talker.publish({"data": "x" * 50})
    assert "/a" in str(caught.value)
    assert "20" in str(caught.value)
    assert len(recorder.received) == 2
    assert talker.recall() is None
    assert quota.used == 0


def test_quota_is_shared_by_the_sources_of_a_node() -> None:
    quota = LatchQuota(7)
    first, second = (source(latch=True, quota=quota) for _ in range(2))
    first.publish({"data": 1})
    with pytest.raises(OperationError):
        second.publish({"data": 2})
    first.forget_latched()
    second.publish({"data": 2})
    assert quota.used == 4


# header.seq.


def test_each_source_counts_its_messages_in_header_seq() -> None:
    first, second = source(HEADER_STRING), source(HEADER_STRING)
    received = recorded(first), recorded(second)
    for talker in (first, first, second, first):
        talker.publish({"header": {"seq": 99}})
    counts = [[values["header"]["seq"] for values in each.values] for each in received]
    assert counts == [[1, 2, 3], [1]]


def test_values_and_bytes_are_counted_together_in_header_seq() -> None:
    talker = source(HEADER_STRING)
    recorder = recorded(talker)
    talker.publish({"header": {"seq": 99}, "data": "a"})
    talker.publish_serialized(header_string(99, "b"))
    talker.publish_serialized(bytearray(header_string(99, "c")))
    talker.publish_serialized(memoryview(header_string(99, "d")))
    talker.publish({"data": "e"})
    found = [(values["header"]["seq"], values["data"]) for values in recorder.values]
    assert found == [(1, "a"), (2, "b"), (3, "c"), (4, "d"), (5, "e")]
    numbers = [int.from_bytes(bytes(each.ros1())[:4], "little") for each in recorder.received]
    assert numbers == [1, 2, 3, 4, 5]


def test_header_seq_is_written_into_the_buffer_of_a_large_message() -> None:
    talker = source(HEADER_STRING)
    recorder = recorded(talker)
    talker.publish({})
    buffer = bytearray(b"head") + header_string(99, "x" * 100_000)
    talker.publish_serialized(memoryview(buffer)[4:])
    message = recorder.received[1].ros1()
    assert isinstance(message, memoryview)
    assert message.obj is buffer
    assert bytes(buffer) == b"head" + header_string(2, "x" * 100_000)


def test_bytes_without_a_header_are_delivered_uncopied() -> None:
    talker = source("std_msgs/String")
    recorder = recorded(talker)
    data = memoryview(bytearray(pack("<I", 5) + b"hello"))
    talker.publish_serialized(data)
    assert recorder.received[0].ros1() is data


def test_invalid_message_does_not_count_in_header_seq() -> None:
    talker = source(HEADER_STRING)
    recorder = recorded(talker)
    talker.publish({})
    with pytest.raises(InvalidMessage):
        talker.publish_serialized(header_string(99)[:-1])
    with pytest.raises(InvalidMessage):
        talker.publish({"data": 5})
    talker.publish({})
    assert [values["header"]["seq"] for values in recorder.values] == [1, 2]


@pytest.mark.parametrize("serialized", [False, True])
def test_header_seq_is_a_uint32(serialized: bool) -> None:
    talker = source(HEADER_STRING)
    recorder = recorded(talker)
    talker._sequence = 2**32 - 2
    for _ in range(3):
        if serialized:
            talker.publish_serialized(header_string(0))
        else:
            talker.publish({})
    assert [values["header"]["seq"] for values in recorder.values] == [2**32 - 1, 0, 1]


def test_relayed_message_keeps_its_header_seq() -> None:
    talker = source(HEADER_STRING)
    recorder = recorded(talker)
    talker.relay(header_string(99))
    with pytest.raises(InvalidMessage):
        talker.relay(header_string(99)[:-1])
    assert [values["header"]["seq"] for values in recorder.values] == [99]
    assert talker.messages == 1


@pytest.mark.parametrize(
    ("type_", "msg"),
    [
        ("std_msgs/Header", {"seq": 99}),
        ("tf2_msgs/TFMessage", {"transforms": [{"header": {"seq": 99}}]}),
    ],
)
def test_header_that_is_not_the_messages_own_is_not_changed(
    type_: str, msg: dict[str, Any]
) -> None:
    talker = source(type_)
    recorder = recorded(talker)
    talker.publish(msg)
    data = bytes(recorder.received[0].ros1())
    talker.publish_serialized(data)
    assert bytes(recorder.received[1].ros1()) == data
    for values in recorder.values:
        assert values.get("seq") == 99 or values["transforms"][0]["header"]["seq"] == 99
