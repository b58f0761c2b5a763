"""The services and actions of the graph, and their servers."""

from __future__ import annotations

import pytest

from fibws.errors import (
    InvalidMessage,
    InvalidTypeName,
    OperationError,
    UnknownPackage,
    UnknownType,
)
from fibws.hub.errors import CallFailed, DefinitionMismatch, UnknownDefinition
from fibws.hub.graph.action import Action, Goal, Ros2GoalStatus
from fibws.hub.graph.body import Body
from fibws.hub.graph.graph import CANCEL_GOAL, Graph
from fibws.hub.graph.service import Call, InternalServer, Service
from fibws.hub.graph.types import Types
from fibws.interfaces import Interfaces

from ..fakes import ADD, FIBONACCI, NANOSECONDS

INTERFACES = Interfaces()


class FakeServer:
    """Serves services and actions, and records those that another server took over."""

    def __init__(self, node: str = "/server") -> None:
        self.node = node
        self.displaced_from: list[Service | Action] = []

    def displaced(self, what: Service | Action) -> None:
        self.displaced_from.append(what)

    def handle(self, call: Call) -> None:
        raise AssertionError("no call is expected")

    def execute(self, goal: Goal) -> None:
        raise AssertionError("no goal is expected")

    def cancel(self, what: Call | Goal) -> None:
        raise AssertionError("no cancel is expected")

    def forget(self, what: Call | Goal) -> None:
        raise AssertionError("nothing is to be forgotten")

    def feedback(self, goal: Goal, feedback: Body) -> None:
        raise AssertionError("no feedback is expected")

    def result(self, goal: Goal, status: Ros2GoalStatus, result: Body) -> None:
        raise AssertionError("no result is expected")

    def failed(self, goal: Goal, status: Ros2GoalStatus, text: str, code: str) -> None:
        raise AssertionError("no result is expected")


def new_graph(*, strict_types: bool = False) -> Graph:
    return Graph(INTERFACES, lambda: NANOSECONDS, strict_types=strict_types)


def test_newest_server_has_the_service() -> None:
    graph, older, newer = new_graph(), FakeServer(), FakeServer("/newer")
    first = graph.serve("/add", ADD, None, older)
    second = graph.serve("/add", "std_srvs/srv/Empty", None, newer)
    assert graph.services == {"/add": second}
    assert (second.type.name, second.node) == ("std_srvs/Empty", "/newer")
    assert (older.displaced_from, newer.displaced_from) == ([first], [])
    graph.remove_service(first)
    assert graph.services == {"/add": second}
    graph.remove_service(second)
    graph.remove_service(second)
    assert graph.services == {}


def test_newest_server_has_the_action() -> None:
    graph, older, newer = new_graph(), FakeServer(), FakeServer("/newer")
    first = graph.serve_action("/fib", FIBONACCI, None, older)
    second = graph.serve_action("/fib", "actionlib_tutorials/Fibonacci", None, newer)
    assert graph.actions == {"/fib": second}
    assert (second.type.name, second.node) == ("actionlib_tutorials/Fibonacci", "/newer")
    assert (older.displaced_from, newer.displaced_from) == ([first], [])
    graph.remove_action(first)
    assert graph.actions == {"/fib": second}
    assert graph.services["/fib/_action/cancel_goal"].node == "/newer"
    graph.remove_action(second)
    graph.remove_action(second)
    assert not (graph.actions or graph.services)


def test_action_has_a_service_that_cancels_its_goals() -> None:
    graph = new_graph()
    graph.serve_action("/fib", FIBONACCI, None, FakeServer())
    service = graph.services["/fib/_action/cancel_goal"]
    assert (service.type.name, service.node) == (CANCEL_GOAL, "/server")
    assert isinstance(service.server, InternalServer)


@pytest.mark.parametrize("strict", [False, True])
@pytest.mark.parametrize(
    ("type_", "error"),
    [
        ("nonsense", InvalidTypeName),
        ("std_srvs/Nothing", UnknownType),
        ("my_package/Thing", UnknownPackage),
    ],
)
def test_refused_type_changes_nothing(type_: str, error: type[Exception], strict: bool) -> None:
    graph, server = new_graph(strict_types=strict), FakeServer()
    if error is UnknownPackage and not strict:
        assert graph.serve("/a", type_, None, server).type.arguments is None
        assert graph.serve_action("/a", type_, None, server).type.name == type_
        return
    service = graph.serve("/a", ADD, None, server)
    action = graph.serve_action("/a", FIBONACCI, None, server)
    revision = graph.revision
    with pytest.raises(error):
        graph.serve("/a", type_, None, FakeServer())
    with pytest.raises(error):
        graph.serve_action("/a", type_, None, FakeServer())
    assert (graph.services["/a"], graph.actions["/a"]) == (service, action)
    assert (graph.revision, server.displaced_from) == (revision, [])


def test_internal_services_cannot_be_taken_over() -> None:
    graph, server = new_graph(), FakeServer()
    graph.serve_internally("/rosapi/x", "std_srvs/Empty", "/rosapi", lambda request, caller: {})
    with pytest.raises(OperationError, match=r"Service /rosapi/x is the hub's own \(/rosapi\)"):
        graph.serve("/rosapi/x", "std_srvs/Empty", None, server)
    assert graph.services["/rosapi/x"].node == "/rosapi"


def test_goals_have_different_uuids() -> None:
    graph, server = new_graph(), FakeServer()
    actions = [graph.serve_action(name, FIBONACCI, None, server) for name in ("/a", "/b")]
    goals = [
        graph.send_goal(action.name, FIBONACCI, {"order": 5}, server, "/server")
        for action in actions * 2
    ]
    assert len({goal.uuid for goal in goals}) == 4
    assert all(len(goal.uuid) == 16 and any(goal.uuid) for goal in goals)
    assert {goal.accepted for goal in goals} == {NANOSECONDS}
    assert all(action.goals == {} for action in actions)


def test_revision_changes_with_services_and_actions() -> None:
    graph, server = new_graph(), FakeServer()
    revisions = [graph.revision]
    service = graph.serve("/add", ADD, None, server)
    revisions.append(graph.revision)
    graph.remove_service(service)
    revisions.append(graph.revision)
    action = graph.serve_action("/fib", FIBONACCI, None, server)
    revisions.append(graph.revision)
    graph.remove_action(action)
    revisions.append(graph.revision)
    graph.serve_internally("/x", "std_srvs/Empty", "/rosapi", lambda request, caller: {})
    revisions.append(graph.revision)
    assert revisions == sorted(set(revisions))
    graph.remove_service(service)
    graph.remove_action(action)
    assert graph.revision == revisions[-1]


ADD_MD5 = "6a2e34150c00229791cc89ff309fff21"
DOUBLE = "int32 number\n---\nint32 twice\n"


def call(graph: Graph, args: object, md5sum: str | None = None) -> Call:
    headers = {"md5sum": md5sum} if md5sum is not None else None
    return graph.call("/add", args, "/caller", print, print, headers)


def test_service_of_a_type_that_is_not_known_yet_takes_every_request() -> None:
    graph = new_graph()
    service = graph.serve("/add", None, None, FakeServer())
    assert service.type.name == "*"
    assert call(graph, {"a": 1}).request.values() == {"a": 1}
    assert call(graph, [1, 2], md5sum=ADD_MD5).request.values() == [1, 2]


def test_request_is_checked_once_the_type_is_known() -> None:
    graph = new_graph()
    service = graph.serve("/add", None, None, FakeServer())
    early = call(graph, [])
    graph.learn_service_type(service, ADD, None, ADD_MD5)
    assert service.type.name == ADD
    assert early.fill([1, 2], None).values() == {"a": 1, "b": 2}
    assert call(graph, [3]).request.values() == {"a": 3, "b": 0}
    with pytest.raises(InvalidMessage):
        early.fill({"a": "one"}, None)
    with pytest.raises(CallFailed):
        early.fill({}, {"md5sum": "0" * 32})


def test_learned_definition_is_kept_while_the_service_is_there() -> None:
    graph = new_graph()
    service = graph.serve("/double", None, None, FakeServer())
    known = Types(INTERFACES, int, strict=False).service("maths/Double", DOUBLE)
    assert known.md5sum is not None
    graph.learn_service_type(service, "maths/Double", DOUBLE, known.md5sum)
    assert graph.definitions.service("maths/Double").type == "maths/Double"
    graph.learn_service_type(service, "maths/Double", DOUBLE, known.md5sum)
    assert graph.definitions.service("maths/Double").type == "maths/Double"
    graph.remove_service(service)
    with pytest.raises(UnknownPackage):
        graph.definitions.service("maths/Double")


@pytest.mark.parametrize(
    ("type_", "error"),
    [
        ("maths/Double", UnknownDefinition),
        (ADD, DefinitionMismatch),
        ("std_srvs/Nothing", UnknownType),
    ],
)
def test_service_whose_definition_is_not_found_has_a_type_by_name_only(
    type_: str, error: type[Exception]
) -> None:
    graph = new_graph()
    service = graph.serve("/double", None, None, FakeServer())
    with pytest.raises(error):
        graph.learn_service_type(service, type_, None, "0" * 32)
    assert (service.type.name, service.type.md5sum) == (type_, "0" * 32)
    assert service.type.codecs is None
    assert service.type.fault
