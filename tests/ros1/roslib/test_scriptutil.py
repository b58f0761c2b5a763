"""Scripts see who publishes and subscribes to what."""

from __future__ import annotations

import asyncio

import pytest
from roslib import scriptutil

import fibws
from fibws.hub import Settings
from fibws.hub.server import HubServer
from fibws.msg.std_msgs import String


async def test_publishers_and_subscribers_are_recognized(monkeypatch: pytest.MonkeyPatch) -> None:
    async with HubServer(Settings(port=0)) as hub, fibws.Node("talker", hub=hub.url) as node:
        monkeypatch.setenv("FIBWS_HUB", hub.url)
        await node.advertise("chatter", String)
        async with fibws.Node("listener", hub=hub.url) as other:
            other.subscribe("chatter", String)
            await other.graph.topics()  # so that the hub has heard of both

            def ask() -> list[bool]:
                return [
                    scriptutil.is_publisher("/chatter", "/talker"),
                    scriptutil.is_subscriber("/chatter", "/listener"),
                    scriptutil.is_topic("/chatter"),
                    scriptutil.is_publisher("/chatter", "/listener"),
                    scriptutil.is_subscriber("/other", "/listener"),
                    scriptutil.is_topic("/other"),
                ]

            assert await asyncio.to_thread(ask) == [True, True, True, False, False, False]
