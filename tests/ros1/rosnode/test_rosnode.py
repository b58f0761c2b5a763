"""rosnode's functions for scripts."""

from __future__ import annotations

import asyncio
import re
from collections.abc import AsyncIterator

import pytest
import rosnode

import fibws
from fibws.hub.server import HubServer


@pytest.fixture(autouse=True)
async def talker(hub: HubServer, monkeypatch: pytest.MonkeyPatch) -> AsyncIterator[fibws.Node]:
    monkeypatch.setenv("FIBWS_HUB", hub.url)
    async with fibws.Node("talker", namespace="/robot", hub=hub.url) as node:
        await node.advertise("chatter", "std_msgs/String")
        node.subscribe("words", "std_msgs/String")
        await node.graph.nodes()
        yield node


async def test_nodes_are_listed() -> None:
    assert "/robot/talker" in await asyncio.to_thread(rosnode.get_node_names)
    assert await asyncio.to_thread(rosnode.get_node_names, "/robot") == ["/robot/talker"]
    assert await asyncio.to_thread(rosnode.get_node_names, "/rob") == []


async def test_node_answers_a_ping(capsys: pytest.CaptureFixture[str]) -> None:
    assert await asyncio.to_thread(rosnode.rosnode_ping, "/robot/talker", 2, verbose=True)
    first, *replies, average = capsys.readouterr().out.splitlines()
    assert first == "pinging /robot/talker with a timeout of 3.0s"
    assert len(replies) == 2
    assert re.fullmatch(r"reply from http://127\.0\.0\.1:\d+/\ttime=\d+\.\d{6}ms", replies[0])
    assert average.startswith("ping average: ")


async def test_unknown_node_does_not_answer_a_ping(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert not await asyncio.to_thread(rosnode.rosnode_ping, "nobody", 1)
    assert capsys.readouterr().err == "cannot ping [/nobody]: unknown node\n"


async def test_all_nodes_answer_a_ping(capsys: pytest.CaptureFixture[str]) -> None:
    answered, silent = await asyncio.to_thread(rosnode.rosnode_ping_all, verbose=True)
    assert "/robot/talker" in answered
    assert silent == []
    assert " * /robot/talker\n" in capsys.readouterr().out


async def test_node_is_killed(talker: fibws.Node) -> None:
    killed = await asyncio.to_thread(rosnode.kill_nodes, ["/robot/talker", "/nobody"])
    assert killed == (["/robot/talker"], ["/nobody"])
    with pytest.raises(fibws.NodeKilled):
        await talker.spin()


async def test_node_is_described() -> None:
    text = await asyncio.to_thread(rosnode.get_node_info_description, "/robot/talker")
    assert text.startswith("Node [/robot/talker]\nPublications: \n * /robot/chatter [std_msgs/Str")
    assert "\nSubscriptions: \n * /robot/words [std_msgs/String]\n" in text
    text = await asyncio.to_thread(rosnode.get_node_info_description, "/nobody")
    assert text == ("Node [/nobody]\nPublications: None\n\nSubscriptions: None\n\nServices: None\n")


@pytest.mark.parametrize(
    "ask",
    [
        rosnode.get_node_names,
        rosnode.rosnode_ping_all,
        lambda: rosnode.rosnode_ping("/talker"),
        lambda: rosnode.kill_nodes(["/talker"]),
        lambda: rosnode.get_node_info_description("/talker"),
    ],
)
async def test_missing_hub_is_an_error(ask: object, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("FIBWS_HUB", "ws://127.0.0.1:1")
    assert callable(ask)
    with pytest.raises(rosnode.ROSNodeIOException, match=r"master! .*127\.0\.0\.1:1"):
        await asyncio.to_thread(ask)
