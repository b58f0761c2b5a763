"""Images in a browser: streams, snapshots, pages, and requests that are refused."""

from __future__ import annotations

import asyncio
import re
import signal
from collections.abc import AsyncIterator
from io import BytesIO

import pytest
from running_programs import Start

import fibws
from fibws.hub.server import HubServer
from fibws.msg.sensor_msgs import CompressedImage, Image
from fibws.msg.std_msgs import Header, Int32

TOPIC = "/camera/image/compressed"


@pytest.fixture
async def node(hub: HubServer) -> AsyncIterator[fibws.Node]:
    async with fibws.Node("test", hub=hub.url) as node:
        yield node


@pytest.fixture
async def port(hub: HubServer, start: Start) -> int:
    hub.graph.parameters.set("/web_video_server/port", 0)
    program = await start("fibws.programs.web_video_server", FIBWS_HUB=hub.url)
    while (found := re.search(r"http://127\.0\.0\.1:(\d+)/", line := await program.line())) is None:
        assert line, "the server has ended"
    return int(found[1])


OPEN: list[asyncio.StreamWriter] = []
"""The connections of a test."""


@pytest.fixture(autouse=True)
async def closed() -> AsyncIterator[None]:
    yield
    for writer in OPEN:
        writer.close()
    await asyncio.gather(*(writer.wait_closed() for writer in OPEN), return_exceptions=True)
    OPEN.clear()


class Browser:
    """A connection with one request."""

    def __init__(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        self._reader = reader
        self.writer = writer
        self.headers: dict[str, str] = {}

    @classmethod
    async def get(
        cls, port: int, path: str, host: str = "localhost", method: str = "GET"
    ) -> Browser:
        reader, writer = await asyncio.open_connection("127.0.0.1", port)
        OPEN.append(writer)
        writer.write(f"{method} {path} HTTP/1.1\r\nHost: {host}\r\n\r\n".encode())
        return cls(reader, writer)

    async def status(self) -> int:
        status, *lines = (await self._reader.readuntil(b"\r\n\r\n")).decode().splitlines()
        self.headers = dict(line.lower().split(": ", 1) for line in lines if line)
        return int(status.split()[1])

    async def body(self) -> bytes:
        return await self._reader.read()

    async def frame(self) -> bytes:
        """The next part of a multipart response."""
        head = (await self._reader.readuntil(b"\r\n\r\n")).decode()
        found = re.search(r"Content-Length: (\d+)", head)
        assert found is not None and "--fibws-frame" in head
        return await self._reader.readexactly(int(found[1]))


async def answer(port: int, path: str, host: str = "localhost") -> tuple[int, str]:
    browser = await Browser.get(port, path, host)
    return await browser.status(), (await browser.body()).decode(errors="replace")


async def test_stream_has_the_images_of_the_topic(port: int, node: fibws.Node) -> None:
    images = await node.advertise(TOPIC, CompressedImage, latch=True, peers=True)
    await images.publish(CompressedImage(format="jpeg", data=b"\xff\xd8 first"))
    browser = await Browser.get(port, f"/stream?topic={TOPIC}")
    assert await browser.status() == 200
    assert browser.headers["content-type"].startswith("multipart/x-mixed-replace; boundary=")
    assert await browser.frame() == b"\xff\xd8 first"
    await images.publish(CompressedImage(format="png", data=b"\x89PNG second"))
    assert await browser.frame() == b"\x89PNG second"
    other = await Browser.get(port, f"/stream?topic={TOPIC}")
    assert await other.status() == 200
    assert await other.frame() == b"\x89PNG second"
    browser.writer.close()
    other.writer.close()
    async for names in images.peers.changes():
        if "/web_video_server" not in names:
            break


async def test_server_ends_quietly_while_somebody_views(
    hub: HubServer, start: Start, node: fibws.Node
) -> None:
    hub.graph.parameters.set("/web_video_server/port", 0)
    program = await start("fibws.programs.web_video_server", FIBWS_HUB=hub.url)
    port = int((await program.line()).rpartition(":")[2].strip("/\n"))
    images = await node.advertise(TOPIC, CompressedImage, latch=True)
    await images.publish(CompressedImage(data=b"image"))
    browser = await Browser.get(port, f"/stream?topic={TOPIC}")
    await browser.status()
    await browser.frame()
    program.send(signal.SIGTERM)
    assert (await program.end())[::2] == (0, "")


async def test_slow_viewer_gets_the_newest_image(port: int, node: fibws.Node) -> None:
    images = await node.advertise(TOPIC, CompressedImage, latch=True)
    big = bytes(2_000_000)
    await images.publish(CompressedImage(data=b"0" + big))
    slow = await Browser.get(port, f"/stream?topic={TOPIC}")
    quick = await Browser.get(port, f"/stream?topic={TOPIC}")
    await quick.status()
    for number in range(1, 6):
        await quick.frame()
        await images.publish(CompressedImage(data=f"{number}".encode() + big))
    assert (await quick.frame())[:1] == b"5"
    await slow.status()
    seen = [(await slow.frame())[:1]]
    while seen[-1] != b"5":
        seen.append((await slow.frame())[:1])
    assert len(seen) < 6


async def test_viewer_that_sends_without_end_is_served(port: int, node: fibws.Node) -> None:
    images = await node.advertise(TOPIC, CompressedImage, latch=True)
    await images.publish(CompressedImage(data=b"first"))
    browser = await Browser.get(port, f"/stream?topic={TOPIC}")
    await browser.status()
    assert await browser.frame() == b"first"
    for _ in range(100):
        browser.writer.write(bytes(100_000))
        await browser.writer.drain()
    await images.publish(CompressedImage(data=b"second"))
    assert await browser.frame() == b"second"


async def test_snapshot_and_pages(port: int, node: fibws.Node) -> None:
    images = await node.advertise(TOPIC, CompressedImage, latch=True)
    await images.publish(CompressedImage(data=b"one image"))
    assert await answer(port, f"/snapshot?topic={TOPIC}") == (200, "one image")
    assert await answer(port, "/snapshot?topic=/camera/image&type=ros_compressed") == (
        *(200, "one image"),
    )
    status, page = await answer(port, "/")
    assert status == 200
    assert f"/stream_viewer?topic={TOPIC}" in page
    status, page = await answer(port, '/stream_viewer?topic=/a"><script>')
    assert (status, "<script>" in page) == (200, False)
    head = await Browser.get(port, f"/snapshot?topic={TOPIC}", method="HEAD")
    assert await head.status() == 200
    assert await head.body() == b""


async def test_image_that_is_not_compressed_becomes_a_jpeg(port: int, node: fibws.Node) -> None:
    pillow = pytest.importorskip("PIL.Image")
    images = await node.advertise("/camera/image", Image, latch=True)
    red = bytes([0, 0, 250]) * 16
    await images.publish(Image(Header(), 4, 4, "bgr8", 0, 12, red))
    browser = await Browser.get(port, "/snapshot?topic=/camera/image&quality=95")
    assert await browser.status() == 200
    picture = pillow.open(BytesIO(await browser.body()))
    assert picture.size == (4, 4)
    assert all(abs(a - b) < 9 for a, b in zip(picture.getpixel((1, 1)), (250, 0, 0), strict=True))
    await images.publish(Image(Header(), 4, 4, "32FC1", 0, 16, bytes(64)))
    status, text = await answer(port, "/snapshot?topic=/camera/image")
    assert (status, "32FC1" in text) == (415, True)
    await images.publish(Image(Header(), 9999, 9999, "rgb8", 0, 12, red))
    status, _ = await answer(port, "/snapshot?topic=/camera/image&quality=50")
    assert status == 415
    await images.publish(Image(Header(), 9999, 9999, "rgb8", 0, 0, red))
    status, text = await answer(port, "/snapshot?topic=/camera/image&quality=51")
    assert (status, "a row has 0 bytes" in text) == (415, True)
    for quality in ("0", "101", "00019999", "0001" + "9" * 5000, "%D9%A3"):
        status, text = await answer(port, f"/snapshot?topic=/camera/image&quality={quality}")
        assert (status, "1 to 100" in text) == (400, True)


async def test_stream_goes_on_after_an_image_that_cannot_be_shown(
    port: int, node: fibws.Node
) -> None:
    pytest.importorskip("PIL.Image")
    images = await node.advertise("/camera/image", Image, latch=True)
    good = Image(Header(), 4, 4, "bgr8", 0, 12, bytes(48))
    await images.publish(good)
    browser = await Browser.get(port, "/stream?topic=/camera/image")
    assert await browser.status() == 200
    first = await browser.frame()
    for bad in (
        Image(Header(), 4, 4, "32FC1", 0, 16, bytes(64)),
        Image(Header(), 9999, 9999, "bgr8", 0, 12, bytes(48)),
    ):
        await images.publish(bad)
        status, _ = await answer(port, "/snapshot?topic=/camera/image&quality=50")
        assert status == 415
        await images.publish(good)
        assert await browser.frame() == first


async def test_requests_that_cannot_be_served_say_why(port: int, node: fibws.Node) -> None:
    await node.advertise("/number", Int32)
    await node.advertise(TOPIC, CompressedImage)
    for path, status, text in (
        ("/stream", 400, "?topic="),
        ("/stream?topic=/a//b c", 400, "Bad"),
        ("/stream?topic=1/a", 400, "1/a"),
        ("/stream?topic=/camera/imag/compressed", 404, TOPIC),
        ("/stream?topic=/number", 415, "std_msgs/Int32"),
        ("/nothing", 404, "/stream"),
        ("//[", 400, ""),
    ):
        found = await answer(port, path)
        assert found[0] == status, found
        assert text in found[1] or status == 400
    for host in ("evil.example", "[", ""):
        assert (await answer(port, "/", host=host))[0] == 403
    post = await Browser.get(port, "/", method="POST")
    assert await post.status() == 405
    long = await Browser.get(port, f"/{'a' * 100_000}")
    assert await long.status() == 400


async def test_taken_port_is_an_error(port: int, hub: HubServer, start: Start) -> None:
    hub.graph.parameters.set("/other/port", port)
    program = await start("fibws.programs.web_video_server", "__name:=other", FIBWS_HUB=hub.url)
    code, _, err = await program.end()
    assert code == 1
    assert str(port) in err
