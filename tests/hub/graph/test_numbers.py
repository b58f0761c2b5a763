"""Numbers of topics and services in binary frames."""

from __future__ import annotations

import pytest

from fibws.errors import OperationError, UnknownType
from fibws.hub.errors import NotAllowed
from fibws.hub.foxglove.feeds import ServiceFeeds
from fibws.hub.graph.graph import Graph
from fibws.hub.graph.numbers import Numbers
from fibws.hub.graph.policy import AllowAll
from fibws.hub.graph.service import Service
from fibws.interfaces import Interfaces
from fibws.protocol.serialized import deliver_head

from ..fakes import ADD, INT32, STRING
from .recorder import Recorder
from .test_service import SlowServer

INTERFACES = Interfaces()


class Displaceable(SlowServer):
    """A server whose service another one may take over."""

    def displaced(self, service: Service) -> None:
        """Do nothing."""


class AllowNone(AllowAll):
    """A policy that forbids everything."""

    allows_all = False

    def may(self, node: str, right: str, name: str) -> bool:
        return False


def new_graph(policy: AllowAll | None = None) -> Graph:
    return Graph(INTERFACES, lambda: 0, policy=policy)


def use_once(graph: Graph, name: str = "/once") -> int:
    """Publish on a topic for a moment; return its number."""
    source = graph.advertise(graph.topic(name), "/talker", INT32)
    number = source.topic.number
    graph.remove_source(source)
    return number


def test_numbers_are_given_out_in_order_and_start_again_after_the_last() -> None:
    numbers = Numbers(last=3)
    assert [numbers.take() for _ in range(3)] == [1, 2, 3]
    numbers.give_back(1)
    assert numbers.take() == 1
    numbers.give_back(3)
    numbers.give_back(3)
    assert numbers.take() == 3


def test_looking_up_a_topic_takes_no_number() -> None:
    graph = new_graph()
    first = use_once(graph)
    for _ in range(3):
        assert graph.topic("/nobody").number == 0
    assert use_once(graph) == first + 1


def test_refused_registrations_take_no_number() -> None:
    graph = new_graph(AllowNone())
    graph.rights.internal.add("/talker")
    first = use_once(graph)
    with pytest.raises(NotAllowed):
        graph.advertise(graph.topic("/a"), "/stranger", INT32)
    with pytest.raises(NotAllowed):
        graph.subscribe(graph.topic("/a"), Recorder("/stranger"), INT32)
    with pytest.raises(UnknownType):
        graph.advertise(graph.topic("/a"), "/talker", "std_msgs/Nothing")
    graph.reserved.add("/rosout_agg")
    with pytest.raises(OperationError):
        graph.advertise(graph.topic("/rosout_agg"), "/stranger", INT32)
    assert use_once(graph) == first + 1


def test_topic_keeps_its_number_while_it_has_users_and_its_type() -> None:
    graph = new_graph()
    source = graph.advertise(graph.topic("/a"), "/talker", INT32)
    topic = source.topic
    number = topic.number
    recorder = Recorder("/listener")
    graph.subscribe(topic, recorder)
    graph.advertise(topic, "/other", INT32)
    assert topic.number == number
    for each in list(topic.sources.values()):
        graph.remove_source(each)
    assert topic.number == number
    graph.advertise(topic, "/other", STRING)
    assert topic.number not in (0, number)


def test_topics_can_be_used_once_all_numbers_have_been_given_out() -> None:
    graph = new_graph()
    kept = [graph.advertise(graph.topic(f"/kept{i}"), "/talker", INT32).topic for i in range(3)]
    graph._groups._numbers._newest = 2**32 - 2
    found = [use_once(graph, f"/once{i}") for i in range(3)]
    assert found == [2**32 - 1, 4, 5]
    assert len({each.number for each in kept}) == 3
    for number in found:
        assert deliver_head(number, 0)


def test_services_can_be_described_once_all_numbers_have_been_given_out() -> None:
    graph = new_graph()
    services = ServiceFeeds(graph)
    services._numbers = Numbers(last=2)
    for _ in range(5):
        service = graph.serve("/add", ADD, None, Displaceable())
        entry = services.find("/add")
        assert entry is not None
        assert entry.id in (1, 2)
        assert services.find("/add") is entry
        again = graph.serve("/add", ADD, None, Displaceable())
        newer = services.find("/add")
        assert newer is not None
        assert newer.id not in (0, entry.id)
        graph.remove_service(service)
        graph.remove_service(again)
    assert not services._numbers._used
