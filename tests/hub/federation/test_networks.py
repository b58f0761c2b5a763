"""Hubs on machines of their own: cables are pulled, hubs killed, networks slow."""

from __future__ import annotations

import asyncio

import pytest
from patience import PATIENCE

import fibws
from fibws.msg.sensor_msgs import Image
from fibws.msg.std_msgs import Int32, String

from .conftest import StartNode, peers_are
from .networks import StartMachine
from .networks import start_machine as start_machine
from .networks import switch as switch
from .test_federation import exchange

pytestmark = pytest.mark.slow
"""Machines are network namespaces, with hubs that start as programs and cables that take time."""
BOTH = pytest.mark.parametrize("start_machine", ["websocket", "zenoh"], indirect=True)
"""Runs a test with hubs that are joined by WebSockets, and with hubs on a zenoh network."""


@BOTH
async def test_messages_of_three_machines_in_a_line_arrive_once_and_in_order(
    start_machine: StartMachine, start_node: StartNode
) -> None:
    first = await start_machine("first")
    second = await start_machine("second", first)
    third = await start_machine("third", second)
    await exchange([first, second, third], start_node)


@BOTH
async def test_messages_of_three_machines_in_a_triangle_arrive_once_and_in_order(
    start_machine: StartMachine, start_node: StartNode
) -> None:
    first = await start_machine("first")
    second = await start_machine("second", first)
    third = await start_machine("third", first, second)
    await exchange([first, second, third], start_node)


async def test_messages_of_ten_machines_in_a_star_arrive_once_and_in_order(
    start_machine: StartMachine, start_node: StartNode
) -> None:
    center = await start_machine("center")
    others = await asyncio.gather(*(start_machine(f"hub{n}", center) for n in range(9)))
    await exchange([center, *others], start_node, 50)


@BOTH
async def test_nodes_of_a_killed_hub_vanish_before_its_lease_has_ended(
    start_machine: StartMachine, start_node: StartNode
) -> None:
    lease = 10.0 * PATIENCE
    first = await start_machine("first", lease=lease)
    second = await start_machine("second", first, lease=lease)
    third = await start_machine("third", second, lease=lease)
    talker = await start_node("talker", third)
    await talker.advertise("chatter", String)
    near = (await start_node("near", second)).subscribe("chatter", String, peers=True)
    far = (await start_node("far", first)).subscribe("chatter", String, peers=True)
    await asyncio.gather(peers_are(near, {"/talker"}), peers_are(far, {"/talker"}))
    await third.kill()
    await asyncio.gather(peers_are(near, set()), peers_are(far, set()))


@BOTH
async def test_nodes_vanish_when_a_cable_is_pulled_and_return_when_it_is_plugged(
    start_machine: StartMachine, start_node: StartNode
) -> None:
    cloud = await start_machine("cloud")
    robot = await start_machine("robot", cloud)
    talker, listener = await start_node("talker", robot), await start_node("listener", cloud)
    publisher = await talker.advertise("numbers", Int32, peers=True)
    subscription = listener.subscribe("numbers", Int32, peers=True)
    await asyncio.gather(peers_are(publisher, {"/listener"}), peers_are(subscription, {"/talker"}))
    robot.pull()  # TCP itself would try for many minutes, much longer than `PATIENCE`.
    await asyncio.gather(peers_are(publisher, set()), peers_are(subscription, set()))
    robot.plug()
    await asyncio.gather(peers_are(publisher, {"/listener"}), peers_are(subscription, {"/talker"}))
    await publisher.publish(data=7)
    async with asyncio.timeout(PATIENCE):
        assert (await anext(aiter(subscription))).data == 7


@BOTH
async def test_older_node_survives_when_a_partition_heals_and_both_hubs_log_it(
    start_machine: StartMachine, start_node: StartNode
) -> None:
    cloud = await start_machine("cloud")
    robot = await start_machine("robot", cloud)
    older = await start_node("twin", cloud)
    await older.advertise("cloud_numbers", Int32)
    watcher = await start_node("watcher", robot)
    of_cloud = watcher.subscribe("cloud_numbers", Int32, peers=True)
    await peers_are(of_cloud, {"/twin"})
    robot.pull()
    await peers_are(of_cloud, set())
    younger = await start_node("twin", robot)
    await younger.advertise("robot_numbers", Int32)
    of_robot = watcher.subscribe("robot_numbers", Int32, peers=True)
    await peers_are(of_robot, {"/twin"})
    robot.plug()
    await asyncio.gather(peers_are(of_cloud, {"/twin"}), peers_are(of_robot, set()))
    await cloud.logged("/twin is connected here and at hub robot: this one is older")
    await robot.logged("/twin is connected here and at hub cloud: that one is older")
    with pytest.raises(fibws.FibwsError):
        await younger.advertise("more", Int32)
    await older.advertise("more", Int32)


@pytest.mark.parametrize("source", ["robot", "cloud"])
async def test_messages_overtake_an_image_on_a_slow_link(
    start_machine: StartMachine, start_node: StartNode, source: str
) -> None:
    cloud = await start_machine("cloud")
    robot = await start_machine("robot", cloud)
    near, far = (robot, cloud) if source == "robot" else (cloud, robot)
    robot.slow("10mbit")
    camera, viewer = await start_node("camera", near), await start_node("viewer", far)
    images = await camera.advertise("images", Image, peers=True)
    numbers = await camera.advertise("numbers", Int32, peers=True)
    arrived: asyncio.Queue[int | str] = asyncio.Queue()
    viewer.subscribe("images", Image)._hand_to(lambda _: arrived.put_nowait("image"))
    viewer.subscribe("numbers", Int32)._hand_to(lambda number: arrived.put_nowait(number.data))
    await asyncio.gather(peers_are(images, {"/viewer"}), peers_are(numbers, {"/viewer"}))
    image = Image(data=bytes(640 * 480 * 3))
    async with asyncio.timeout(PATIENCE):
        for number in range(5):
            await images.publish(image)  # It takes the link 0.7 s.
            await numbers.publish(number)
            assert [await arrived.get() for _ in range(2)] == [number, "image"]


async def test_slow_network_drops_only_the_oldest_images_and_the_link_lives(
    start_machine: StartMachine, start_node: StartNode
) -> None:
    cloud = await start_machine("cloud")
    robot = await start_machine("robot", cloud)
    camera, viewer = await start_node("camera", robot), await start_node("viewer", cloud)
    images = await camera.advertise("images", Image, latch=True, queue_size=1, peers=True)
    numbers = await camera.advertise("numbers", Int32, queue_size=1000, peers=True)
    await images.publish(Image(data=bytes(4 * 1024 * 1024)))
    await camera.flush()
    robot.slow("10mbit")
    seen: asyncio.Queue[int] = asyncio.Queue()
    counted: asyncio.Queue[int] = asyncio.Queue()
    viewer.subscribe("images", Image, queue_size=None)._hand_to(
        lambda image: seen.put_nowait(image.height)
    )
    viewer.subscribe("numbers", Int32, queue_size=None)._hand_to(
        lambda number: counted.put_nowait(number.data)
    )
    await asyncio.gather(peers_are(images, {"/viewer"}), peers_are(numbers, {"/viewer"}))
    async with asyncio.timeout(PATIENCE):
        for number in range(1, 101):
            await images.publish(Image(height=number, data=bytes(1024 * 1024)))
            await numbers.publish(number)
        assert [await counted.get() for _ in range(100)] == list(range(1, 101))
        arrived = [await seen.get()]
        while arrived[-1] != 100:
            arrived.append(await seen.get())
    assert arrived[0] == 0
    assert arrived == sorted(arrived)
    assert len(arrived) < 20
    assert not [line for line in robot.log if "Not joined" in line]
