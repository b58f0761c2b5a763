"""Action servers and clients on a real hub, over topics and over operations."""

from __future__ import annotations

import asyncio
import math
from collections.abc import AsyncIterator
from pathlib import Path
from typing import Any, assert_type

import pytest
from ports import port as port

import fibws
from fibws.action import action_class
from fibws.action.actionlib_tutorials import Fibonacci
from fibws.hub import Settings
from fibws.hub.server import HubServer
from fibws.msg.actionlib_tutorials import FibonacciFeedback, FibonacciGoal, FibonacciResult
from fibws.msg.control_msgs import GripperCommandResult
from fibws.msg.std_msgs import String
from fibws.node.actions.actions import Over

FibonacciServerGoal = fibws.ServerGoal[FibonacciGoal, FibonacciResult, FibonacciFeedback]
FibonacciClientGoal = fibws.ClientGoal[FibonacciResult, FibonacciFeedback]

OVER: list[Over] = ["topics", "operations"]

both_kinds = pytest.mark.parametrize("over", OVER)


@pytest.fixture
async def real_hub() -> AsyncIterator[HubServer]:
    """A hub; nodes must leave no tasks of actions behind."""
    async with HubServer(Settings(port=0, close_timeout=0.1)) as hub:
        yield hub
    names = {task.get_name() for task in asyncio.all_tasks()}
    assert not {name for name in names if "fibonacci" in name or "numbers" in name}


@pytest.fixture
async def server(real_hub: HubServer) -> AsyncIterator[fibws.Node]:
    async with fibws.Node("server", hub=real_hub.url) as node:
        yield node


@pytest.fixture
async def client(real_hub: HubServer) -> AsyncIterator[fibws.Node]:
    async with fibws.Node("client", hub=real_hub.url) as node:
        yield node


async def count(goal: FibonacciServerGoal) -> FibonacciResult:
    """Count to the order; wait for a cancel if it is negative; raise an exception if it is 13."""
    order = goal.request.order
    if order == 13:
        raise RuntimeError("bad luck")
    numbers = []
    for number in range(abs(order)):
        numbers.append(number)
        await goal.publish_feedback(Fibonacci.Feedback(numbers))
    if order < 0:
        await goal.cancellation()
        return goal.canceled(Fibonacci.Result(numbers))
    return Fibonacci.Result(numbers)


async def ready(
    node: fibws.Node, over: Over, name: str = "fibonacci"
) -> fibws.ActionClient[FibonacciGoal, FibonacciResult, FibonacciFeedback]:
    client = node.action_client(name, Fibonacci, over=over)
    await client.wait_for_server(timeout=60)
    return client


async def error_of(goal: FibonacciClientGoal) -> fibws.ActionError:
    with pytest.raises(fibws.ActionError) as error:
        await goal.result(timeout=60)
    return error.value


@both_kinds
async def test_goal_succeeds(server: fibws.Node, client: fibws.Node, over: Over) -> None:
    await server.action_server("fibonacci", Fibonacci, count, over=over)
    fibonacci = await ready(client, over)
    goal = await fibonacci.send(Fibonacci.Goal(order=3))
    received = []
    async for feedback in goal.feedback():
        assert_type(feedback, FibonacciFeedback)
        received.append(feedback.sequence)
    assert received == [[0], [0, 1], [0, 1, 2]]
    result = await goal.result()
    assert_type(result, FibonacciResult)
    assert result.sequence == [0, 1, 2]
    assert goal.status is fibws.GoalStatus.SUCCEEDED


@both_kinds
async def test_goal_is_canceled(server: fibws.Node, client: fibws.Node, over: Over) -> None:
    await server.action_server("fibonacci", Fibonacci, count, over=over)
    fibonacci = await ready(client, over)
    goal = await fibonacci.send(Fibonacci.Goal(-2))
    await anext(goal.feedback())
    await goal.cancel()
    error = await error_of(goal)
    assert error.status is goal.status is fibws.GoalStatus.PREEMPTED
    assert error.result == FibonacciResult([0, 1])


@both_kinds
async def test_exception_aborts_only_its_goal(
    server: fibws.Node, client: fibws.Node, over: Over
) -> None:
    await server.action_server("fibonacci", Fibonacci, count, over=over)
    fibonacci = await ready(client, over)
    error = await error_of(await fibonacci.send(Fibonacci.Goal(13)))
    assert (error.status, error.text) == (
        fibws.GoalStatus.ABORTED,
        "RuntimeError: bad luck",
    )
    goal = await fibonacci.send(Fibonacci.Goal(1))
    assert (await goal.result(timeout=60)).sequence == [0]


async def test_goals_over_topics_preempt_each_other_by_default(
    server: fibws.Node, client: fibws.Node
) -> None:
    await server.action_server("fibonacci", Fibonacci, count)
    fibonacci = await ready(client, "topics")
    first = await fibonacci.send(Fibonacci.Goal(-1))
    await anext(first.feedback())
    second = await fibonacci.send(Fibonacci.Goal(2))
    assert (await error_of(first)).status is fibws.GoalStatus.PREEMPTED
    assert (await second.result(timeout=60)).sequence == [0, 1]


async def test_goals_over_operations_are_concurrent_by_default(
    server: fibws.Node, client: fibws.Node
) -> None:
    await server.action_server("fibonacci", Fibonacci, count, over="operations")
    fibonacci = await ready(client, "operations")
    first = await fibonacci.send(Fibonacci.Goal(-1))
    second = await fibonacci.send(Fibonacci.Goal(2))
    assert (await second.result(timeout=60)).sequence == [0, 1]
    assert first.status is fibws.GoalStatus.ACTIVE


@both_kinds
async def test_many_goals_are_executed_at_the_same_time(
    server: fibws.Node, client: fibws.Node, over: Over
) -> None:
    await server.action_server("fibonacci", Fibonacci, count, over=over, concurrent=True)
    fibonacci = await ready(client, over)
    goals = [await fibonacci.send(Fibonacci.Goal(-1 - number)) for number in range(40)]
    for goal in reversed(goals):
        await anext(goal.feedback())
        await goal.cancel()
    for number, goal in enumerate(goals):
        assert len((await error_of(goal)).result.sequence) == number + 1


@both_kinds
async def test_type_may_be_a_name_and_goal_a_dict(
    server: fibws.Node, client: fibws.Node, over: Over
) -> None:
    async def execute(goal: fibws.ServerGoal[Any, Any, Any]) -> Any:
        return FibonacciResult([goal.request.order])

    await server.action_server("fibonacci", "actionlib_tutorials/Fibonacci", execute, over=over)
    fibonacci = client.action_client("fibonacci", "actionlib_tutorials/Fibonacci", over=over)
    await fibonacci.wait_for_server(timeout=60)
    goal = await fibonacci.send({"order": 8})
    assert (await goal.result(timeout=60)).sequence == [8]


@both_kinds
async def test_infinity_and_nan_arrive_in_goal_feedback_and_result(
    server: fibws.Node, client: fibws.Node, over: Over
) -> None:
    async def execute(goal: fibws.ServerGoal[Any, Any, Any]) -> Any:
        command = goal.request.command
        await goal.publish_feedback({"position": command.position, "effort": command.max_effort})
        return GripperCommandResult(position=command.position, effort=command.max_effort)

    await server.action_server("grip", "control_msgs/GripperCommand", execute, over=over)
    gripper = client.action_client("grip", "control_msgs/GripperCommand", over=over)
    await gripper.wait_for_server(timeout=60)
    for sent in ((math.inf, -math.inf), (math.nan, -0.0)):
        command = {"position": sent[0], "max_effort": sent[1]}
        goal = await gripper.send({"command": command})
        feedback = await anext(goal.feedback())
        result = await goal.result(timeout=60)
        for each in (feedback, result):
            assert repr((each.position, each.effort)) == repr(sent)


@both_kinds
async def test_names_are_resolved_and_remapped(real_hub: HubServer, over: Over) -> None:
    remapping = fibws.parse_remappings(["fibonacci:=/robot/numbers"])
    async with (
        fibws.Node("server", hub=real_hub.url, remapping=remapping) as server,
        fibws.Node("client", hub=real_hub.url, namespace="/robot") as client,
    ):
        served = await server.action_server("fibonacci", Fibonacci, count, over=over)
        assert served.name == "/robot/numbers"
        goal = await (await ready(client, over, "numbers")).send(Fibonacci.Goal(1))
        assert (await goal.result(timeout=60)).sequence == [0]


@both_kinds
async def test_hub_learns_the_users_own_action_type(
    real_hub: HubServer, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, over: Over
) -> None:
    package = tmp_path / f"herd_{over}"
    (package / "msg").mkdir(parents=True)
    (package / "action").mkdir()
    (package / "msg" / "Sheep.msg").write_text("string name\n")
    (package / "action" / "Count.action").write_text(
        "Sheep[] sheep\n---\nuint8 count\n---\nSheep counted\n"
    )
    monkeypatch.setenv("FIBWS_INTERFACES", str(tmp_path))

    async def execute(goal: fibws.ServerGoal[Any, Any, Any]) -> Any:
        feedback = action_class(f"{package.name}/Count").Feedback
        for sheep in goal.request.sheep:
            await goal.publish_feedback(feedback(sheep))
        return goal.aborted(action_class(f"{package.name}/Count").Result(len(goal.request.sheep)))

    async with fibws.Node("node", hub=real_hub.url) as node:
        await node.action_server("count", f"{package.name}/Count", execute, over=over)
        client = node.action_client("count", f"{package.name}/Count", over=over)
        await client.wait_for_server(timeout=60)
        with pytest.raises(fibws.InvalidMessage, match="name"):
            await client.send({"sheep": [{"name": 5}]})
        goal = await client.send({"sheep": [{"name": "Dolly"}, {"name": "Molly"}]})
        names = [feedback.counted.name async for feedback in goal.feedback()]
        assert names == ["Dolly", "Molly"]
        assert (await error_of(goal)).result.count == 2


# Leaving


@both_kinds
async def test_end_of_the_server_aborts_its_goals(
    server: fibws.Node, client: fibws.Node, over: Over
) -> None:
    async with await server.action_server("fibonacci", Fibonacci, count, over=over):
        fibonacci = await ready(client, over)
        goal = await fibonacci.send(Fibonacci.Goal(-1))
        await anext(goal.feedback())
    error = await error_of(goal)
    assert (error.status, error.text) == (
        fibws.GoalStatus.ABORTED,
        "the action server has ended",
    )


@both_kinds
async def test_end_of_the_servers_node_aborts_its_goals(
    real_hub: HubServer, client: fibws.Node, over: Over
) -> None:
    async with fibws.Node("server", hub=real_hub.url) as server:
        await server.action_server("fibonacci", Fibonacci, count, over=over)
        fibonacci = await ready(client, over)
        goal = await fibonacci.send(Fibonacci.Goal(-1))
        await anext(goal.feedback())
    assert (await error_of(goal)).text == "the action server has ended"


async def test_goals_over_operations_are_canceled_when_the_client_leaves(
    real_hub: HubServer, server: fibws.Node
) -> None:
    ended = asyncio.Event()

    async def execute(goal: FibonacciServerGoal) -> FibonacciResult:
        await goal.publish_feedback(Fibonacci.Feedback())
        await goal.cancellation()
        ended.set()
        return goal.canceled()

    await server.action_server("fibonacci", Fibonacci, execute, over="operations")
    async with fibws.Node("client", hub=real_hub.url) as client:
        goal = await (await ready(client, "operations")).send(Fibonacci.Goal())
        await anext(goal.feedback())
    async with asyncio.timeout(60):
        await ended.wait()


@both_kinds
async def test_disconnect_loses_goals_and_reconnection_restores_the_action(
    real_hub: HubServer, over: Over, port: int
) -> None:
    old = await HubServer(Settings(port=port, close_timeout=0.1)).__aenter__()
    async with (
        fibws.Node("server", hub=old.url) as server,
        fibws.Node("client", hub=old.url) as client,
    ):
        await server.action_server("fibonacci", Fibonacci, count, over=over)
        fibonacci = await ready(client, over)
        goal = await fibonacci.send(Fibonacci.Goal(-1))
        await anext(goal.feedback())
        await old.__aexit__(None, None, None)
        # Over operations the hub may have disconnected the server before the client.
        assert (await error_of(goal)).text in (
            "the connection to the hub was lost",
            "Action /fibonacci is unavailable: /server has left",
        )
        async with HubServer(Settings(port=port, close_timeout=0.1)):
            await fibonacci.wait_for_server(timeout=60)
            again = await fibonacci.send(Fibonacci.Goal(2))
            assert (await again.result(timeout=60)).sequence == [0, 1]


@both_kinds
async def test_client_without_a_server(client: fibws.Node, over: Over) -> None:
    fibonacci = client.action_client("fibonacci", Fibonacci, over=over)
    with pytest.raises(fibws.WaitTimeout, match="while waiting for action server /fibonacci"):
        await fibonacci.wait_for_server(timeout=0.1)
    if over == "operations":
        error = await error_of(await fibonacci.send(Fibonacci.Goal(1)))
        assert error.text == "Action /fibonacci does not exist"


# Refusals


async def test_server_works_although_others_use_its_topics_with_other_types(
    server: fibws.Node, client: fibws.Node, real_hub: HubServer
) -> None:
    async with fibws.Node("other", hub=real_hub.url) as other:
        for topic in ("feedback", "cancel"):
            await other.advertise(f"count/{topic}", String)
        await server.action_server("count", Fibonacci, count)
        goal = await client.action_client("count", Fibonacci).send({"order": 2})
        assert (await goal.result(timeout=60)) is not None


async def test_goal_of_another_type_than_the_servers_is_refused(
    server: fibws.Node, client: fibws.Node
) -> None:
    await server.action_server("fibonacci", Fibonacci, count, over="operations")
    other = client.action_client(
        "fibonacci", "action_tutorials_interfaces/Fibonacci", over="operations"
    )
    await other.wait_for_server(timeout=60)
    goal = await other.send({"order": 1})
    with pytest.raises(fibws.ActionError, match="is of type actionlib_tutorials/Fibonacci"):
        await goal.result(timeout=60)


async def test_unknown_action_type_has_a_suggestion(server: fibws.Node) -> None:
    with pytest.raises(fibws.InterfaceError, match="did you mean actionlib_tutorials/Fibonacci"):
        server.action_client("fibonacci", "actionlib_tutorials/Fibonaci")
