"""The hub as a substitute for ROS's master, for programs that are not nodes."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from typing import Any, TypeVar

import pytest
import rosgraph
from rosgraph import Master, MasterError, MasterFailure

import fibws
from ros1.rospy.programs import running_hub

T = TypeVar("T")


async def ask(function: Callable[..., T], *arguments: Any) -> T:
    """Ask in another thread, since the hub is in this one."""
    return await asyncio.to_thread(function, *arguments)


@pytest.fixture
def nobody(monkeypatch: pytest.MonkeyPatch) -> None:
    """No hub runs."""
    monkeypatch.setenv("FIBWS_HUB", "ws://127.0.0.1:1")


@pytest.mark.usefixtures("nobody")
def test_master_is_offline_without_a_hub() -> None:
    assert not rosgraph.is_master_online()
    with pytest.raises(OSError, match="No hub at"):
        Master("/tool").getUri()
    with pytest.raises(OSError, match="No hub at"):
        Master("/tool").getSystemState()


async def test_master_gets_and_sets_parameters(monkeypatch: pytest.MonkeyPatch) -> None:
    async with running_hub() as programs:
        monkeypatch.setenv("FIBWS_HUB", programs.hub.url)
        master = Master("/robot/tool")
        assert await ask(rosgraph.is_master_online)
        assert await ask(master.getUri) == programs.hub.url
        assert await ask(master.setParam, "speed", 1.5) == 0
        assert await ask(master.getParam, "/robot/speed") == 1.5
        assert await ask(master.hasParam, "speed")
        assert "/robot/speed" in await ask(master.getParamNames)
        assert await ask(master.searchParam, "run_id") == "/run_id"
        assert await ask(master.deleteParam, "speed") == 0
        for method in master.getParam, master.deleteParam:
            with pytest.raises(MasterError, match=r"\[/robot/speed\] is not set"):
                await ask(method, "speed")
        with pytest.raises(MasterError, match="Cannot find parameter"):
            await ask(master.searchParam, "speed")
        with pytest.raises(MasterError, match="cannot delete root"):
            await ask(master.deleteParam, "/")
        with pytest.raises(MasterFailure, match="private"):
            await ask(master.searchParam, "~speed")


async def test_master_reports_the_graph(monkeypatch: pytest.MonkeyPatch) -> None:
    async with running_hub() as programs, fibws.Node("talker", hub=programs.hub.url) as node:
        monkeypatch.setenv("FIBWS_HUB", programs.hub.url)
        await node.advertise("chatter", "std_msgs/String")
        node.subscribe("heard", "std_msgs/Int32")
        await node.params.has("x")  # The hub has heard of both now.
        master = Master("/tool")
        published = await ask(master.getPublishedTopics, "/")
        assert ["/chatter", "std_msgs/String"] in published
        assert ["/heard", "std_msgs/Int32"] not in published
        assert await ask(master.getPublishedTopics, "/nothing") == []
        assert ["/heard", "std_msgs/Int32"] in await ask(master.getTopicTypes)
        publishers, subscribers, services = await ask(master.getSystemState)
        assert ["/chatter", ["/talker"]] in publishers
        assert ["/heard", ["/talker"]] in subscribers
        assert ["/talker/get_loggers", ["/talker"]] in services
        assert (await ask(master.lookupNode, "talker")).startswith("http://127.0.0.1:")
        uri = await ask(master.lookupService, "/talker/get_loggers")
        assert uri.startswith("rosrpc://127.0.0.1:")
        with pytest.raises(MasterError, match=r"unknown node \[/nobody\]"):
            await ask(master.lookupNode, "nobody")
        with pytest.raises(MasterError, match="no provider"):
            await ask(master.lookupService, "nothing")
