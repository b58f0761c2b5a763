"""Hubs and nodes keep nothing of names that are gone, whoever watches."""

from __future__ import annotations

import asyncio
import gc
import json
from collections.abc import AsyncIterator, Callable
from contextlib import AsyncExitStack
from pathlib import Path
from typing import Any, Protocol

import pytest
from conftest import StartHub
from patience import PATIENCE
from websockets.asyncio.client import ClientConnection, connect
from websockets.typing import Subprotocol

import fibws
from fibws.action.action_tutorials_interfaces import Fibonacci
from fibws.hub.server import HubServer
from fibws.msg.std_msgs import String
from fibws.srv.std_srvs import Trigger

from .leftovers import leftovers

pytest.importorskip("zenoh")
pytest.importorskip("xxhash")

from .ros2.peer import Peer
from .zenoh_endpoints import ANY_PORT, listens_at, zenoh_config

GONE = "gone_thing"
"""A part of all names that are to leave nothing."""


async def until(condition: Callable[[], object]) -> None:
    async with asyncio.timeout(PATIENCE):
        while not condition():  # noqa: ASYNC110 - nothing reports all of it.
            await asyncio.sleep(0.01)


async def check_nothing_is_left(*roots: object) -> None:
    """Wait until nothing of `GONE` is left; fail with what is."""
    found: list[str] = []
    try:
        async with asyncio.timeout(PATIENCE / 4):
            while found := _left(*roots):  # noqa: ASYNC110 - nothing reports it.
                await asyncio.sleep(0.1)
    except TimeoutError:
        pytest.fail("still there:\n" + "\n".join(found))


def _left(*roots: object) -> list[str]:
    gc.collect()
    return leftovers(GONE, *roots)


class Foxglove:
    """A client of Foxglove's protocol that follows everything."""

    def __init__(self, connection: ClientConnection) -> None:
        self._connection = connection
        self.ids: dict[str, set[int]] = {"channels": set(), "services": set()}
        """The channels and services that it knows of."""

    async def run(self) -> None:
        for operation in (
            {"op": "subscribeConnectionGraph"},
            {"op": "subscribeParameterUpdates", "parameterNames": []},
        ):
            await self._connection.send(json.dumps(operation))
        async for text in self._connection:
            if isinstance(text, str):
                self._receive(json.loads(text))

    def _receive(self, received: dict[str, Any]) -> None:
        match received["op"]:
            case "advertise" | "advertiseServices":
                kind = "channels" if received["op"] == "advertise" else "services"
                for each in received[kind]:
                    if GONE in json.dumps(each):
                        self.ids[kind].add(each["id"])
            case "unadvertise":
                self.ids["channels"] -= set(received["channelIds"])
            case "unadvertiseServices":
                self.ids["services"] -= set(received["serviceIds"])


class World:
    """Two joined hubs that clients of every protocol watch, on one of which things come and go."""

    def __init__(
        self, stack: AsyncExitStack, cloud: HubServer, robot: HubServer, endpoint: str
    ) -> None:
        self._stack = stack
        self.cloud = cloud
        self.robot = robot
        self._endpoint = endpoint
        self.foxgloves: list[Foxglove] = []
        self.peer: Peer

    async def tokens(self) -> list[str]:
        """Return the tokens on the zenoh network that have such a name."""
        liveliness = self.peer.session.liveliness()
        replies = await asyncio.to_thread(lambda: list(liveliness.get("@ros2_lv/**")))
        keys = [str(each.ok.key_expr) for each in replies if each.ok is not None]
        return sorted(key for key in keys if GONE in key)

    @property
    def hubs(self) -> tuple[HubServer, HubServer]:
        return self.cloud, self.robot

    async def start(self) -> None:
        enter = self._stack.enter_async_context
        for hub in self.hubs:
            protocols = [Subprotocol("foxglove.websocket.v1")]
            client = Foxglove(await enter(connect(hub.url, subprotocols=protocols, max_size=None)))
            self.foxgloves.append(client)
            task = asyncio.create_task(client.run())
            self._stack.callback(task.cancel)
        node = await enter(fibws.Node("watcher", hub=self.cloud.url))
        await node.advertise("kept", String, peers=True)
        node.subscribe("kept", String, peers=True)
        self.peer = await enter(Peer(self._endpoint))
        await until(lambda: all(hub.federation.peers for hub in self.hubs))


@pytest.fixture
async def world(start_hub: StartHub, tmp_path: Path) -> AsyncIterator[World]:
    config = zenoh_config(tmp_path)
    settings = {"service_timeout": 0}  # A call with a deadline is kept until then.
    cloud = await start_hub(
        hub_name="cloud", ros1=0, ros2=(ANY_PORT,), zenoh_config=config, **settings
    )
    assert cloud.ros2 is not None
    robot = await start_hub(hub_name="robot", join=(cloud.url,), **settings)
    async with AsyncExitStack() as stack:
        world = World(stack, cloud, robot, await listens_at(cloud.ros2.network._session))
        await world.start()
        yield world


class Closable(Protocol):
    """A registration of a node."""

    def close(self) -> None: ...


def close_all(*registrations: Closable) -> None:
    for each in registrations:
        each.close()


async def execute(goal: fibws.ServerGoal) -> Fibonacci.Result:
    await goal.publish_feedback({"partial_sequence": [0, 1]})
    return Fibonacci.Result(sequence=[0, 1])


@pytest.mark.parametrize("over", ["topics", "operations"])
@pytest.mark.parametrize("has_left", [False, True])
async def test_nothing_is_left_of_what_is_gone(
    world: World, over: fibws.Over, *, has_left: bool
) -> None:
    part = GONE if has_left else "kept"
    cloud, robot = world.hubs
    async with AsyncExitStack() as stack:
        server = await stack.enter_async_context(fibws.Node(f"{part}_server", hub=robot.url))
        user = await stack.enter_async_context(fibws.Node(f"{part}_user", hub=cloud.url))
        publisher = await server.advertise(f"{GONE}_topic", String, latch=True)
        subscription = user.subscribe(f"{GONE}_topic", String)
        unused = user.subscribe(f"{GONE}_unused", String)
        kept = await server.advertise("kept", String, peers=True)
        listening = user.subscribe("kept", String, peers=True)
        service = await server.service(
            f"{GONE}_service", Trigger, lambda request: {"success": True, "message": GONE}
        )
        action = await server.action_server(f"{GONE}_action", Fibonacci, execute, over=over)
        await server.params.set(f"/{GONE}_parameter", 1)
        async with asyncio.timeout(PATIENCE):
            await publisher.publish(data=GONE)
            assert (await anext(aiter(subscription))).data == GONE
            await user.wait_for_service(f"/{GONE}_service")
            assert (await user.call(f"/{GONE}_service", Trigger)).success
            client = user.action_client(f"{GONE}_action", Fibonacci, over=over)
            await client.wait_for_server()
            goal = await client.send({"order": 5})
            assert list((await goal.result()).sequence) == [0, 1]
            await until(lambda: all(all(each.ids.values()) for each in world.foxgloves))
        assert await world.tokens()
        assert leftovers(GONE, cloud)
        assert leftovers(GONE, robot)
        await server.params.delete(f"/{GONE}_parameter")
        if not has_left:
            close_all(publisher, kept, subscription, unused, listening, client, service, action)
            del publisher, kept, subscription, unused, listening, client, service, action, goal
            await check_nothing_is_left(cloud, robot, server, user)
    await check_nothing_is_left(cloud, robot)
    async with asyncio.timeout(PATIENCE):
        while await world.tokens():  # noqa: ASYNC110 - they are asked for.
            await asyncio.sleep(0.01)
    await until(lambda: not any(any(each.ids.values()) for each in world.foxgloves))
