"""What becomes of a goal, and how goals are cancelled by a service."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Callable
from itertools import count, permutations
from typing import Any, TypeAlias

import pytest

from fibws.errors import InvalidMessage
from fibws.hub.graph.action import Action, Goal, Ros2GoalStatus, cancel_goals
from fibws.hub.graph.types import Types
from fibws.interfaces import Interfaces

from ..fakes import FIBONACCI, NANOSECONDS, Client, FakeHub
from ..session.pursuing import finishes, is_sent, sends_goal, server_and_client

TYPES = Types(Interfaces(), lambda: NANOSECONDS, strict=False)
Happening: TypeAlias = Callable[["Pursuit"], object]


class Pursuit:
    """An action whose server and client only take note of what they are told."""

    node = "/server"

    def __init__(self) -> None:
        self.told: list[tuple[str, Goal]] = []
        self.requests: list[dict[str, Any]] = []
        self.heard: list[object] = []
        self.action = Action("/fib", TYPES.action(FIBONACCI), self)
        self._numbers = count(1)

    def goal(self, accepted: int = NANOSECONDS) -> Goal:
        """One that has started."""
        uuid = bytes(15) + bytes([next(self._numbers)])
        goal = Goal(self.action, {"order": 5}, self, uuid, accepted)
        goal.start()
        return goal

    def pursue(self, goal: Goal) -> None:
        self.told.append(("pursue", goal))
        self.requests.append(goal.request)

    def cancel(self, goal: Goal) -> None:
        self.told.append(("cancel", goal))

    def forget(self, goal: Goal) -> None:
        self.told.append(("forget", goal))

    def displaced(self, action: Action) -> None:
        raise AssertionError("nobody takes it over")

    def hear(self, goal: Goal, feedback: bytes) -> None:
        self.heard.append(feedback)

    def end(self, goal: Goal, status: Ros2GoalStatus, result: bytes, *, ok: bool) -> None:
        self.heard.append((status, result, ok))


def test_the_states_are_numbered_as_in_ros_2() -> None:
    constants = Interfaces().message("action_msgs/GoalStatus").constants
    numbers = {each.name.removeprefix("STATUS_"): each.value for each in constants}
    assert numbers == {status.name: status.value for status in Ros2GoalStatus}


def test_a_goal_is_pursued_and_heard_of() -> None:
    pursuit = Pursuit()
    goal = pursuit.goal()
    assert pursuit.told == [("pursue", goal)]
    assert pursuit.action.goals == {goal.uuid: goal}
    assert (pursuit.action.node, pursuit.requests) == ("/server", [{"order": 5}])
    assert goal.request == {}, "what may be large is not kept"
    goal.feedback({"sequence": [0, 1]})
    goal.feedback({})
    assert pursuit.heard == [b'{"sequence":[0,1]}', b'{"sequence":[]}']


ENDS: dict[str, tuple[Happening, object]] = {
    "finish": (
        lambda pursuit: pursuit.told[0][1].finish(Ros2GoalStatus.CANCELED, {"sequence": [1]}),
        (Ros2GoalStatus.CANCELED, b'{"sequence":[1]}', True),
    ),
    "fail": (
        lambda pursuit: pursuit.told[0][1].fail("no"),
        (Ros2GoalStatus.ABORTED, b'"no"', False),
    ),
    "abandon": (lambda pursuit: pursuit.told[0][1].abandon(), None),
}


@pytest.mark.parametrize("order", [*permutations(ENDS)], ids=" ".join)
def test_a_goal_ends_once(order: tuple[str, ...]) -> None:
    pursuit = Pursuit()
    goal = pursuit.goal()
    for name in order:
        happening, _ = ENDS[name]
        happening(pursuit)
        assert pursuit.action.goals == {}
    _, expected = ENDS[order[0]]
    assert pursuit.heard == ([] if expected is None else [expected])
    told = [what for what, each in pursuit.told if each is goal]
    assert told == ["pursue", *(["cancel"] if order[0] == "abandon" else []), "forget"]


@pytest.mark.parametrize("values", [{"sequence": "1"}, {"sequences": []}, "1", None, []])
def test_what_does_not_fit_neither_ends_a_goal_nor_is_heard(values: object) -> None:
    pursuit = Pursuit()
    goal = pursuit.goal()
    with pytest.raises(InvalidMessage):
        goal.feedback(values)
    with pytest.raises(InvalidMessage):
        goal.finish(Ros2GoalStatus.SUCCEEDED, values)
    assert pursuit.heard == []
    assert pursuit.action.goals == {goal.uuid: goal}


# Cancelling by a service.


def request(uuid: bytes = bytes(16), stamp: int = 0) -> dict[str, Any]:
    secs, nsecs = divmod(stamp, 10**9)
    return {
        "goal_info": {
            "goal_id": {"uuid": b64encode(uuid).decode()},
            "stamp": {"secs": secs, "nsecs": nsecs},
        }
    }


NO_GOALS: set[int] = set()


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
def test_goals_are_cancelled_by_their_uuid_or_their_age_or_all(
    asked: dict[str, Any], code: int, cancelled: set[int]
) -> None:
    pursuit = Pursuit()
    goals = [pursuit.goal(1_000_000_000 + each) for each in (1, 2, 3)]
    pursuit.told.clear()
    response = cancel_goals(pursuit.action, asked)
    assert pursuit.told == [("cancel", goals[each]) for each in sorted(cancelled)]
    assert response["return_code"] == code
    canceling = [(each["goal_id"]["uuid"], each["stamp"]) for each in response["goals_canceling"]]
    assert canceling == [
        (b64encode(goals[each].uuid).decode(), {"secs": 1, "nsecs": each + 1})
        for each in sorted(cancelled)
    ]
    assert len(pursuit.action.goals) == 3


def cancels_all(client: Client, **goal_info: Any) -> dict[str, Any]:
    """What roslib's cancelAllGoals calls, and the response to it."""
    args = {"goal_info": goal_info} if goal_info else {}
    client.says("call_service", service="/fib/_action/cancel_goal", args=args)
    heard = client.hears()
    [response] = [each for each in heard if each["op"] == "service_response"]
    assert response["result"], response
    values: dict[str, Any] = response["values"]
    return values


def test_the_service_beside_an_action_cancels_the_goals_of_all_clients() -> None:
    hub, pursuer, client = server_and_client()
    stranger = hub.client()
    for each in (client, stranger):
        sends_goal(each, id="x")
    ids = is_sent(pursuer)
    response = cancels_all(client)
    assert (response["return_code"], len(response["goals_canceling"])) == (0, 2)
    assert [(each["op"], each["id"]) for each in pursuer.hears()] == [
        ("cancel_action_goal", id_) for id_ in ids
    ]
    for id_ in ids:
        finishes(pursuer, id_, status=5)
    assert [each["status"] for each in (*client.hears(), *stranger.hears())] == [5, 5]
    assert cancels_all(client) == {"return_code": 0, "goals_canceling": []}


@pytest.mark.parametrize("stamp", [{"sec": 0, "nanosec": 0}, {"secs": 0, "nsecs": 0}])
@pytest.mark.parametrize("uuid", [[0] * 16, b64encode(bytes(16)).decode()])
def test_what_is_zero_may_be_spelled_out(stamp: dict[str, int], uuid: object) -> None:
    _, pursuer, client = server_and_client()
    sends_goal(client)
    is_sent(pursuer)
    response = cancels_all(client, goal_id={"uuid": uuid}, stamp=stamp)
    assert len(response["goals_canceling"]) == 1
    assert pursuer.hears_one("cancel_action_goal")


def test_a_goal_is_known_by_the_uuid_that_the_hub_gave_it() -> None:
    hub, pursuer, client = server_and_client()
    for id_ in "ab":
        sends_goal(client, id=id_)
    ids = is_sent(pursuer)
    first, second = (b64encode(each).decode() for each in hub.graph.actions["/fib"].goals)
    response = cancels_all(client, goal_id={"uuid": second})
    [canceling] = response["goals_canceling"]
    assert (response["return_code"], canceling["goal_id"]["uuid"]) == (0, second)
    assert pursuer.hears_one("cancel_action_goal")["id"] == ids[1]
    response = cancels_all(client)
    assert [each["goal_id"]["uuid"] for each in response["goals_canceling"]] == [first, second]
    assert pursuer.hears_one("cancel_action_goal")["id"] == ids[0]


def test_the_service_comes_and_goes_with_its_action() -> None:
    hub, pursuer, client = server_and_client()
    service = hub.graph.services["/fib/_action/cancel_goal"]
    assert (service.type.name, service.node) == ("action_msgs/CancelGoal", "/server")
    client.says("advertise_service", service=service.name, type="std_srvs/Empty")
    assert "is the hub's own (/server)" in client.hears_statuses()[0]
    pursuer.says("unadvertise_action", action="/fib")
    assert hub.graph.services == {}


def test_an_action_takes_the_service_over_from_a_client_that_had_it() -> None:
    hub = FakeHub()
    provider, client = hub.client("/provider"), hub.client("/server")
    provider.says("set_level", level="warning")
    provider.says("advertise_service", service="/fib/_action/cancel_goal", type="std_srvs/Empty")
    client.says("advertise_action", action="/fib", type=FIBONACCI)
    assert provider.hears_statuses("warning") == [
        "/fib/_action/cancel_goal has another provider now"
    ]
    assert list(provider.session.providing()) == []
    assert cancels_all(client) == {"return_code": 0, "goals_canceling": []}
