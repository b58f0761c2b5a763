"""republish, between raw and compressed images."""

from __future__ import annotations

import asyncio

import pytest
from running_programs import Start

import fibws
from fibws.hub.server import HubServer
from fibws.msg.sensor_msgs import CompressedImage, Image

REPUBLISH = ("fibws", "run", "image_transport", "republish")


@pytest.mark.long
async def test_images_are_compressed_and_decompressed(hub: HubServer, start: Start) -> None:
    async with fibws.Node("camera", hub=hub.url) as node:
        await node.params.set("/small/compressed/format", "png")
        raw = await node.advertise("/camera/image", Image, peers=True)
        await start(*REPUBLISH, "raw", "in:=/camera/image", "out:=/small", FIBWS_HUB=hub.url)
        await start(*REPUBLISH, "compressed", "raw", "in:=/small", "out:=/again", FIBWS_HUB=hub.url)
        compressed = node.subscribe("/small/compressed", CompressedImage)
        again = node.subscribe("/again", Image)
        image = Image(height=2, width=2, encoding="rgb8", step=6, data=bytes(range(12)))
        arriving = [asyncio.ensure_future(anext(each)) for each in (compressed, again)]
        async for _ in node.rate(20):
            await raw.publish(image)
            if all(each.done() for each in arriving):
                break
        small, large = (each.result() for each in arriving)
        assert isinstance(small, CompressedImage)
        assert small.format == "rgb8; png compressed bgr8"
        assert isinstance(large, Image)
        assert (large.encoding, large.step, large.data) == ("rgb8", 6, image.data)
        # Nobody is asked for images that nobody wants.
        compressed.close()
        again.close()
        async for names in raw.peers.changes():
            if not names:
                break


@pytest.mark.long
async def test_invalid_arguments_are_errors(hub: HubServer, start: Start) -> None:
    code, _, err = await (await start(*REPUBLISH, "compresed")).end()
    assert code == 1 and "did you mean compressed?" in err
    code, _, err = await (await start(*REPUBLISH)).end()
    assert code == 1 and "usage: republish" in err
    hub.graph.parameters.set("/out/compressed/jpeg_quality", 101)
    program = await start(*REPUBLISH, "raw", "out:=/out", FIBWS_HUB=hub.url)
    code, _, err = await program.end()
    assert code == 1 and "jpeg_quality must be 1 to 100, got 101" in err
