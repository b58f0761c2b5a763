"""Goals of actions: execution, feedback, results, and cancelling by a service."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Callable
from itertools import count, permutations
from typing import Any, TypeAlias

import pytest

from fibws.errors import InvalidMessage
from fibws.hub.graph.action import Action, Goal, Ros2GoalStatus, cancel_goals
from fibws.hub.graph.body import Body
from fibws.hub.graph.types import Types
from fibws.interfaces import Interfaces

from ..fakes import FIBONACCI, NANOSECONDS, Client, FakeHub
from ..rosbridge.action_clients import received_goals, send_goal, send_result, server_and_client

TYPES = Types(Interfaces(), lambda: NANOSECONDS, strict=False)
Event: TypeAlias = Callable[["Execution"], object]


class Execution:
    """An action whose server and client record every call."""

    node = "/server"

    def __init__(self) -> None:
        self.calls: list[tuple[str, Goal]] = []
        self.requests: list[dict[str, Any]] = []
        self.received: list[object] = []
        self.action = Action("/fib", TYPES.action(FIBONACCI), self)
        self._numbers = count(1)

    def goal(self, accepted: int = NANOSECONDS) -> Goal:
        """Start a goal."""
        uuid = bytes(15) + bytes([next(self._numbers)])
        goal = Goal(self.action, {"order": 5}, self, "/client", uuid, accepted)
        goal.start()
        return goal

    def execute(self, goal: Goal) -> None:
        self.calls.append(("execute", goal))
        self.requests.append(goal.request.values())

    def cancel(self, goal: Goal) -> None:
        self.calls.append(("cancel", goal))

    def forget(self, goal: Goal) -> None:
        self.calls.append(("forget", goal))

    def displaced(self, action: Action) -> None:
        raise AssertionError("no other server takes it over")

    def feedback(self, goal: Goal, feedback: Body) -> None:
        self.received.append(feedback.json())

    def result(self, goal: Goal, status: Ros2GoalStatus, result: Body) -> None:
        self.received.append((status, result.json()))

    def failed(self, goal: Goal, status: Ros2GoalStatus, text: str, code: str) -> None:
        self.received.append((status, text, code))


def test_goal_states_have_the_numbers_of_ros_2() -> None:
    constants = Interfaces().message("action_msgs/GoalStatus").constants
    numbers = {each.name.removeprefix("STATUS_"): each.value for each in constants}
    assert numbers == {status.name: status.value for status in Ros2GoalStatus}


def test_goal_is_executed_and_sends_feedback() -> None:
    execution = Execution()
    goal = execution.goal()
    assert execution.calls == [("execute", goal)]
    assert execution.action.goals == {goal.uuid: goal}
    assert (execution.action.node, execution.requests) == ("/server", [{"order": 5}])
    assert goal.request.values() == {}, "a large request is not kept"
    goal.feedback({"sequence": [0, 1]})
    goal.feedback({})
    assert execution.received == [b'{"sequence":[0,1]}', b'{"sequence":[]}']


ENDS: dict[str, tuple[Event, object]] = {
    "finish": (
        lambda execution: execution.calls[0][1].finish(Ros2GoalStatus.CANCELED, {"sequence": [1]}),
        (Ros2GoalStatus.CANCELED, b'{"sequence":[1]}'),
    ),
    "fail": (
        lambda execution: execution.calls[0][1].fail("no"),
        (Ros2GoalStatus.ABORTED, "no", "server_failed"),
    ),
    "abandon": (lambda execution: execution.calls[0][1].abandon(), None),
}


@pytest.mark.parametrize("order", [*permutations(ENDS)], ids=" ".join)
def test_goal_ends_only_once(order: tuple[str, ...]) -> None:
    execution = Execution()
    goal = execution.goal()
    for name in order:
        event, _ = ENDS[name]
        event(execution)
        assert execution.action.goals == {}
    _, expected = ENDS[order[0]]
    assert execution.received == ([] if expected is None else [expected])
    calls = [call for call, each in execution.calls if each is goal]
    assert calls == ["execute", *(["cancel"] if order[0] == "abandon" else []), "forget"]


@pytest.mark.parametrize("values", [{"sequence": "1"}, {"sequences": []}, "1", None, []])
def test_invalid_feedback_and_results_are_refused_and_the_goal_goes_on(values: object) -> None:
    execution = Execution()
    goal = execution.goal()
    with pytest.raises(InvalidMessage):
        goal.feedback(values)
    with pytest.raises(InvalidMessage):
        goal.finish(Ros2GoalStatus.SUCCEEDED, values)
    assert execution.received == []
    assert execution.action.goals == {goal.uuid: goal}


# Cancelling by the service beside an action.


def request(uuid: bytes = bytes(16), stamp: int = 0) -> dict[str, Any]:
    secs, nsecs = divmod(stamp, 10**9)
    return {
        "goal_info": {
            "goal_id": {"uuid": b64encode(uuid).decode()},
            "stamp": {"secs": secs, "nsecs": nsecs},
        }
    }


NO_GOALS: set[int] = set()


@pytest.mark.parametrize("accepted", [0, NANOSECONDS])
def test_uuid_without_a_stamp_cancels_one_goal_at_any_time(accepted: int) -> None:
    """Simulated time is 0 until a simulator goes on."""
    execution = Execution()
    goals = [execution.goal(accepted) for _ in range(3)]
    execution.calls.clear()
    response = cancel_goals(execution.action, request(uuid=goals[1].uuid), lambda goal: True)
    assert execution.calls == [("cancel", goals[1])]
    assert len(response["goals_canceling"]) == 1


@pytest.mark.parametrize(
    ("asked", "code", "cancelled"),
    [
        (request(), 0, {0, 1, 2}),
        (request(stamp=1_000_000_002), 0, {0, 1}),
        (request(stamp=1), 0, NO_GOALS),
        (request(uuid=bytes(15) + b"\3"), 0, {2}),
        (request(uuid=bytes(15) + b"\3", stamp=1_000_000_001), 0, {0, 2}),
        (request(uuid=bytes(15) + b"\1", stamp=1_000_000_001), 0, {0}),
        (request(uuid=bytes(15) + b"\4"), 2, NO_GOALS),
        (request(uuid=bytes(15) + b"\4", stamp=1_000_000_001), 0, {0}),
    ],
)
def test_goals_are_cancelled_by_uuid_or_by_age_or_all_together(
    asked: dict[str, Any], code: int, cancelled: set[int]
) -> None:
    execution = Execution()
    goals = [execution.goal(1_000_000_000 + each) for each in (1, 2, 3)]
    execution.calls.clear()
    response = cancel_goals(execution.action, asked, lambda goal: True)
    assert execution.calls == [("cancel", goals[each]) for each in sorted(cancelled)]
    assert response["return_code"] == code
    canceling = [(each["goal_id"]["uuid"], each["stamp"]) for each in response["goals_canceling"]]
    assert canceling == [
        (b64encode(goals[each].uuid).decode(), {"secs": 1, "nsecs": each + 1})
        for each in sorted(cancelled)
    ]
    assert len(execution.action.goals) == 3


def cancel_all(client: Client, **goal_info: Any) -> dict[str, Any]:
    """Call the service that roslib's cancelAllGoals calls; return its response."""
    args = {"goal_info": goal_info} if goal_info else {}
    client.send("call_service", service="/fib/_action/cancel_goal", args=args)
    received = client.receive()
    [response] = [each for each in received if each["op"] == "service_response"]
    assert response["result"], response
    values: dict[str, Any] = response["values"]
    return values


def test_cancel_service_cancels_the_goals_of_all_clients() -> None:
    hub, server, client = server_and_client()
    other = hub.client()
    for each in (client, other):
        send_goal(each, id="x")
    ids = received_goals(server)
    response = cancel_all(client)
    assert (response["return_code"], len(response["goals_canceling"])) == (0, 2)
    assert [(each["op"], each["id"]) for each in server.receive()] == [
        ("cancel_action_goal", id_) for id_ in ids
    ]
    for id_ in ids:
        send_result(server, id_, status=5)
    assert [each["status"] for each in (*client.receive(), *other.receive())] == [5, 5]
    assert cancel_all(client) == {"return_code": 0, "goals_canceling": []}


@pytest.mark.parametrize("stamp", [{"sec": 0, "nanosec": 0}, {"secs": 0, "nsecs": 0}])
@pytest.mark.parametrize("uuid", [[0] * 16, b64encode(bytes(16)).decode()])
def test_explicit_zero_stamp_and_uuid_cancel_all_goals(stamp: dict[str, int], uuid: object) -> None:
    _, server, client = server_and_client()
    send_goal(client)
    received_goals(server)
    response = cancel_all(client, goal_id={"uuid": uuid}, stamp=stamp)
    assert len(response["goals_canceling"]) == 1
    assert server.receive_one("cancel_action_goal")


def test_hub_gives_each_goal_a_uuid_by_which_it_can_be_cancelled() -> None:
    hub, server, client = server_and_client()
    for id_ in "ab":
        send_goal(client, id=id_)
    ids = received_goals(server)
    first, second = (b64encode(each).decode() for each in hub.graph.actions["/fib"].goals)
    response = cancel_all(client, goal_id={"uuid": second})
    [canceling] = response["goals_canceling"]
    assert (response["return_code"], canceling["goal_id"]["uuid"]) == (0, second)
    assert server.receive_one("cancel_action_goal")["id"] == ids[1]
    response = cancel_all(client)
    assert [each["goal_id"]["uuid"] for each in response["goals_canceling"]] == [first, second]
    assert server.receive_one("cancel_action_goal")["id"] == ids[0]


def test_cancel_service_comes_and_goes_with_its_action() -> None:
    hub, server, client = server_and_client()
    service = hub.graph.services["/fib/_action/cancel_goal"]
    assert (service.type.name, service.node) == ("action_msgs/CancelGoal", "/server")
    client.send("advertise_service", service=service.name, type="std_srvs/Empty")
    assert "is the hub's own (/server)" in client.receive_statuses()[0]
    known: list[bool] = []
    hub.graph.watch("service", lambda name: known.append(name in hub.graph.services))
    server.send("unadvertise_action", action="/fib")
    assert hub.graph.services == {}
    assert known == [False]


def test_hub_does_not_use_a_uuid_again_after_it_was_restarted() -> None:
    uuids: set[bytes] = set()
    for _ in range(2):
        hub, _, client = server_and_client()
        send_goal(client)
        uuids.update(hub.graph.actions["/fib"].goals)
    assert len(uuids) == 2


def test_action_that_was_taken_over_is_not_removed_by_its_former_server() -> None:
    hub, _, client = server_and_client()
    older = hub.graph.actions["/fib"]
    client.send("advertise_action", action="/fib", type=FIBONACCI)
    newer = hub.graph.actions["/fib"]
    hub.graph.remove_action(older)
    assert hub.graph.actions == {"/fib": newer}
    assert cancel_all(client) == {"return_code": 0, "goals_canceling": []}


def test_action_takes_over_its_cancel_service_from_another_server() -> None:
    hub = FakeHub()
    older, client = hub.client("/older"), hub.client("/server")
    older.send("set_level", level="warning")
    older.send("advertise_service", service="/fib/_action/cancel_goal", type="std_srvs/Empty")
    client.send("advertise_action", action="/fib", type=FIBONACCI)
    assert len(older.receive_statuses("warning")) == 1
    assert list(older.session.providing()) == []
    assert cancel_all(client) == {"return_code": 0, "goals_canceling": []}
