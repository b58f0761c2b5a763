"""Bags between fibws and ROS's rosbag, which record and play on one graph."""

from __future__ import annotations

import asyncio
import re
import signal
from pathlib import Path
from typing import NamedTuple

import pytest

import fibws
from fibws.bags import open_reader, open_writer
from fibws.interfaces import Interfaces
from fibws.msg.geometry_msgs import PointStamped
from fibws.msg.std_msgs import Header, Int32, String

from .world import Program, World, until

pytestmark = pytest.mark.real_ros

COUNT = 20
TOPICS = ("/numbers", "/map", "/points")
START = 1_700_000_000 * 10**9
LIMIT = ("-l", str(COUNT))
"""Lets a recorder end when it has all messages."""
PLAY = ("-d", "0.5", "-r", "10", "--wait-for-subscribers")


class Entry(NamedTuple):
    """A message of a bag with its connection."""

    topic: str
    type: str
    md5sum: str
    callerid: str
    latching: bool
    data: bytes


def entries(path: Path) -> list[Entry]:
    with open_reader(path) as bag:
        return sorted(
            Entry(each.topic, each.type, each.md5sum, each.callerid, each.latching, data)
            for each, _, data in bag.messages(TOPICS)
        )


def write(path: Path) -> Path:
    """Write a bag of fibws: 20 numbers, points and latched texts in 2 s."""
    interfaces = Interfaces()

    with open_writer(path, "lz4") as bag:
        connections = {
            topic: bag.connection(
                topic,
                type_,
                interfaces.md5(type_),
                interfaces.full_text(type_),
                callerid="/robot",
                latching=topic == "/map",
            )
            for topic, type_ in zip(
                TOPICS, (Int32._type, String._type, PointStamped._type), strict=True
            )
        }
        for number in range(COUNT):
            time = START + (number + 1) * 10**8
            bag.write(connections["/map"], time, b"\x04\0\0\0here")
            bag.write(connections["/numbers"], time, number.to_bytes(4, "little"))
            header = number.to_bytes(4, "little") + bytes(12)
            bag.write(connections["/points"], time, header + bytes(24))
    return path


async def our_bag(ros: World, command: str, *words: str) -> Program:
    return await ros.our(command, "-m", "fibws", "bag", command, *words)


async def is_subscribed(node: fibws.Node, topics: tuple[str, ...] = TOPICS) -> None:
    """Wait until topics have subscribers besides this node."""
    for topic in topics:

        async def has_others(topic: str = topic) -> bool:
            return bool(set(await node.graph.subscribers(topic)) - {node.name})

        await until(has_others)


async def stop(program: Program) -> None:
    program.process.send_signal(signal.SIGINT)
    assert await program.ended() == 0


@pytest.mark.parametrize("compression", ["", "--bz2", "--lz4"])
async def test_bag_of_rosbag_is_played_and_recorded_again(
    ros: World, tmp_path: Path, compression: str
) -> None:
    first, second = tmp_path / "first.bag", tmp_path / "second.bag"
    async with fibws.Node("robot", hub=ros.url) as node:
        words = ("-O", str(first), *LIMIT, *filter(None, [compression]), *TOPICS)
        recorder = await ros.program("/usr/lib/rosbag/record", *words)
        numbers = await node.advertise("/numbers", Int32, peers=True)
        texts = await node.advertise("/map", String, latch=True, peers=True)
        points = await node.advertise("/points", PointStamped, peers=True)
        await is_subscribed(node)
        for publisher in (numbers, texts, points):
            async for names in publisher.peers.changes():
                if names:  # The recorder has connected.
                    break
        for number in range(COUNT):
            await numbers.publish(number)
            await texts.publish(f"here {number}")
            await points.publish(header=Header(frame_id="map"))
        assert await recorder.ended() == 0
    expected = entries(first)
    assert {each.topic for each in expected} == set(TOPICS)
    again = await our_bag(ros, "record", "-O", str(second), *LIMIT, *TOPICS)
    await again.found("Subscribing to /points")
    player = await our_bag(ros, "play", str(first), *PLAY)
    assert await player.ended() == 0
    assert await again.ended() == 0
    assert entries(second) == expected


async def test_rosbag_plays_a_bag_of_fibws(ros: World, tmp_path: Path) -> None:
    source, target = write(tmp_path / "a.bag"), tmp_path / "b.bag"
    recorder = await our_bag(ros, "record", "-O", str(target), *LIMIT, *TOPICS)
    await recorder.found("Subscribing to /points")
    await ros.program("/usr/lib/topic_tools/relay", "/map", "/map_again", "__name:=relay")
    async with fibws.Node("ear", hub=ros.url) as node:
        await is_subscribed(node, ("/map",))
        relayed = node.subscribe("/map_again", String)
        player = await ros.program("/usr/lib/rosbag/play", str(source), "-q", *PLAY)
        async with asyncio.timeout(60):
            assert (await anext(relayed)).data == "here"
        assert await player.ended() == 0
    assert await recorder.ended() == 0
    # As in ROS, its messages have the player's name.
    assert [each._replace(callerid="") for each in entries(target)] == [
        each._replace(callerid="") for each in entries(source)
    ]


async def test_rosbag_records_what_fibws_plays(ros: World, tmp_path: Path) -> None:
    source, target = write(tmp_path / "a.bag"), tmp_path / "b.bag"
    recorder = await ros.program("/usr/lib/rosbag/record", "-O", str(target), *LIMIT, *TOPICS)
    relay = await ros.program("/usr/lib/topic_tools/relay", "/points", "/again", "__name:=relay")
    async with fibws.Node("ear", hub=ros.url) as node:
        for topic, type_ in zip(TOPICS, (Int32, String, PointStamped), strict=True):
            # The player waits for one subscriber of a topic; the links of all are open before.
            expected = {"/record", "/relay"} if topic == "/points" else {"/record"}
            publisher = await node.advertise(topic, type_, peers=True)
            async for names in publisher.peers.changes():
                if expected <= {re.sub(r"_\d+$", "", each) for each in names}:
                    break
        again = node.subscribe("/again", PointStamped, queue_size=None)
        player = await our_bag(ros, "play", str(source), "--wait-for-subscribers", "-k")
        async with asyncio.timeout(60):
            # The relay advertises its topic with the first message, which is lost then.
            found = [(await anext(again)).header.seq for _ in range(3)]
        assert found == list(range(found[0], found[0] + 3))
        async with asyncio.timeout(60):
            async for message in again:
                if message.header.seq == COUNT - 1:
                    break
        assert await recorder.ended() == 0
        await stop(player)
    relay.kill()
    assert [each._replace(callerid="", latching=False) for each in entries(target)] == [
        each._replace(callerid="", latching=False) for each in entries(source)
    ]


async def test_launch_file_starts_record_and_play(ros: World, tmp_path: Path) -> None:
    source = write(tmp_path / "a.bag")
    launch = tmp_path / "bags.launch"
    launch.write_text(
        f"""<launch>
  <node pkg="rosbag" type="record" name="record" args="-O {tmp_path}/b.bag -L 0 -l 1 /numbers"/>
  <node pkg="rosbag" type="play" name="player" args="{source} --wait-for-subscribers
    --topics /numbers"/>
</launch>
"""
    )
    program = await ros.our("launch", "-m", "fibws", "launch", str(launch))
    assert await program.ended() == 0
    assert [each.data for each in entries(tmp_path / "b.bag")] == [bytes(4)]
