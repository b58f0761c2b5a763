"""The action and the service of tf2_web_republisher."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import suppress
from dataclasses import dataclass
from itertools import count
from math import inf, nan
from typing import Any, Literal, TypeAlias

import pytest
from patience import PATIENCE

import fibws
from fibws.action import tf2_web_republisher, tf2_web_republisher_interfaces
from fibws.hub.server import HubServer
from fibws.interfaces import Action
from fibws.msg.actionlib_msgs import GoalID, GoalStatusArray
from fibws.msg.rosgraph_msgs import Log
from fibws.msg.tf2_web_republisher import (
    TFArray,
    TFSubscriptionActionFeedback,
    TFSubscriptionActionGoal,
    TFSubscriptionGoal,
)
from fibws.srv.tf2_web_republisher import RepublishTFs
from fibws.tf import republisher as module
from fibws.tf.republisher import Republisher
from fibws.tf.subscribers import Subscribers

from .conftest import Place, Publish, places

pytestmark = pytest.mark.usefixtures("republisher")

ACTION = "/tf2_web_republisher"
ACTIVE = fibws.GoalStatus.ACTIVE
Client: TypeAlias = fibws.ActionClient[Any, Any, Any]
ClientGoal: TypeAlias = fibws.ClientGoal[Any, Any]
Line: TypeAlias = Callable[[str], Awaitable[Log]]


@dataclass(frozen=True)
class Way:
    """The transport of goals, and the status of canceled ones."""

    over: Literal["topics", "operations"]
    action: type[Action[Any, Any, Any]]
    canceled: fibws.GoalStatus

    def client(self, node: fibws.Node) -> Client:
        return node.action_client(ACTION, self.action, over=self.over)


ROS1 = Way("topics", tf2_web_republisher.TFSubscription, fibws.GoalStatus.PREEMPTED)
ROS2 = Way("operations", tf2_web_republisher_interfaces.TFSubscription, fibws.GoalStatus.SUCCEEDED)


def wish(*frames: str, target: str = "map", rate: float = 50, thresholds: float = 0.01) -> Any:
    return {
        "source_frames": list(frames),
        "target_frame": target,
        "angular_thres": thresholds,
        "trans_thres": thresholds,
        "rate": rate,
    }


async def open_topic(node: fibws.Node, *frames: str, patience: float = 5, **others: Any) -> str:
    """Call the service; the new topic's name."""
    request = RepublishTFs.Request(
        **wish(*frames, **others), timeout=fibws.Duration.from_sec(patience)
    )
    return (await node.call("/republish_tfs", RepublishTFs, request)).topic_name


@pytest.fixture(params=[ROS1, ROS2], ids=lambda way: way.over)
def way(request: pytest.FixtureRequest) -> Way:
    found: Way = request.param
    return found


@pytest.fixture
async def client(node: fibws.Node, way: Way) -> AsyncIterator[Client]:
    async with way.client(node) as client:
        await client.wait_for_server(timeout=PATIENCE)
        yield client


async def next_places(messages: AsyncIterator[Any]) -> list[Place]:
    """The transforms in the next array or feedback."""
    async with asyncio.timeout(PATIENCE):
        return places((await anext(messages)).transforms)


async def end(goal: ClientGoal) -> fibws.GoalStatus:
    """Wait for the end of a goal; return its status."""
    with suppress(fibws.ActionError):
        await goal.result(timeout=PATIENCE)
    return goal.status


async def fault(goal: ClientGoal) -> str:
    """Wait for the failure of a goal; return its text."""
    with pytest.raises(fibws.ActionError) as caught:
        await goal.result(timeout=PATIENCE)
    return str(caught.value)


# The service


async def test_call_opens_a_topic(node: fibws.Node, publish: Publish) -> None:
    names = [await open_topic(node, frame) for frame in ("base", "arm")]
    assert names == [f"{ACTION}/tf_repub_0", f"{ACTION}/tf_repub_1"]
    base, arm = (node.subscribe(name, TFArray) for name in names)
    await publish(("arm", "base", 10), ("base", "map", 1))
    assert await next_places(base) == [("base", "map", 1)]
    assert await next_places(arm) == [("arm", "map", 11)]


async def test_stamp_is_the_time_of_publishing(node: fibws.Node, publish: Publish) -> None:
    arrays = node.subscribe(await open_topic(node, "camera"), TFArray)
    before = node.now()
    await publish(("camera", "map", 1), static=True)
    async with asyncio.timeout(PATIENCE):
        (transform,) = (await anext(arrays)).transforms
    assert before < transform.header.stamp < node.now()


async def test_only_changes_above_the_threshold_are_published(
    node: fibws.Node, publish: Publish
) -> None:
    arrays = node.subscribe(await open_topic(node, "/arm", "/base", target="/map"), TFArray)
    await publish(("base", "map", 1), ("arm", "map", 1))
    assert await next_places(arrays) == [("arm", "map", 1), ("base", "map", 1)]
    for x in count(2):
        await publish(("base", "map", 1 + 0.009 * (x % 2)), ("arm", "map", x))
        while ("arm", "map", x) not in (received := await next_places(arrays)):
            pass
        if len(received) == 1:  # The republisher may learn of the subscriber late.
            break


async def test_with_a_threshold_of_0_all_transforms_are_published(
    node: fibws.Node, publish: Publish
) -> None:
    arrays = node.subscribe(await open_topic(node, "base", thresholds=0), TFArray)
    await publish(("base", "map", 1))
    for _ in range(5):
        assert await next_places(arrays) == [("base", "map", 1)]


async def test_late_subscriber_receives_all_transforms(
    node: fibws.Node, publish: Publish, client: Client
) -> None:
    witness = (await client.send(wish("arm"))).feedback()
    name = await open_topic(node, "base", "arm", rate=1000)
    await publish(("base", "map", 1))
    for x in (2, 3, 4):
        await publish(("arm", "map", x))
        assert await next_places(witness) == [("arm", "map", x)]
    arrays = node.subscribe(name, TFArray)
    assert ("base", "map", 1) in await next_places(arrays)


async def test_second_subscriber_receives_all_transforms(
    hub: HubServer, node: fibws.Node, publish: Publish
) -> None:
    name = await open_topic(node, "base", "arm")
    async with fibws.Node("first", hub=hub.url) as first:
        arrays = first.subscribe(name, TFArray)
        for frame in ("base", "arm"):
            await publish((frame, "map", 1))
            while (frame, "map", 1) not in await next_places(arrays):
                pass
    async with fibws.Node("second", hub=hub.url) as second:
        arrays = second.subscribe(name, TFArray)
        while ("base", "map", 1) not in await next_places(arrays):
            pass


@pytest.mark.long
async def test_topic_is_closed_after_the_timeout_without_subscribers(
    node: fibws.Node, publish: Publish, line: Line
) -> None:
    await publish(("base", "map", 1))
    name = await open_topic(node, "base", patience=0.2)
    with_listener = node.subscribe(name, TFArray)
    await next_places(with_listener)
    other = await open_topic(node, "base", patience=0.2)
    assert other in (await line("Closed")).msg
    topics = await node.graph.topics()
    assert name in topics
    assert other not in topics
    with_listener.close()
    assert name in (await line("Closed")).msg
    assert name not in await node.graph.topics()


@pytest.mark.parametrize(
    ("asked", "reason"),
    [
        ({"rate": 0}, "rate .* got 0"),
        ({"rate": -1}, "rate .* got -1"),
        ({"rate": 1001}, "rate .* got 1001"),
        ({"rate": nan}, "rate .* got nan"),
        ({"patience": 0}, "timeout .* got 0 s"),
        ({"patience": -1.5}, "timeout .* got -1.5 s"),
        ({"target": ""}, "a frame's id is empty"),
        ({"thresholds": nan}, "a threshold"),
    ],
)
@pytest.mark.long
async def test_invalid_call_is_an_error(
    node: fibws.Node, asked: dict[str, Any], reason: str
) -> None:
    with pytest.raises(fibws.ServiceError, match=reason):
        await open_topic(node, "base", **asked)
    assert ACTION + "/tf_repub_0" not in await node.graph.topics()


async def test_number_of_topics_is_limited(
    node: fibws.Node, line: Line, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "MAX_TOPICS", 1)
    await open_topic(node, "base", patience=0.2)
    with pytest.raises(fibws.ServiceError, match="limit 1"):
        await open_topic(node, "base")
    await line("Closed")
    await open_topic(node, "base")


# The action


async def test_goal_gets_changes_until_it_is_canceled(
    publish: Publish, way: Way, client: Client
) -> None:
    goal = await client.send(wish("base"))
    feedback = goal.feedback()
    for x in (1.0, 2.0):
        await publish(("base", "map", x))
        assert await next_places(feedback) == [("base", "map", x)]
    await goal.cancel()
    assert await end(goal) is way.canceled


async def test_goals_are_independent(publish: Publish, client: Client) -> None:
    forth = await client.send(wish("base"))
    back = await client.send(wish("map", target="base"))
    await publish(("base", "map", 1))
    assert await next_places(forth.feedback()) == [("base", "map", 1)]
    assert await next_places(back.feedback()) == [("map", "base", -1)]
    await forth.cancel()
    await end(forth)
    await publish(("base", "map", 2))
    assert await next_places(back.feedback()) == [("map", "base", -2)]


@pytest.mark.parametrize(
    ("asked", "reason"),
    [
        ({"rate": 0}, "rate must"),
        ({"rate": inf}, "rate must"),
        ({"target": "/"}, "id is empty"),
    ],
)
async def test_invalid_goal_is_aborted(client: Client, asked: dict[str, Any], reason: str) -> None:
    goal = await client.send(wish("base", **asked))
    assert reason in await fault(goal)
    assert goal.status is fibws.GoalStatus.ABORTED


async def test_oldest_goal_is_aborted_at_the_limit(
    publish: Publish, client: Client, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "MAX_GOALS", 2)
    first, *others = [await client.send(wish("base")) for _ in range(3)]
    assert "limit 2" in await fault(first)
    await publish(("base", "map", 1))
    for goal in others:
        assert await next_places(goal.feedback()) == [("base", "map", 1)]


async def test_limit_counts_goals_over_topics_and_operations(
    node: fibws.Node, publish: Publish, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "MAX_GOALS", 1)
    await publish(("base", "map", 1))
    async with ROS1.client(node) as over_topics, ROS2.client(node) as over_operations:
        await over_topics.wait_for_server(timeout=PATIENCE)
        older = await over_topics.send(wish("base"))
        await next_places(older.feedback())
        newer = await over_operations.send(wish("base"))
        assert "newer goal" in await fault(older)
        assert await next_places(newer.feedback()) == [("base", "map", 1)]


async def test_goal_over_topics_pauses_without_subscribers(
    node: fibws.Node, publish: Publish
) -> None:
    await publish(("base", "map", 1), ("arm", "map", 2))
    statuses = node.subscribe(f"{ACTION}/status", GoalStatusArray)
    goals = await node.advertise(f"{ACTION}/goal", TFSubscriptionActionGoal)
    goal = TFSubscriptionGoal(**wish("base", "arm"))
    await goals.publish(TFSubscriptionActionGoal(goal_id=GoalID(id="page"), goal=goal))
    async with asyncio.timeout(PATIENCE):
        while [each.status for each in (await anext(statuses)).status_list] != [ACTIVE]:
            pass
        # When this has come, there could have been feedback, too.
        await next_places(node.subscribe(await open_topic(node, "base"), TFArray))
        subscription = node.subscribe(f"{ACTION}/feedback", TFSubscriptionActionFeedback)
        feedback = await anext(subscription)
    assert feedback.status.goal_id.id == "page"
    assert places(feedback.feedback.transforms) == [("base", "map", 1), ("arm", "map", 2)]


async def test_subscribers_are_watched_only_while_there_are_goals_over_topics(
    node: fibws.Node, publish: Publish, monkeypatch: pytest.MonkeyPatch
) -> None:
    watching: list[Subscribers] = []

    async def watch(subscribers: Subscribers) -> None:
        watching.append(subscribers)
        try:
            await asyncio.Event().wait()
        finally:
            watching.remove(subscribers)

    monkeypatch.setattr(Subscribers, "watch", watch)
    await publish(("base", "map", 1))
    async with ROS1.client(node) as client:
        await client.wait_for_server(timeout=PATIENCE)
        numbers = [len(watching)]
        goals = [await client.send(wish("base")) for _ in range(2)]
        for goal in goals:
            await next_places(goal.feedback())
        numbers.append(len(watching))
        for goal in goals:
            await goal.cancel()
            assert await end(goal) is ROS1.canceled
            numbers.append(len(watching))
    assert numbers == [0, 1, 1, 0]


async def test_action_can_be_renamed(hub: HubServer, node: fibws.Node, publish: Publish) -> None:
    await publish(("base", "map", 1))
    renamed = fibws.parse_remappings(["/transforms:=/frames", "republish_tfs:=/others"])
    async with fibws.Node("transforms", hub=hub.url, remapping=renamed) as other:
        serving = asyncio.create_task(Republisher(other).run())
        async with node.action_client("/frames", tf2_web_republisher.TFSubscription) as client:
            await client.wait_for_server(timeout=PATIENCE)
            await publish(("base", "map", 1))
            goal = await client.send(wish("base"))
            assert await next_places(goal.feedback()) == [("base", "map", 1)]
        serving.cancel()


# Both


async def test_error_of_the_node_ends_it(hub: HubServer, node: fibws.Node) -> None:
    async with fibws.Node("transforms", hub=hub.url) as other:
        serving = asyncio.create_task(Republisher(other).run())
        client = node.action_client("/transforms", tf2_web_republisher.TFSubscription)
        await client.wait_for_server(timeout=PATIENCE)
        async with fibws.Node("transforms", hub=hub.url):
            with pytest.raises(fibws.NodeReplaced, match="took the name /transforms"):
                await asyncio.wait_for(serving, PATIENCE)
