"""Pictures of cameras on the page of their topic."""

from __future__ import annotations

import asyncio
import io
import math
import struct
from collections.abc import AsyncIterator
from contextlib import suppress
from typing import Any

import pytest
from patience import PATIENCE
from PIL import Image as pillow
from playwright.async_api import Browser, Page, expect

import fibws
from fibws.hub.server import HubServer
from fibws.msg.nav_msgs import MapMetaData, OccupancyGrid
from fibws.msg.rosgraph_msgs import Clock
from fibws.msg.sensor_msgs import CompressedImage, Image
from fibws.msg.std_msgs import Header
from fibws.protocol.serialized import SUBPROTOCOL

from .conftest import OpenPage, fixture, traced, until

COLORS = [(255, 0, 0), (0, 255, 0), (0, 0, 255), (255, 255, 0)]
"""Those of the four quarters: top left, top right, bottom left, bottom right."""
WIDTH, HEIGHT = 40, 20
SIZE = f"{WIDTH} \N{MULTIPLICATION SIGN} {HEIGHT}"
CORNERS = """(canvas) => {
    const { width, height } = canvas;
    const copy = new OffscreenCanvas(width, height).getContext("2d", { willReadFrequently: true });
    copy.drawImage(canvas, 0, 0);
    const at = (x, y) => [...copy.getImageData(x, y, 1, 1).data.slice(0, 3)];
    return [at(2, 2), at(width - 3, 2), at(2, height - 3), at(width - 3, height - 3)];
}"""

ALL = """(canvas) => {
    const { width, height } = canvas;
    const copy = new OffscreenCanvas(width, height).getContext("2d");
    copy.drawImage(canvas, 0, 0);
    const { data } = copy.getImageData(0, 0, width, height);
    return Array.from({ length: width * height }, (_, at) => [...data.slice(4 * at, 4 * at + 3)]);
}"""


def picture() -> pillow.Image:
    found = pillow.new("RGB", (WIDTH, HEIGHT))
    for number, color in enumerate(COLORS):
        left, top = (number % 2) * WIDTH // 2, (number // 2) * HEIGHT // 2
        found.paste(color, (left, top, left + WIDTH // 2, top + HEIGHT // 2))
    return found


def raw(encoding: str, order: str) -> Image:
    """Return an image with padded rows."""
    bands = dict(zip("RGB", picture().split(), strict=True))
    bands["A"] = pillow.new("L", (WIDTH, HEIGHT), 255)
    planes = [bands[band].tobytes() for band in order]
    row = len(order) * WIDTH
    pixels = bytes(value for pixel in zip(*planes, strict=True) for value in pixel)
    rows = [pixels[at : at + row] + b"\x07" * 5 for at in range(0, len(pixels), row)]
    return Image(
        Header(stamp=fibws.Time(1)), HEIGHT, WIDTH, encoding, step=row + 5, data=b"".join(rows)
    )


def compressed(kind: str) -> CompressedImage:
    written = io.BytesIO()
    picture().save(written, kind, **({"quality": 95, "subsampling": 0} if kind == "JPEG" else {}))
    return CompressedImage(format="rgb8; compressed", data=written.getvalue())


@fixture
async def camera(hub: HubServer) -> AsyncIterator[fibws.Node]:
    async with fibws.Node("camera", hub=hub.url) as node:
        yield node


async def shown(page: Page, encoding: str) -> list[list[int]]:
    """Wait for a picture of this encoding; return the colours of its quarters."""
    await expect(page.locator(".image-facts")).to_contain_text(encoding)
    await until(page, "document.querySelector('.image-stage canvas')?.width > 1")
    found: list[list[int]] = await page.locator(".image-stage canvas").evaluate(CORNERS)
    return found


async def test_age_is_that_by_the_simulated_clock(
    hub: HubServer, camera: fibws.Node, open_page: OpenPage
) -> None:
    clock = await camera.advertise("/clock", Clock, latch=True)
    topic = await camera.advertise("/image", Image, latch=True)
    await clock.publish(Clock(fibws.Time(1, 250_000_000)))
    await topic.publish(raw("rgb8", "RGB"))
    page = await open_page(hub, "#/topics/%2Fimage")
    facts = page.locator(".image-facts")
    async with asyncio.timeout(PATIENCE):
        while "250 ms old" not in await facts.inner_text():
            await topic.publish(raw("rgb8", "RGB"))


@pytest.mark.parametrize(
    ("encoding", "order"), [("rgb8", "RGB"), ("bgr8", "BGR"), ("rgba8", "RGBA"), ("8UC3", "BGR")]
)
async def test_raw_image_is_shown(
    hub: HubServer, camera: fibws.Node, open_page: OpenPage, encoding: str, order: str
) -> None:
    topic = await camera.advertise("/image", Image, latch=True)
    await topic.publish(raw(encoding, order))
    # However young the page is, screen readers are told at once what the picture is.
    young = "performance.now = () => 1000;"
    page = await open_page(hub, "#/topics/%2Fimage", prepare=young)
    assert await shown(page, f"{SIZE} {encoding}") == [list(each) for each in COLORS]
    await expect(page.locator(".image-facts")).to_contain_text("another clock")
    await expect(page.get_by_role("img", name="Camera /image")).to_be_visible()
    # The numbers of an image are not sent to the page as text.
    assert (
        await page.locator("details.section", has_text="Raw messages").get_attribute("open") is None
    )


@pytest.mark.parametrize("kind", ["JPEG", "PNG", "WEBP"])
async def test_compressed_image_is_shown(
    hub: HubServer, camera: fibws.Node, open_page: OpenPage, kind: str
) -> None:
    topic = await camera.advertise("/image/compressed", CompressedImage, latch=True)
    await topic.publish(compressed(kind))
    page = await open_page(hub, "#/topics/%2Fimage%2Fcompressed", color_scheme="dark")
    found = await shown(page, SIZE)
    for color, expected in zip(found, COLORS, strict=True):
        assert all(abs(a - b) < 40 for a, b in zip(color, expected, strict=True))


async def test_depths_are_shown_with_the_value_under_the_pointer(
    hub: HubServer, camera: fibws.Node, open_page: OpenPage
) -> None:
    depths = await camera.advertise("/depth", Image, latch=True)
    numbers = [1830 if x < WIDTH // 2 else 4000 for _ in range(HEIGHT) for x in range(WIDTH)]
    data = struct.pack(f"<{len(numbers)}H", *numbers)
    await depths.publish(Image(Header(), HEIGHT, WIDTH, "16UC1", step=2 * WIDTH, data=data))
    page = await open_page(hub, "#/topics/%2Fdepth")
    quarters = await shown(page, "16UC1")
    assert quarters[0] == [0, 0, 0] and quarters[1] == [255, 255, 255]
    await expect(page.locator(".image-facts")).to_contain_text("shown from 1830 to 4000")
    await page.get_by_role("group", name="Picture; arrow keys").focus()
    for _ in range(2):
        await page.keyboard.press("ArrowRight")
    await expect(page.locator(".image-value")).to_have_text("x 2, y 0: 1.830 m")
    await page.get_by_label("Colours of depths").select_option("color")
    await until(
        page,
        f"({CORNERS})(document.querySelector('.image-stage canvas')).join() === "
        "'255,0,0,0,0,255,255,0,0,0,0,255'",
    )


async def test_compressed_depths_are_shown(
    hub: HubServer, camera: fibws.Node, open_page: OpenPage
) -> None:
    depths = await camera.advertise("/depth/compressedDepth", CompressedImage, latch=True)
    written = io.BytesIO()
    numbers = [1000 if x < WIDTH // 2 else 2500 for _ in range(HEIGHT) for x in range(WIDTH)]
    data = struct.pack(f"<{len(numbers)}H", *numbers)
    pillow.frombytes("I;16", (WIDTH, HEIGHT), data).save(written, "PNG")
    await depths.publish(
        CompressedImage(format="16UC1; compressedDepth png", data=bytes(12) + written.getvalue())
    )
    page = await open_page(hub, "#/topics/%2Fdepth%2FcompressedDepth")
    quarters = await shown(page, "compressedDepth")
    assert quarters == [[0] * 3, [255] * 3] * 2
    await expect(page.locator(".image-facts")).to_contain_text("shown from 1000 to 2500")


async def test_what_is_wrong_is_said(
    hub: HubServer, camera: fibws.Node, open_page: OpenPage
) -> None:
    topic = await camera.advertise("/image", Image, latch=True)
    page = await open_page(hub, "#/topics/%2Fimage")
    await expect(page.locator(".image-waiting")).to_have_text("Waiting for the first image …")
    image = raw("rgb8", "RGB")
    image.encoding = "xyz8"
    await topic.publish(image)
    fault = page.locator(".image-panel .error")
    await expect(fault).to_contain_text("unknown encoding “xyz8”: known are rgb8")
    image.encoding, image.step = "rgb8", 3
    await topic.publish(image)
    await expect(fault).to_contain_text("step is 3 bytes, but 40 pixels of rgb8 are 120")
    await topic.publish(raw("rgb8", "RGB"))
    await shown(page, "rgb8")
    await expect(fault).to_be_hidden()


async def test_picture_ends_with_its_page(
    hub: HubServer, camera: fibws.Node, open_page: OpenPage
) -> None:
    topic = await camera.advertise("/image", Image, latch=True, peers=True)
    changes = topic.peers.changes()
    await topic.publish(raw("rgb8", "RGB"))

    async def subscribed(wanted: bool) -> None:
        async with asyncio.timeout(60):
            async for names in changes:
                if bool(names) == wanted:
                    return

    page = await open_page(hub, "#/topics/%2Fimage")
    await shown(page, "rgb8")
    await subscribed(True)
    await page.get_by_role("button", name="Pause", exact=True).click()
    await subscribed(False)
    await page.get_by_role("button", name="Resume").click()
    await subscribed(True)
    await page.locator("details.section", has_text="Image").locator("summary").click()
    await subscribed(False)
    await page.locator("details.section", has_text="Image").locator("summary").click()
    await shown(page, "rgb8")
    await subscribed(True)
    await page.locator("#tab-services").click()
    await subscribed(False)


async def test_picture_is_zoomed_and_saved(
    hub: HubServer, camera: fibws.Node, open_page: OpenPage
) -> None:
    topic = await camera.advertise("/front/image", Image, latch=True)
    await topic.publish(raw("rgb8", "RGB"))
    page = await open_page(hub, "#/topics/%2Ffront%2Fimage")
    await shown(page, "rgb8")
    await page.get_by_role("button", name="1:1").click()
    canvas = page.locator(".image-stage canvas")
    await until(page, "document.querySelector('.image-stage canvas').clientWidth === 40")
    await page.get_by_role("button", name="Zoom in").click()
    await until(page, "document.querySelector('.image-stage canvas').clientWidth === 50")
    box = await canvas.bounding_box()
    assert box is not None
    await page.mouse.move(box["x"] + 45, box["y"] + 20)
    await expect(page.locator(".image-value")).to_have_text("x 36, y 16: rgb 255 255 0")
    async with page.expect_download() as download:
        await page.get_by_role("button", name="Save").click()
    saved = await download.value
    assert saved.suggested_filename == "front_image.png"
    with pillow.open(await saved.path()) as image:
        assert image.size == (WIDTH, HEIGHT)
        assert image.convert("RGB").getpixel((WIDTH - 1, HEIGHT - 1)) == COLORS[3]


# It measures CPU time, which is more on a busy machine.
@pytest.mark.slow
async def test_camera_costs_the_page_little(
    hub: HubServer, camera: fibws.Node, open_page: OpenPage, browser: Browser
) -> None:
    """The page's own thread: the worker decodes and draws."""
    written = io.BytesIO()
    pillow.effect_noise((640, 480), 60).convert("RGB").save(written, "JPEG", quality=60)
    image = CompressedImage(format="jpeg", data=written.getvalue())
    topic = await camera.advertise("/image", CompressedImage)
    seconds, hz = 2, 30

    async def publish() -> None:
        async for _ in camera.rate(hz):
            await topic.publish(image)

    publishing = asyncio.create_task(publish())
    try:
        page = await open_page(hub, "#/topics/%2Fimage")
        await expect(page.locator(".image-facts")).to_contain_text(
            "640 \N{MULTIPLICATION SIGN} 480"
        )
        await page.wait_for_timeout(500)
        async with traced(browser) as tasks:
            await page.wait_for_timeout(seconds * 1000)
    finally:
        publishing.cancel()
    # 3 % of a core and twice as much for other machines; the graph's polls are in it.
    assert sum(tasks) / seconds < 0.06


class SlowLine:
    """A proxy of a hub whose line to a page carries a piece on demand, and keeps the rest."""

    PIECE = 16_384

    def __init__(self, hub: HubServer) -> None:
        self._hub = hub
        self._turn: asyncio.Future[None] = asyncio.get_running_loop().create_future()
        self._tasks: set[asyncio.Task[Any] | None] = set()
        self.most_waiting = 0
        """The most bytes of serialized messages that have waited."""

    def carry(self) -> None:
        """Carry one piece of each connection that has some."""
        self._turn.set_result(None)
        self._turn = asyncio.get_running_loop().create_future()

    async def close(self) -> None:
        """Close all connections."""
        tasks = [task for task in self._tasks if task is not None]
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)

    async def open(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        """Connect a page with the hub."""
        host, port = self._hub.url.removeprefix("ws://").split(":")
        from_hub, to_hub = await asyncio.open_connection(host, int(port))
        waiting: asyncio.Queue[bytes] = asyncio.Queue()
        counted = is_serialized = 0

        async def take_requests() -> None:
            nonlocal is_serialized
            while data := await reader.read(self.PIECE):
                is_serialized |= SUBPROTOCOL.encode() in data
                to_hub.write(data)
            to_hub.close()

        async def take_replies() -> None:
            nonlocal counted
            while data := await from_hub.read(self.PIECE):
                waiting.put_nowait(data)
                counted += len(data)
                if is_serialized:
                    self.most_waiting = max(self.most_waiting, counted)
            waiting.put_nowait(b"")

        async def carry_pieces() -> None:
            nonlocal counted
            while data := await waiting.get():
                await asyncio.shield(self._turn)
                counted -= len(data)
                writer.write(data)
            writer.close()

        self._tasks.add(asyncio.current_task())
        try:
            with suppress(ConnectionError):
                await asyncio.gather(take_requests(), take_replies(), carry_pieces())
        finally:
            for each in (to_hub, writer):
                each.close()
                with suppress(ConnectionError):
                    await each.wait_closed()


async def test_slow_line_shows_fewer_images_and_no_older_ones(
    hub: HubServer, camera: fibws.Node, open_page: OpenPage
) -> None:
    written = io.BytesIO()
    pillow.effect_noise((640, 480), 60).convert("RGB").save(written, "JPEG", quality=30)
    image = CompressedImage(format="jpeg", data=written.getvalue())
    topic = await camera.advertise("/image", CompressedImage)
    left = math.inf

    async def publish() -> None:
        nonlocal left
        async for _ in camera.rate(60):
            await topic.publish(image)
            # Less than an image, so that images come faster than the line carries them.
            line.carry()
            left -= 1
            if left == 0:
                return

    line = SlowLine(hub)
    publishing = asyncio.create_task(publish())
    async with await asyncio.start_server(line.open, "127.0.0.1", 0) as server:
        port = server.sockets[0].getsockname()[1]
        page = await open_page(hub, "#/topics/%2Fimage", address=f"http://127.0.0.1:{port}")
        await expect(page.locator(".image-facts")).to_contain_text(
            "640 \N{MULTIPLICATION SIGN} 480"
        )
        left = 90
        await publishing
        await page.context.close()
        await line.close()
    size = len(image.data) + 100
    assert size > 2 * line.PIECE
    assert size < line.most_waiting <= 2 * size


async def test_map_is_shown_with_the_cell_under_the_pointer(
    hub: HubServer, camera: fibws.Node, open_page: OpenPage
) -> None:
    topic = await camera.advertise("/map", OccupancyGrid, latch=True)
    info = MapMetaData(resolution=0.05, width=4, height=3)
    info.origin.position.x = -1.0
    info.origin.orientation.w = 1.0
    # The only occupied cell is at the top left.
    cells = [0, 0, 0, -1, 0, 0, 0, -1, 100, 0, 0, -1]
    await topic.publish(OccupancyGrid(Header(frame_id="world"), info, cells))
    page = await open_page(hub, "#/topics/%2Fmap")
    await expect(page.locator(".image-facts")).to_contain_text("cells of 0.05 m")
    await expect(page.get_by_role("img", name="Map /map")).to_be_visible()
    # Each cell is many pixels: they are squares, not a blur.
    await expect(page.locator(".image-stage canvas")).to_have_class("fits squares")
    found = await page.locator(".image-stage canvas").evaluate(ALL)
    white, grey = [255] * 3, [0x70, 0x89, 0x86]
    assert found == [[0] * 3, white, white, grey, *([white] * 3 + [grey]) * 2]
    stage = page.get_by_role("group", name="Picture; arrow keys")
    await stage.focus()
    await page.keyboard.press("ArrowRight")
    await expect(page.locator(".image-value")).to_have_text(
        "x 1, y 0: 0 (free) at -0.92 m, 0.13 m in world"
    )
