"""Which services and actions there are, and whose."""

from __future__ import annotations

import pytest

from fibws.errors import InvalidTypeName, OperationError, UnknownPackage, UnknownType
from fibws.hub.graph.action import Action, Goal, Ros2GoalStatus
from fibws.hub.graph.graph import CANCEL_GOAL, Graph
from fibws.hub.graph.service import Call, OwnProvider, Service
from fibws.interfaces import Interfaces

from ..fakes import ADD, FIBONACCI, NANOSECONDS

INTERFACES = Interfaces()


class Someone:
    """Provides and serves, and takes note of what it lost."""

    def __init__(self, node: str = "/someone") -> None:
        self.node = node
        self.lost: list[Service | Action] = []

    def displaced(self, what: Service | Action) -> None:
        self.lost.append(what)

    def take(self, call: Call) -> None:
        raise AssertionError("nobody calls")

    def pursue(self, goal: Goal) -> None:
        raise AssertionError("nobody sends goals")

    def cancel(self, goal: Goal) -> None:
        raise AssertionError("nobody cancels")

    def forget(self, what: Call | Goal) -> None:
        raise AssertionError("there is nothing to forget")

    def hear(self, goal: Goal, feedback: bytes) -> None:
        raise AssertionError("nobody tells")

    def end(self, goal: Goal, status: Ros2GoalStatus, result: bytes, *, ok: bool) -> None:
        raise AssertionError("nothing ends")


def new_graph(*, strict_types: bool = False) -> Graph:
    return Graph(INTERFACES, lambda: NANOSECONDS, strict_types=strict_types)


def test_a_service_is_its_last_providers() -> None:
    graph, older, newer = new_graph(), Someone(), Someone("/newer")
    first = graph.add_service("/add", ADD, None, older)
    second = graph.add_service("/add", "std_srvs/srv/Empty", None, newer)
    assert graph.services == {"/add": second}
    assert (second.type.name, second.node) == ("std_srvs/Empty", "/newer")
    assert (older.lost, newer.lost) == ([first], [])
    graph.remove_service(first)
    assert graph.services == {"/add": second}
    graph.remove_service(second)
    graph.remove_service(second)
    assert graph.services == {}


def test_an_action_is_its_last_servers() -> None:
    graph, older, newer = new_graph(), Someone(), Someone("/newer")
    first = graph.add_action("/fib", FIBONACCI, None, older)
    second = graph.add_action("/fib", "actionlib_tutorials/Fibonacci", None, newer)
    assert graph.actions == {"/fib": second}
    assert (second.type.name, second.node) == ("actionlib_tutorials/Fibonacci", "/newer")
    assert (older.lost, newer.lost) == ([first], [])
    graph.remove_action(first)
    assert graph.actions == {"/fib": second}
    assert graph.services["/fib/_action/cancel_goal"].node == "/newer"
    graph.remove_action(second)
    graph.remove_action(second)
    assert not (graph.actions or graph.services)


def test_a_service_cancels_the_goals_of_an_action() -> None:
    graph = new_graph()
    graph.add_action("/fib", FIBONACCI, None, Someone())
    service = graph.services["/fib/_action/cancel_goal"]
    assert (service.type.name, service.node) == (CANCEL_GOAL, "/someone")
    assert isinstance(service.provider, OwnProvider)


@pytest.mark.parametrize("strict", [False, True])
@pytest.mark.parametrize(
    ("type_", "error"),
    [
        ("nonsense", InvalidTypeName),
        ("std_srvs/Nothing", UnknownType),
        ("my_package/Thing", UnknownPackage),
    ],
)
def test_a_type_that_is_refused_changes_nothing(
    type_: str, error: type[Exception], strict: bool
) -> None:
    graph, someone = new_graph(strict_types=strict), Someone()
    if error is UnknownPackage and not strict:
        assert graph.add_service("/a", type_, None, someone).type.arguments is None
        assert graph.add_action("/a", type_, None, someone).type.name == type_
        return
    service = graph.add_service("/a", ADD, None, someone)
    action = graph.add_action("/a", FIBONACCI, None, someone)
    revision = graph.revision
    with pytest.raises(error):
        graph.add_service("/a", type_, None, Someone())
    with pytest.raises(error):
        graph.add_action("/a", type_, None, Someone())
    assert (graph.services["/a"], graph.actions["/a"]) == (service, action)
    assert (graph.revision, someone.lost) == (revision, [])


def test_nobody_takes_over_what_is_the_hubs_own() -> None:
    graph, someone = new_graph(), Someone()
    graph.offer("/rosapi/x", "std_srvs/Empty", "/rosapi", lambda request, caller: {})
    with pytest.raises(OperationError, match=r"Service /rosapi/x is the hub's own \(/rosapi\)"):
        graph.add_service("/rosapi/x", "std_srvs/Empty", None, someone)
    assert graph.services["/rosapi/x"].node == "/rosapi"


def test_no_two_goals_have_the_same_uuid() -> None:
    graph, someone = new_graph(), Someone()
    actions = [graph.add_action(name, FIBONACCI, None, someone) for name in ("/a", "/b")]
    goals = [graph.new_goal(action, {"order": 5}, someone) for action in actions * 2]
    assert len({goal.uuid for goal in goals}) == 4
    assert all(len(goal.uuid) == 16 and any(goal.uuid) for goal in goals)
    assert {goal.accepted for goal in goals} == {NANOSECONDS}
    assert all(action.goals == {} for action in actions)


def test_every_change_of_the_graph_shows_in_its_revision() -> None:
    graph, someone = new_graph(), Someone()
    revisions = [graph.revision]
    service = graph.add_service("/add", ADD, None, someone)
    revisions.append(graph.revision)
    graph.remove_service(service)
    revisions.append(graph.revision)
    action = graph.add_action("/fib", FIBONACCI, None, someone)
    revisions.append(graph.revision)
    graph.remove_action(action)
    revisions.append(graph.revision)
    graph.offer("/x", "std_srvs/Empty", "/rosapi", lambda request, caller: {})
    revisions.append(graph.revision)
    assert revisions == sorted(set(revisions))
    graph.remove_service(service)
    graph.remove_action(action)
    graph.new_goal(action, {}, someone)
    assert graph.revision == revisions[-1]
