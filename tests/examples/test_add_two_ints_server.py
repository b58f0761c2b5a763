"""The tutorial's service."""

from __future__ import annotations

import signal

import pytest
from running_programs import Start

import fibws
from fibws.hub.server import HubServer
from fibws.srv.rospy_tutorials import AddTwoInts

SERVER = "fibws.examples.add_two_ints_server"


async def test_integers_are_added(hub: HubServer, start: Start) -> None:
    program = await start(SERVER, FIBWS_HUB=hub.url)
    assert await program.line() == "Ready to add two ints.\n"
    async with fibws.Node("test", hub=hub.url) as node:
        await node.wait_for_service("add_two_ints", timeout=60)
        response = await node.call("add_two_ints", AddTwoInts, AddTwoInts.Request(1, 2))
    assert response.sum == 3
    assert await program.line() == "Returning [1 + 2 = 3]\n"
    program.send(signal.SIGINT)
    assert await program.end() == (0, "", "")


async def test_server_continues_after_a_failed_call(hub: HubServer, start: Start) -> None:
    program = await start(SERVER, "--hub", hub.url, "add_two_ints:=add")
    async with fibws.Node("test", hub=hub.url) as node:
        await node.wait_for_service("add", timeout=60)
        try:
            await node.call("add", AddTwoInts, {"a": 2**63 - 1, "b": 1})
        except fibws.ServiceError as error:
            assert "9223372036854775808" in error.text
        else:
            raise AssertionError("the sum does not fit")
        assert (await node.call("add", AddTwoInts, {"a": -1, "b": 1})).sum == 0
    assert "Service /add failed" in await program.error_line()


async def test_closed_pipe_ends_it_quietly(hub: HubServer, start: Start) -> None:
    program = await start(SERVER, "--hub", hub.url)
    await program.line()
    program.stop_reading()
    async with fibws.Node("test", hub=hub.url) as node:
        await node.wait_for_service("add_two_ints", timeout=60)
        with pytest.raises(fibws.ServiceError):
            await node.call("add_two_ints", AddTwoInts)
    assert await program.end() == (0, "", "")


async def test_default_name_is_not_anonymous(hub: HubServer, start: Start) -> None:
    program = await start(SERVER, "--hub", hub.url)
    await program.line()
    async with fibws.Node("test", hub=hub.url) as node:
        await node.wait_for_service("add_two_ints", timeout=60)
        assert await node.graph.service_node("add_two_ints") == "/add_two_ints_server"
