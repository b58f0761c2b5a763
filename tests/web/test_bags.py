"""Bags on the page: the hub's recording in the header, and the control of players."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
from pathlib import Path

from playwright.async_api import expect

import fibws
from fibws.bags import open_reader, open_writer
from fibws.hub import Settings
from fibws.hub.server import HubServer
from fibws.msg.std_msgs import Int32

from .conftest import OpenPage

START = 1_700_000_000 * 10**9


def recorded(folder: Path) -> list[str]:
    """Return the topics of all bags in a folder."""
    found = []
    for path in sorted(folder.iterdir()):
        with open_reader(path) as bag:
            found += [each.topic for each in bag.connections]
    return found


def contents(folder: Path) -> list[bytes]:
    return [path.read_bytes() for path in folder.iterdir()]


async def test_header_starts_and_stops_the_recording(tmp_path: Path, open_page: OpenPage) -> None:
    settings = Settings(port=0, record=tmp_path, record_at_start=False, record_min_space=0)
    async with HubServer(settings) as hub, fibws.Node("robot", hub=hub.url) as node:
        numbers = await node.advertise("/numbers", Int32, latch=True)
        await numbers.publish(1)
        page = await open_page(hub)
        button = page.locator("#record")
        await expect(button).to_have_text("Record")
        await button.click()
        await expect(button).to_have_text("Stop")
        await expect(page.locator(".bags-progress")).to_contain_text(re.compile(r"\d:\d\d"))
        await button.click()
        await expect(button).to_have_text("Record")
        saved = re.compile(r"^saved [\d_-]+\.bag · .+ · \d+ messages? · Show$")
        await expect(page.locator(".bags-progress")).to_have_text(saved)
        async with page.expect_download() as download:
            await page.locator(".bags-progress a").first.click()
        copy = tmp_path.parent / "copy.bag"
        await (await download.value).save_as(copy)
        assert [copy.read_bytes()] == contents(tmp_path)
        await page.context.close()
    assert "/numbers" in recorded(tmp_path)


async def test_hub_without_a_folder_has_no_button(hub: HubServer, open_page: OpenPage) -> None:
    page = await open_page(hub)
    await expect(page.locator("#count-nodes")).not_to_have_text("\N{EN DASH}")
    await expect(page.locator("#record")).to_have_count(0)


async def test_player_is_controlled(hub: HubServer, tmp_path: Path, open_page: OpenPage) -> None:
    path = tmp_path / "walk.bag"
    with open_writer(path) as bag:
        connection = bag.connection("/numbers", Int32._type, "*", "int32 data\n")
        for number in range(3):
            bag.write(connection, START + number * 600 * 10**9, number.to_bytes(4, "little"))
    words = ("bag", "play", str(path), "--pause", "-d", "0", "-k", "--node-name", "player")
    async with fibws.Node("ear", hub=hub.url) as node:
        received = node.subscribe("/numbers", Int32, queue_size=None)
        with subprocess.Popen(  # noqa: ASYNC220
            (sys.executable, "-m", "fibws", *words),
            env={**os.environ, "FIBWS_HUB": hub.url},
            stdout=subprocess.DEVNULL,
        ) as player:
            try:
                page = await open_page(hub)
                await page.get_by_role("link", name="Playback").click()
                panel = page.locator(".playback")
                state = panel.locator(".playback-state")
                await expect(state).to_have_text("Paused")
                await expect(panel).to_contain_text("0:00 / 20:00")
                await expect(panel).to_contain_text("walk.bag")
                await panel.get_by_role("button", name="Step").click()
                assert (await anext(received)).data == 0
                await panel.get_by_role("slider").fill("500")
                await expect(panel).to_contain_text("10:00 / 20:00")
                await panel.get_by_role("button", name="Step").click()
                assert (await anext(received)).data == 1
                await panel.get_by_label("Rate").select_option("10")
                await panel.get_by_role("button", name="Play").click()
                await expect(state).to_have_text("Playing")
                await panel.get_by_role("button", name="Pause").click()
                await expect(state).to_have_text("Paused")
                await page.context.close()
            finally:
                player.send_signal(signal.SIGINT)
