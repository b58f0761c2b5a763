"""What clients have left with the hub ends with their rights to it.

Each kind of thing that the hub keeps for a client, and each way in which the client loses its
right: the token is revoked, or has expired, the right is withdrawn, the client changes to another
token, or its node is killed, by which no right is lost.
"""

from __future__ import annotations

from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import AsyncExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeAlias

import pytest
from conftest import StartHub
from websockets.exceptions import ConnectionClosed

from fibws.hub.server import HubServer
from fibws.protocol.websocket import EXPIRED, KILLED

from ..fakes import FIBONACCI, INT32, number
from ..token_clients import Client, World, closing, entry

TRIGGER = "std_srvs/Trigger"
EVERYTHING = (
    'publish = ["/**"], subscribe = ["/**"], call = ["/**"], provide = ["/**"], node = ["/**"]'
)
OTHERS = entry("watcher", f"allow = {{{EVERYTHING}}}") + entry("boss", "admin = true")
LESS = entry("less", 'allow = {node = ["/**"]}')
OWN = entry("user", f"expires = 2099-01-01\nallow = {{{EVERYTHING}}}")
BEFORE = OTHERS + LESS + OWN


@dataclass(frozen=True)
class Scene:
    """A hub, the client that loses its rights, and one that notices it."""

    hub: HubServer
    tokens: Path
    user: Client
    watcher: Client
    boss: Client

    def reload(self, text: str) -> None:
        self.tokens.write_text(text, "utf-8")
        self.hub.reload()


@pytest.fixture
async def scene(start_hub: StartHub, tmp_path: Path) -> AsyncIterator[Scene]:
    tokens = tmp_path / "tokens.toml"
    tokens.write_text(BEFORE, "utf-8")
    hub = await start_hub(tokens=tokens)
    async with AsyncExitStack() as stack:
        world = World(hub, stack)
        user = await world.client("user", "/user", serialized=True)
        watcher = await world.client("watcher", "/watcher", serialized=True)
        yield Scene(hub, tokens, user, watcher, await world.client("boss"))


# How rights are lost. Each returns once that has happened.


async def revoke(scene: Scene) -> None:
    scene.reload(OTHERS + LESS)
    assert (await closing(scene.user.connection))[0] == 4401


async def withdraw(scene: Scene) -> None:
    scene.reload(BEFORE.replace(OWN, entry("user", 'allow = {node = ["/**"]}')))


async def expire(scene: Scene) -> None:
    for connection in scene.hub._connections:
        object.__setattr__(connection._shared, "now", lambda: 5e9)
    assert (await closing(scene.user.connection))[0] == EXPIRED.code


async def change(scene: Scene) -> None:
    await scene.user.answers("set_level", level="error")
    await scene.user.send("auth", token="less")
    await scene.user.send("call_service", service="/rosapi/get_time", id="changed")
    while (await scene.user.receive("service_response"))["id"] != "changed":
        pass


async def kill(scene: Scene) -> None:
    assert (await scene.boss.values("/rosapi/kill_node", node="/user"))["success"]
    assert (await closing(scene.user.connection))[0] == KILLED.code


WAYS = [revoke, withdraw, expire, change, kill]
Way: TypeAlias = Callable[[Scene], Awaitable[None]]


# What is left with the hub.


@pytest.fixture(params=WAYS, ids=lambda way: way.__name__)
def lose(request: pytest.FixtureRequest) -> Way:
    way: Way = request.param
    return way


async def of_user(scene: Scene, op: str) -> list[dict[str, Any]]:
    """Return the operations of a kind that the client has got; none if it was closed."""
    try:
        found = await scene.user.answers("set_level", level="error")
    except ConnectionClosed:
        return []
    return [each for each in found if each["op"] == op]


async def of_watcher(scene: Scene, op: str) -> list[dict[str, Any]]:
    return [
        each for each in await scene.watcher.answers("set_level", level="error") if each["op"] == op
    ]


async def test_will_is_published_only_by_a_client_that_still_may(scene: Scene, lose: Way) -> None:
    await scene.watcher.does("subscribe", topic="/cmd", type=INT32)
    await scene.user.does("set_will", topic="/cmd", type=INT32, msg=number(1))
    await scene.user.does("set_will", topic="/rosout", msg={"msg": "will"})
    await lose(scene)
    await scene.user.connection.close()
    assert "/user" not in scene.hub.graph.nodes
    messages = [each["msg"] for each in await of_watcher(scene, "publish")]
    assert messages == ([number(1)] if lose is kill else [])


async def test_call_ends_with_the_right_to_it(scene: Scene, lose: Way) -> None:
    await scene.watcher.does("advertise_service", service="/slow", type=TRIGGER)
    await scene.user.send("call_service", service="/slow", id="1")
    call = await scene.watcher.receive("call_service")
    await lose_and_collect(scene, lose, "service_response")
    await scene.watcher.send(
        "service_response", service="/slow", id=call["id"], values={"success": True}, result=True
    )
    assert await of_watcher(scene, "status") == []
    assert await of_user(scene, "service_response") == []


async def test_goal_is_cancelled_with_the_right_to_it(scene: Scene, lose: Way) -> None:
    await scene.watcher.does("advertise_action", action="/dock", type=FIBONACCI)
    goal = {"action": "/dock", "action_type": FIBONACCI, "feedback": True}
    await scene.user.send("send_action_goal", id="1", args={"order": 1}, **goal)
    id_ = (await scene.watcher.receive("send_action_goal"))["id"]
    await lose_and_collect(scene, lose, "action_result")
    assert (await scene.watcher.receive("cancel_action_goal"))["id"] == id_
    values = {"sequence": [1]}
    await scene.watcher.send("action_feedback", action="/dock", id=id_, values=values)
    end = {"values": values, "status": 4, "result": True}
    await scene.watcher.send("action_result", action="/dock", id=id_, **end)
    assert await of_watcher(scene, "status") == []
    assert await of_user(scene, "action_feedback") == []
    assert await of_user(scene, "action_result") == []


async def lose_and_collect(scene: Scene, lose: Way, op: str) -> None:
    """Lose the rights; a client that stays is told by an error that what it waits for has ended."""
    if lose in (withdraw, change):
        if lose is withdraw:
            await lose(scene)
        else:
            await scene.user.send("auth", token="less")
        told = await scene.user.receive(op)
        assert (told["id"], told["result"], told["code"]) == ("1", False, "not_allowed")
        assert "missing right call" in told["values"]
    else:
        await lose(scene)


async def test_latched_message_goes_with_the_right_to_publish(scene: Scene, lose: Way) -> None:
    await scene.user.does("advertise", topic="/map", type=INT32, latch=True)
    await scene.user.does("publish", topic="/map", msg=number(1))
    await lose(scene)
    await scene.watcher.answers("subscribe", topic="/map", type=INT32)
    assert await of_watcher(scene, "publish") == []


async def test_subscription_ends_with_the_right_to_it(scene: Scene, lose: Way) -> None:
    await scene.user.does("subscribe", topic="/scan", type=INT32)
    await lose(scene)
    await scene.watcher.does("advertise", topic="/scan", type=INT32)
    await scene.watcher.does("publish", topic="/scan", msg=number(1))
    assert await of_user(scene, "publish") == []
    assert not scene.hub.graph.topics["/scan"].subscribers()


async def test_publication_ends_with_the_right_to_it(scene: Scene, lose: Way) -> None:
    await scene.watcher.does("subscribe", topic="/cmd", type=INT32)
    await scene.user.does("advertise", topic="/cmd", type=INT32)
    await lose(scene)
    assert not scene.hub.graph.topics["/cmd"].sources


async def test_service_and_its_calls_end_with_the_right_to_it(scene: Scene, lose: Way) -> None:
    await scene.user.does("advertise_service", service="/served", type=TRIGGER)
    await scene.watcher.send("call_service", service="/served", id="1")
    await scene.user.receive("call_service")
    await lose(scene)
    response = await scene.watcher.receive("service_response")
    assert (response["id"], response["result"], response["code"]) == ("1", False, "server_lost")
    assert "/served" not in scene.hub.graph.services


async def test_action_and_its_goals_end_with_the_right_to_it(scene: Scene, lose: Way) -> None:
    await scene.user.does("advertise_action", action="/done", type=FIBONACCI)
    goal = {"action": "/done", "action_type": FIBONACCI}
    await scene.watcher.send("send_action_goal", id="1", args={"order": 1}, **goal)
    await scene.user.receive("send_action_goal")
    await lose(scene)
    result = await scene.watcher.receive("action_result")
    assert (result["id"], result["result"], result["code"]) == ("1", False, "server_lost")
    assert "/done" not in scene.hub.graph.actions


async def test_server_that_loses_its_right_is_told_to_cancel(scene: Scene) -> None:
    await scene.user.does("advertise_action", action="/done", type=FIBONACCI)
    goal = {"action": "/done", "action_type": FIBONACCI}
    await scene.watcher.send("send_action_goal", id="1", args={"order": 1}, **goal)
    id_ = (await scene.user.receive("send_action_goal"))["id"]
    await withdraw(scene)
    assert (await scene.user.receive("cancel_action_goal"))["id"] == id_


async def test_displaced_server_loses_the_calls_that_it_still_has(scene: Scene) -> None:
    await scene.user.does("advertise_service", service="/served", type=TRIGGER)
    await scene.boss.send("call_service", service="/served", id="1")
    call = await scene.user.receive("call_service")
    session = scene.hub.graph.nodes["/user"]
    async with AsyncExitStack() as stack:
        newer = await World(scene.hub, stack).client("user", "/newer")
        await newer.answers("advertise_service", service="/served", type=TRIGGER)
        await withdraw(scene)
        response = await scene.boss.receive("service_response")
        assert (response["id"], response["result"]) == ("1", False)
        late = {"id": call["id"], "values": {"success": True}, "result": True}
        await scene.user.answers("service_response", service="/served", **late)
    assert scene.hub.graph.nodes["/user"] is session


async def test_node_that_a_new_token_may_not_be_publishes_no_will(scene: Scene) -> None:
    await scene.watcher.does("subscribe", topic="/cmd", type=INT32)
    await scene.user.does("set_will", topic="/cmd", type=INT32, msg=number(1))
    scene.reload(BEFORE.replace(LESS, entry("less", 'allow = {node = ["/x"]}')))
    await scene.user.send("auth", token="less")
    assert (await closing(scene.user.connection))[0] == 4403
    assert await of_watcher(scene, "publish") == []


async def test_will_is_published_for_a_client_that_is_one_too_many(scene: Scene) -> None:
    await scene.watcher.does("subscribe", topic="/cmd", type=INT32)
    async with AsyncExitStack() as stack:
        other = await World(scene.hub, stack).client("user", "/other", serialized=True)
        for client in (scene.user, other):  # Either may be the one that is closed.
            await client.does("set_will", topic="/cmd", type=INT32, msg=number(1))
        limits = "limits = {connections = 1}\nallow"
        scene.reload(BEFORE.replace(OWN, OWN.replace("allow", limits)))
        assert (await scene.watcher.receive("publish"))["msg"] == number(1)
        assert len({"/user", "/other"} & scene.hub.graph.nodes.keys()) == 1
