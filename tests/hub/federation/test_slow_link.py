"""Two hubs with a network between them that takes what the test lets through."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Awaitable, Callable
from typing import Self

import pytest
from conftest import StartHub
from patience import PATIENCE

from fibws.hub.federation import link
from fibws.msg.std_msgs import Int32, String

from .conftest import StartNode, peers_are, until

MIB = 1024 * 1024


class Relay:
    """A network between a hub that joins and another one.

    Attributes:
        url: what the first one joins.
        opened: whether bytes pass from the hub that joins to the other.
    """

    def __init__(self, target: int) -> None:
        self.opened = asyncio.Event()
        self.opened.set()
        self.url = ""
        self._target = target
        self._server: asyncio.Server | None = None
        self._tasks: list[asyncio.Task[None]] = []

    async def start(self) -> Self:
        self._server = await asyncio.start_server(self._accept, "127.0.0.1", 0)
        self.url = "ws://{}:{}".format(*self._server.sockets[0].getsockname())
        return self

    async def _accept(self, near: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        far, other = await asyncio.open_connection("127.0.0.1", self._target)
        self._tasks += (
            asyncio.create_task(_copy(near, other, self.opened.wait)),
            asyncio.create_task(_copy(far, writer, lambda: asyncio.sleep(0))),
        )

    async def close(self) -> None:
        assert self._server is not None
        self._server.close()
        for task in self._tasks:
            task.cancel()
        await asyncio.gather(*self._tasks, return_exceptions=True)


async def _copy(
    reader: asyncio.StreamReader,
    writer: asyncio.StreamWriter,
    may_pass: Callable[[], Awaitable[object]],
) -> None:
    try:
        while data := await reader.read(1 << 14):
            await may_pass()
            writer.write(data)
            await writer.drain()
    except OSError:
        pass
    finally:
        writer.close()


@pytest.fixture
async def relay_to(monkeypatch: pytest.MonkeyPatch) -> AsyncIterator[Callable[[int], Relay]]:
    """Makes networks to ports, on which silence is not taken for the loss of a hub."""
    monkeypatch.setattr(link, "LEASE", 10.0 * PATIENCE)
    relays: list[Relay] = []

    def make(port: int) -> Relay:
        relays.append(Relay(port))
        return relays[-1]

    yield make
    for relay in relays:
        await relay.close()


async def test_slow_link_drops_the_oldest_messages_of_a_latched_topic_and_lives(
    start_hub: StartHub, start_node: StartNode, relay_to: Callable[[int], Relay]
) -> None:
    cloud = await start_hub(hub_name="cloud")
    relay = await relay_to(cloud.port).start()
    robot = await start_hub(hub_name="robot", join=(relay.url,))
    await until(lambda: robot.federation.peers and cloud.federation.peers, robot, cloud)
    link_of_robot = robot.federation.peers[0]
    camera, viewer = await start_node("camera", robot), await start_node("viewer", cloud)
    images = await camera.advertise("images", String, latch=True, queue_size=1, peers=True)
    numbers = await camera.advertise("numbers", Int32, queue_size=1000, peers=True)
    await images.publish("first".ljust(10 * MIB))
    await camera.flush()
    await until(lambda: {"/images", "/numbers"} <= {*cloud.graph.topics}, cloud)

    relay.opened.clear()
    seen: asyncio.Queue[str] = asyncio.Queue()
    counted: asyncio.Queue[int] = asyncio.Queue()
    viewer.subscribe("images", String, queue_size=None)._hand_to(
        lambda image: seen.put_nowait(image.data.rstrip())
    )
    viewer.subscribe("numbers", Int32, queue_size=None)._hand_to(
        lambda number: counted.put_nowait(number.data)
    )
    async with asyncio.timeout(PATIENCE):
        await asyncio.gather(peers_are(images, {"/viewer"}), peers_are(numbers, {"/viewer"}))
        for number in range(100):
            await images.publish(f"{number}".ljust(MIB))
            await numbers.publish(number)
        await camera.flush()
        assert link_of_robot.traffic.dropped >= 80
        relay.opened.set()
        assert [await counted.get() for _ in range(100)] == list(range(100))
        arrived = [await seen.get()]
        while arrived[-1] != "99":
            arrived.append(await seen.get())
    assert arrived[0] == "first"
    assert arrived[1:] == sorted(arrived[1:], key=int)
    assert len(arrived) + link_of_robot.traffic.dropped == 101
    assert robot.federation.peers == [link_of_robot]
