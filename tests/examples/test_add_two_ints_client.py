"""The tutorial's client."""

from __future__ import annotations

from running_programs import Start

import fibws
from fibws.hub.server import HubServer
from fibws.srv.rospy_tutorials import AddTwoInts

CLIENT = "fibws.examples.add_two_ints_client"


async def test_client_waits_for_the_server_and_prints_the_sum(hub: HubServer, start: Start) -> None:
    client = await start(CLIENT, "1", "2", "--hub", hub.url)
    server = await start("fibws.examples.add_two_ints_server", "--hub", hub.url)
    assert await client.end() == (0, "Requesting 1+2\n1 + 2 = 3\n", "")
    assert await server.line() == "Ready to add two ints.\n"
    assert await server.line() == "Returning [1 + 2 = 3]\n"


async def test_negative_numbers_and_renamed_service(hub: HubServer, start: Start) -> None:
    async with fibws.Node("test", hub=hub.url) as node:
        await node.service("add", AddTwoInts, lambda request: request.a + request.b)
        client = await start(CLIENT, "-7", "-2", "add_two_ints:=add", FIBWS_HUB=hub.url)
        assert await client.end() == (0, "Requesting -7+-2\n-7 + -2 = -9\n", "")


async def test_failed_call_is_an_error_in_one_line(hub: HubServer, start: Start) -> None:
    def fail(request: object) -> int:
        raise ValueError("I cannot add")

    async with fibws.Node("test", hub=hub.url) as node:
        await node.service("add_two_ints", AddTwoInts, fail)
        client = await start(CLIENT, "1", "2", "--hub", hub.url)
        code, out, err = await client.end()
    assert (code, out) == (1, "Requesting 1+2\n")
    assert err == "Error: /add_two_ints: error processing request: ValueError: I cannot add\n"


async def test_too_large_number_is_an_error(hub: HubServer, start: Start) -> None:
    async with fibws.Node("test", hub=hub.url) as node:
        await node.service("add_two_ints", AddTwoInts, lambda request: request.a + request.b)
        client = await start(CLIENT, str(2**63), "2", "--hub", hub.url)
        code, _, err = await client.end()
    assert code == 1
    assert "field a" in err
    assert "Traceback" not in err


async def test_invalid_number_is_an_error(start: Start) -> None:
    client = await start(CLIENT, "one", "2")
    code, _, err = await client.end()
    assert code == 2
    assert "'one' is not a valid integer" in err


async def test_unknown_option_is_an_error(start: Start) -> None:
    client = await start(CLIENT, "1", "2", "--hbu", "ws://127.0.0.1:9")
    code, _, err = await client.end()
    assert code == 2
    assert "unexpected argument '--hbu'" in err
