"""What a joined hub may not see is not on the wire, and looks absent when it asks."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Iterator
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Any

import pytest
from conftest import StartHub
from patience import PATIENCE

import fibws
from fibws.access.rights import Rights
from fibws.access.token_file import TokenFile
from fibws.hub.federation.backplane import Peer
from fibws.hub.federation.federation import Federation
from fibws.hub.federation.records import Announcement, Reply, Request
from fibws.hub.server import HubServer
from fibws.msg.rosgraph_msgs import Log
from fibws.msg.std_msgs import String
from fibws.srv.std_srvs import Trigger

from .conftest import until


class Robots:
    """A hub with tokens, and one that has joined it with few rights.

    Attributes:
        admin: the token of an operator.
        announced: all that the other hub was told, as text.
    """

    def __init__(
        self, cloud: HubServer, robot: HubServer, admin: str, announced: list[str]
    ) -> None:
        self.cloud = cloud
        self.robot = robot
        self.admin = admin
        self.announced = announced

    async def ask(self, op: str, **fields: Any) -> Reply:
        """Return the cloud's reply to a request of the robot's hub."""
        (peer,) = self.robot.federation.peers
        reply = asyncio.get_running_loop().create_future()
        peer.backplane.request(peer, Request(op, fields), reply.set_result)
        return await asyncio.wait_for(reply, PATIENCE)


@pytest.fixture
async def robots(
    start_hub: StartHub, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> AsyncIterator[Robots]:
    path, announced, announce = tmp_path / "tokens.toml", list[str](), Federation.announced

    def record(self: Federation, peer: Peer, announcement: Announcement) -> Iterator[None]:
        if self.hub.name == "robot":
            announced.append(str(announcement))
        return announce(self, peer, announcement)

    monkeypatch.setattr(Federation, "announced", record)
    admin = TokenFile(path).add("operator", Rights(admin=True))
    link = TokenFile(path).add("link", Rights({"subscribe": ["/open/**", "/rosout"]}))
    cloud = await start_hub(hub_name="cloud", tokens=path)
    url = f"{cloud.url}/?token={link}"
    async with fibws.Node("arm", namespace="/hid", hub=cloud.url, token=admin) as node:
        await node.advertise("topic", String, latch=True)
        node.subscribe("/rosout", Log)
        await node.service("srv", Trigger, lambda request: {})
        cloud.graph.set_parameter("/hid/arm", "/hid/param", 1)
        robot = await start_hub(hub_name="robot", join=(url,))
        await until(lambda: robot.federation.peers, robot)
        yield Robots(cloud, robot, admin, announced)


@asynccontextmanager
async def shown(robots: Robots) -> AsyncIterator[fibws.Node]:
    """Add a node that the other hub sees, and wait until it does."""
    async with fibws.Node(
        "mark", namespace="/open", hub=robots.cloud.url, token=robots.admin
    ) as node:
        await node.advertise("mark", String)
        await until(lambda: "/open/mark" in robots.robot.graph.topics, robots.robot)
        yield node


async def test_hidden_names_are_not_announced(robots: Robots) -> None:
    async with shown(robots):
        assert any("/open/mark" in each for each in robots.announced)
        assert [each for each in robots.announced if "hid" in each] == []


async def test_node_that_becomes_visible_is_announced_among_the_users_of_the_log(
    robots: Robots,
) -> None:
    async with shown(robots) as node:
        other = fibws.Node("late", namespace="/hid", hub=robots.cloud.url, token=robots.admin)
        async with other:
            await node.advertise("another", String)
            await until(lambda: "/open/another" in robots.robot.graph.topics, robots.robot)
            assert not any("/hid/late" in each for each in robots.announced)
            await other.advertise("/open/late", String)
            await until(lambda: "/hid/late" in robots.robot.graph.nodes, robots.robot)
            log = robots.robot.graph.topics["/rosout"]
            await until(lambda: "/hid/late" in log.sources, robots.robot)


@pytest.mark.parametrize(
    "operation",
    [
        {"op": "call", "service": "{}"},
        {"op": "goal", "action": "{}", "goal": "1"},
        {"op": "ping_node", "node": "{}"},
        {"op": "kill_node", "node": "{}"},
    ],
)
async def test_requests(robots: Robots, operation: dict[str, str]) -> None:
    replies = []
    for name in ("/hid/arm", "/hid/srv", "/hid/topic", "/hid/none"):
        reply = await robots.ask(**{key: each.format(name) for key, each in operation.items()})
        replies.append(str(reply).replace(name, "NAME"))
    assert set(replies) == {replies[0]}


async def test_types(robots: Robots) -> None:
    graph = robots.cloud.graph
    topic = graph.topic("/hid/typed")
    source = graph.advertise(topic, "/hid/arm", "hidden_msgs/Thing", "int32 x")
    replies = [
        str(await robots.ask("describe", kind="msg", type=f"hidden_msgs/{name}"))
        for name in ("Thing", "Other")
    ]
    graph.remove_source(source)
    assert replies[0] == replies[1].replace("Other", "Thing")
