"""What a hub does that cannot join another one, by the reason."""

from __future__ import annotations

import asyncio
import http
import logging
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager, suppress

import pytest
from conftest import StartHub
from patience import PATIENCE
from websockets.asyncio.server import ServerConnection, serve
from websockets.datastructures import Headers
from websockets.exceptions import ConnectionClosed
from websockets.http11 import Request, Response
from websockets.typing import Subprotocol

from fibws.hub.federation import connections
from fibws.hub.federation import link as links
from fibws.hub.federation.retries import (
    LOST,
    OVERLOADED,
    REFUSED,
    STABLE,
    Pace,
    Retries,
    pace_of_close,
    pace_of_status,
    seconds_asked,
)

from .test_link import HELLO, record, request

CODES = {
    1000: LOST,
    1001: LOST,
    1002: OVERLOADED,
    1003: OVERLOADED,
    1006: LOST,
    1007: OVERLOADED,
    1008: OVERLOADED,
    1009: OVERLOADED,
    1011: LOST,
    1012: LOST,
    1013: OVERLOADED,
    4001: REFUSED,
    4002: REFUSED,
    4401: REFUSED,
    4403: REFUSED,
    4429: OVERLOADED,
    4999: REFUSED,
}
STATUSES = {
    200: REFUSED,
    400: REFUSED,
    401: REFUSED,
    403: REFUSED,
    404: REFUSED,
    407: REFUSED,
    426: REFUSED,
    429: OVERLOADED,
    500: OVERLOADED,
    502: LOST,
    503: OVERLOADED,
    504: LOST,
}
TRIES = 8


@pytest.mark.parametrize(("code", "pace"), CODES.items())
def test_pace_after_a_close(code: int, pace: Pace) -> None:
    assert pace_of_close(code) is pace


@pytest.mark.parametrize(("status", "pace"), STATUSES.items())
def test_pace_after_a_refused_handshake(status: int, pace: Pace) -> None:
    assert pace_of_status(status) is pace


def test_delays_grow_and_vary() -> None:
    late, early = Retries(lambda: 1.0), Retries(lambda: 0.0)
    assert [late.delay(LOST) for _ in range(7)] == [0.1, 0.2, 0.4, 0.8, 1.6, 2.0, 2.0]
    assert [late.delay(OVERLOADED) for _ in range(7)] == [1, 2, 4, 8, 16, 30, 30]
    assert [late.delay(REFUSED) for _ in range(3)] == [30, 30, 30]
    for pace in (LOST, OVERLOADED, REFUSED):
        assert early.delay(pace) == pytest.approx(0.7 * pace.first)


def test_delay_that_the_other_hub_asks_for_is_waited() -> None:
    retries = Retries(lambda: 0.0)
    assert retries.delay(OVERLOADED, 20.0) == 20.0
    assert retries.delay(OVERLOADED, 1e9) == 120.0
    assert [seconds_asked(text) for text in ("5", None, "", "-5", "Wed, 21 Oct", "1" * 99)] == [
        *(5.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    ]


def test_limits_that_are_passed_again_and_again_are_met_ever_later() -> None:
    retries = Retries(lambda: 1.0)
    for expected in (1, 2, 4):
        retries.joined()
        retries.worked(STABLE / 2)
        assert retries.delay(OVERLOADED) == expected
    retries.joined()
    retries.worked(STABLE)
    assert retries.delay(OVERLOADED) == 1


def test_fault_is_new_once_until_a_connection_has_worked() -> None:
    retries = Retries()
    assert retries.is_new(OVERLOADED, "try again in 5 s")
    assert not retries.is_new(OVERLOADED, "try again in 4 s")
    assert retries.is_new(LOST, "lost")
    retries.joined()
    assert retries.is_new(LOST, "lost")
    assert not retries.is_new(OVERLOADED, "try again in 3 s")
    retries.worked(STABLE)
    assert retries.is_new(OVERLOADED, "try again in 2 s")


Refuse = Callable[[ServerConnection, Request], Response | None]


@asynccontextmanager
async def other_end(
    handle: Callable[[ServerConnection], Awaitable[None]], refuse: Refuse | None = None
) -> AsyncIterator[str]:
    """The end of links to which a hub connects; yields its URL."""
    protocol = Subprotocol(links.SUBPROTOCOL)
    server = serve(
        handle,
        "127.0.0.1",
        0,
        subprotocols=[protocol],
        compression=None,
        process_request=refuse,
    )
    async with server as listening:
        yield "ws://{}:{}".format(*next(iter(listening.sockets)).getsockname())


class Delays:
    """The seconds that a hub waits before it tries again; after `TRIES` it tries no more."""

    def __init__(self) -> None:
        self.waited: list[float] = []
        self.is_full = asyncio.Event()

    async def sleep(self, seconds: float) -> None:
        self.waited.append(seconds)
        if len(self.waited) >= TRIES:
            self.is_full.set()
            await asyncio.Event().wait()


@pytest.fixture
def delays(monkeypatch: pytest.MonkeyPatch) -> Delays:
    found = Delays()
    monkeypatch.setattr(connections, "sleep", found.sleep)
    return found


async def check(
    start_hub: StartHub,
    delays: Delays,
    caplog: pytest.LogCaptureFixture,
    url: str,
    pace: Pace,
    fault: str,
) -> None:
    """Have a hub join, and compare when it tries again and what it says about it."""
    hub = await start_hub(join=(url,))
    async with asyncio.timeout(PATIENCE):
        await delays.is_full.wait()
    most = [min(pace.first * 2**index, pace.longest) for index in range(TRIES)]
    for waited, limit in zip(delays.waited, most, strict=True):
        assert 0.7 * limit <= waited <= limit
    logged = [each.message for each in caplog.records if "Not joined" in each.message]
    assert len(logged) == 1
    assert fault in logged[0]
    assert ("every 30 s" in logged[0]) is (pace is REFUSED)
    (link,) = hub._broken_links()
    assert fault in link["fault"]


@pytest.mark.parametrize(("status", "pace"), STATUSES.items())
async def test_refused_handshake_is_tried_again_and_logged_once(
    start_hub: StartHub,
    delays: Delays,
    caplog: pytest.LogCaptureFixture,
    status: int,
    pace: Pace,
) -> None:
    counted = iter(range(1000))

    def refuse(connection: ServerConnection, request: Request) -> Response:
        text = f"try again in {1000 - next(counted)} s".encode()
        headers = Headers({"Content-Length": str(len(text))})
        return Response(status, http.HTTPStatus(status).phrase, headers, text)

    async def handle(connection: ServerConnection) -> None:
        raise AssertionError("it was refused")

    async with other_end(handle, refuse) as url:
        await check(start_hub, delays, caplog, url, pace, f"HTTP {status}: try again in")


@pytest.mark.parametrize(
    ("code", "pace"), [each for each in CODES.items() if each[0] not in (1006, 4999)]
)
async def test_closed_connection_is_tried_again_and_logged_once(
    start_hub: StartHub,
    delays: Delays,
    caplog: pytest.LogCaptureFixture,
    code: int,
    pace: Pace,
) -> None:
    async def handle(connection: ServerConnection) -> None:
        await connection.close(code, "for a reason")

    async with other_end(handle) as url:
        await check(start_hub, delays, caplog, url, pace, "for a reason")


@pytest.mark.parametrize("code", [1008, 1013, 4403, 4429])
async def test_hub_that_is_closed_each_time_it_has_joined_waits_ever_longer(
    start_hub: StartHub, delays: Delays, caplog: pytest.LogCaptureFixture, code: int
) -> None:
    async def handle(connection: ServerConnection) -> None:
        caplog.set_level(logging.INFO)
        with suppress(ConnectionClosed):
            await connection.send(record(links.HELLO, HELLO))
            while True:
                data, at = await connection.recv(decode=False), 0
                while at < len(data):
                    size, kind = int.from_bytes(data[at : at + 4], "little"), data[at + 4]
                    if kind == links.PING:
                        time = data[at + 5 : at + 4 + size]
                        await connection.send(record(links.PONG, time + time))
                        await connection.send(request(1, op="describe"))
                    if kind == links.REPLY:  # It has got the answer to its ping before.
                        await connection.close(code, "for a reason")
                    at += 4 + size

    async with other_end(handle) as url:
        await check(start_hub, delays, caplog, url, pace_of_close(code), "for a reason")


async def test_hub_that_is_not_there_is_tried_every_two_seconds(
    start_hub: StartHub, delays: Delays, caplog: pytest.LogCaptureFixture
) -> None:
    server = await asyncio.start_server(lambda reader, writer: None, "127.0.0.1", 0)
    url = "ws://{}:{}".format(*server.sockets[0].getsockname())
    server.close()
    await server.wait_closed()
    await check(start_hub, delays, caplog, url, LOST, "failed")
