"""Sending one goal and following it to its end."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from types import SimpleNamespace
from typing import Any

import pytest
from hub_in_thread import Run
from node_in_thread import ACTION_TOPICS

from fibws.client import actions as goals
from fibws.client.hub_client import HubClient
from fibws.protocol.goals import GoalStatus as S

ROS1, ROS2 = "actionlib_tutorials/Fibonacci", "example_interfaces/Fibonacci"


class ManualServer:
    """An action server over topics that publishes what a test tells it to."""

    def __init__(self, client: HubClient) -> None:
        self._client = client
        for topic, type_ in ACTION_TOPICS.items():
            op = "subscribe" if topic in ("goal", "cancel") else "advertise"
            client.send({"op": op, "topic": f"/hand/{topic}", "type": type_})
        client.call("/rosapi/get_time")

    def goal(self) -> dict[str, Any]:
        message: dict[str, Any] = next(self._client.messages("/hand/goal"))
        return message

    def publish(self, topic: str, **fields: Any) -> None:
        self._client.send({"op": "publish", "topic": f"/hand/{topic}", "msg": fields})


def status(goal: dict[str, Any], number: int, text: str = "") -> dict[str, Any]:
    return {"goal_id": goal["goal_id"], "status": number, "text": text}


def test_goal_without_messages_is_lost(
    run: Run, client: HubClient, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(goals, "LOST_AFTER", 0.1)
    ManualServer(client)
    result = run("action", "send", "/hand", "3")
    assert (result.exit_code, result.stdout) == (1, "")
    assert result.stderr.splitlines() == [
        "LOST",
        "Error: /hand: LOST: no message about the goal for 0.1 s",
    ]


def test_goals_of_other_clients_are_ignored(run: Run, client: HubClient) -> None:
    server = ManualServer(client)
    with ThreadPoolExecutor() as threads:
        sent = threads.submit(run, "action", "send", "-f", "/hand", "3")
        goal = server.goal()
        other = {"goal_id": {"id": "another"}}
        server.publish("status", status_list=[status(other, 3)])
        server.publish("feedback", status=status(other, 1), feedback={"sequence": [9]})
        server.publish("result", status=status(other, 3), result={"sequence": [9]})
        server.publish("status", status_list=[status(other, 3), status(goal, 1)])
        server.publish("result", status=status(goal, 5, "not today"), result={})
        result = sent.result(20)
    assert (result.exit_code, result.stdout) == (1, "sequence: []\n")
    assert result.stderr.splitlines() == [
        "ACTIVE",
        "REJECTED",
        "Error: /hand: REJECTED: not today",
    ]


class FakeClient:
    """A client that receives the given operations."""

    node = "/me"

    def __init__(self, *operations: dict[str, Any]) -> None:
        self._operations = list(operations)
        self.sent: list[dict[str, Any]] = []

    def send(self, operation: dict[str, Any]) -> None:
        self.sent.append(operation)

    def receive(self, timeout: float | None) -> dict[str, Any] | None:
        return self._operations.pop(0)


ID = "send_action_goal:/a:1"
OTHER = {"op": "action_result", "id": "another", "status": 4, "result": True, "values": {}}


@pytest.mark.parametrize(
    ("operation", "end"),
    [
        (
            {"op": "action_result", "status": 4, "result": True, "values": {"x": 1}},
            goals.End(S.SUCCEEDED, "", {"x": 1}),
        ),
        (
            {"op": "action_result", "status": 5, "result": True, "values": {"x": 1}},
            goals.End(S.PREEMPTED, "", {"x": 1}),
        ),
        (
            {"op": "action_result", "status": 6, "result": False, "values": "no"},
            goals.End(S.ABORTED, "no", None),
        ),
        (
            {"op": "action_result", "status": 99, "result": False},
            goals.End(S.LOST, "", None),
        ),
        (
            {"op": "status", "level": "error", "msg": "no"},
            goals.End(S.REJECTED, "no", None),
        ),
    ],
)
def test_end_of_a_goal_over_operations(operation: dict[str, Any], end: goals.End) -> None:
    warning = {"op": "status", "level": "warning", "msg": "never mind", "id": ID}
    client = FakeClient(OTHER, warning, {"id": ID, **operation}, OTHER)
    goal = goals.OperationGoal(client, "/a", ROS2, {"order": 3})  # type: ignore[arg-type]
    assert list(goal.updates()) == [end]
    goal.cancel()
    assert [(each["op"], each["id"]) for each in client.sent] == [
        ("send_action_goal", ID),
        ("cancel_action_goal", ID),
    ]


def test_result_ends_a_goal_over_topics() -> None:
    client = FakeClient({"op": "status", "level": "info", "msg": "never mind"})
    goal = goals.TopicGoal(client, "/a", ROS1, {"order": 3})  # type: ignore[arg-type]
    id_ = client.sent[-1]["msg"]["goal_id"]["id"]
    for number in (1, 1, 99):
        client._operations.append(
            {
                "op": "publish",
                "topic": "/a/result" if number == 99 else "/a/status",
                "msg": {
                    "status_list": [{"goal_id": {"id": id_}, "status": number}],
                    "status": {"goal_id": {"id": id_}, "status": number, "text": ""},
                    "result": {},
                },
            }
        )
    assert list(goal.updates()) == [
        goals.StatusChange(S.ACTIVE),
        goals.End(S.LOST, "", {}),
    ]


def test_goal_in_the_queue_of_a_live_server_is_not_lost(monkeypatch: pytest.MonkeyPatch) -> None:
    now = 0.0
    monkeypatch.setattr(
        goals, "time", SimpleNamespace(monotonic=lambda: now, time_ns=lambda: 1_000_000_000)
    )
    alive = {"op": "publish", "topic": "/a/status", "msg": {"status_list": []}}
    heard = [(4.0, alive), (9.0, None)]
    waits: list[float | None] = []

    class SilentClient:
        node = "/me"

        def send(self, operation: dict[str, Any]) -> None:
            pass

        def receive(self, timeout: float | None) -> dict[str, Any] | None:
            nonlocal now
            waits.append(timeout)
            now, operation = heard.pop(0)
            return operation

    goal = goals.TopicGoal(SilentClient(), "/a", ROS1, {"order": 3})  # type: ignore[arg-type]
    assert list(goal.updates()) == [goals.End(S.LOST, "no message about the goal for 5 s", None)]
    assert waits == [5.0, 5.0]
