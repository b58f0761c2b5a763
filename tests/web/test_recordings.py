"""Recordings that the page reads itself, without the hub: MCAP files and bags of ROS 1."""

from __future__ import annotations

import json
import re
import threading
from collections.abc import AsyncIterator, Iterator
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

import pytest
from hub.http.test_recording_downloads import record
from mcap.writer import Writer as JsonWriter
from playwright.async_api import Page, expect

from fibws.bags import open_writer
from fibws.hub import Settings
from fibws.hub.http.requests import CONTENT_SECURITY_POLICY
from fibws.hub.server import HubServer
from fibws.interfaces import Interfaces
from fibws.interfaces.serialization import Serializers

from .conftest import BUILT, PATIENT, Complaints, OpenPage, fixture, web_address

INTERFACES = Interfaces()
SERIALIZERS = Serializers(INTERFACES)
START = 1_700_000_000_000_000_000
SECOND = 1_000_000_000
COUNT = 60
"""Numbers in a recording: one a second, from 1 on."""


class Handler(SimpleHTTPRequestHandler):
    def end_headers(self) -> None:
        """Send the hub's policy, which is stricter than that of most hosts."""
        self.send_header("Content-Security-Policy", CONTENT_SECURITY_POLICY)
        super().end_headers()

    def log_message(self, *_: object) -> None:
        """Print nothing."""


@pytest.fixture(scope="module")
def static_host() -> Iterator[str]:
    """Return the address of a server that has the page's files, and is no hub."""
    handler = partial(Handler, directory=str(BUILT))
    with ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
        thread = threading.Thread(target=server.serve_forever)
        thread.start()
        yield f"http://127.0.0.1:{server.server_port}"
        server.shutdown()
        thread.join()


@fixture
async def page(
    open_page: OpenPage, hub: HubServer, static_host: str, complaints: Complaints
) -> AsyncIterator[Page]:
    """Return the page of a host without a hub."""
    page = await open_page(hub, "", address=static_host, state="closed")
    yield page
    # There is no hub to ask.
    for expected in ("Failed to load resource", "WebSocket connection to"):
        complaints.allow(expected)


def write(path: Path, compression: str = "none") -> Path:
    """Write a recording: /n counts the seconds, and /mode is latched once, at the start."""
    with open_writer(path, compression, chunk_size=100) as writer:
        numbers, mode = [
            writer.connection(
                topic, type_, INTERFACES.md5(type_), INTERFACES.full_text(type_), callerid="/robot"
            )
            for topic, type_ in (("/n", "std_msgs/Int32"), ("/mode", "std_msgs/String"))
        ]
        text = SERIALIZERS.of("std_msgs/String").serialize({"data": "idle"})
        writer.write(mode, START, text)
        for number in range(1, COUNT + 1):
            data = SERIALIZERS.of("std_msgs/Int32").serialize({"data": number})
            writer.write(numbers, START + number * SECOND, data)
    return path


def write_json(path: Path) -> Path:
    with path.open("wb") as file:
        writer = JsonWriter(file)
        writer.start()
        schema = writer.register_schema("own.Number", "jsonschema", b"{}")
        channel = writer.register_channel("/n", "json", schema)
        for number in range(1, COUNT + 1):
            time = START + number * SECOND
            writer.add_message(channel, time, json.dumps({"data": number}).encode(), time)
        writer.finish()  # type: ignore[no-untyped-call]
    return path


def write_cdr(path: Path, first: int = 1, last: int = COUNT) -> Path:
    with path.open("wb") as file:
        writer = JsonWriter(file)
        writer.start("ros2")
        schema = writer.register_schema("std_msgs/msg/Int32", "ros2msg", b"int32 data")
        channel = writer.register_channel("/n", "cdr", schema)
        for number in range(first, last + 1):
            time = START + number * SECOND
            data = b"\0\1\0\0" + number.to_bytes(4, "little")
            writer.add_message(channel, time, data, time)
        writer.finish()  # type: ignore[no-untyped-call]
    return path


async def open_file(page: Page, path: Path) -> None:
    await page.get_by_label("Recording").set_input_files(path)
    await choose(page, "/n")


async def choose(page: Page, topic: str) -> None:
    await page.locator(".browse-list tbody tr").get_by_text(topic, exact=True).click()


async def shown(page: Page, value: object) -> None:
    await expect(page.locator(".echo .tree-value")).to_have_text(str(value))


async def press(page: Page, *keys: str) -> None:
    await page.get_by_role("slider", name="Time").focus()
    for key in keys:
        await page.keyboard.press(key)


async def walk(page: Page) -> None:
    """Go to the end of a recording, to its start, and through its first messages."""
    await press(page, "End")
    await shown(page, COUNT)
    await press(page, "Home")
    bar = page.locator("#timebar")
    await bar.get_by_label("Topic of the steps").select_option("/n")
    await bar.get_by_role("button", name="Next message").click()
    await bar.get_by_role("button", name="Next message").click()
    await expect(page.locator(".echo .tree-value")).to_have_text("2")
    await bar.get_by_role("button", name="Previous message").click()
    await shown(page, 1)


@pytest.mark.parametrize(
    "name", ["none.bag", "lz4.bag", "bz2.bag", "none.mcap", "lz4.mcap", "zstd.mcap"]
)
async def test_recordings_of_ros_1_are_shown(page: Page, tmp_path: Path, name: str) -> None:
    await open_file(page, write(tmp_path / name, name.split(".")[0]))
    await walk(page)
    # Latched long ago, and still so.
    await press(page, "End")
    await choose(page, "/mode")
    await shown(page, '"idle"')
    await expect(page.locator(".file-problem")).to_be_hidden()


async def test_messages_in_json_are_shown(page: Page, tmp_path: Path) -> None:
    await open_file(page, write_json(tmp_path / "json.mcap"))
    await press(page, "End")
    await shown(page, COUNT)


async def test_messages_of_ros_2_are_shown(page: Page, tmp_path: Path) -> None:
    await open_file(page, write_cdr(tmp_path / "cdr.mcap"))
    await press(page, "End")
    await shown(page, COUNT)


def write_folder(folder: Path) -> list[Path]:
    """Write a recording of rosbag2: two files, and what is said of them."""
    folder.mkdir()
    metadata = folder / "metadata.yaml"
    names = "".join(f"  - {folder.name}_{part}.mcap\n" for part in range(2))
    metadata.write_text(f"rosbag2_bagfile_information:\n  relative_file_paths:\n{names}")
    half = COUNT // 2
    first = write_cdr(folder / f"{folder.name}_0.mcap", 1, half)
    return [metadata, first, write_cdr(folder / f"{folder.name}_1.mcap", half + 1)]


async def test_the_files_of_a_folder_are_one_recording(page: Page, tmp_path: Path) -> None:
    metadata, *parts = write_folder(tmp_path / "run")
    await page.get_by_label("Recording").set_input_files([metadata, *parts])
    await choose(page, "/n")
    for key, number in (("End", COUNT), ("Home", 1)):
        await press(page, key)
        await shown(page, number)
    find = page.get_by_label("Find the next message")
    await find.fill(str(COUNT // 2 + 1))
    await find.press("Enter")
    await shown(page, COUNT // 2 + 1)
    await page.get_by_role("button", name="Previous message").click()
    await shown(page, COUNT // 2)
    await page.get_by_label("Recording").set_input_files([metadata, parts[0]])
    await expect(page.locator(".file-problem")).to_contain_text("run_1.mcap is missing")
    await choose(page, "/n")
    await press(page, "End")
    await shown(page, COUNT // 2)


async def test_nothing_is_published_to_a_recording(page: Page, tmp_path: Path) -> None:
    await open_file(page, write_cdr(tmp_path / "n.mcap"))
    await expect(page.get_by_text("Raw messages")).to_be_visible()
    await expect(page.get_by_text("Publish", exact=True)).to_have_count(0)
    await expect(page.get_by_role("button", name="New topic")).to_have_count(0)
    await page.get_by_role("link", name="Dashboard").click()
    await page.get_by_role("button", name="Add panel").click()
    await expect(page.get_by_role("button", name="Topics")).to_be_visible()
    for name in ("Publish", "Parameters", "Services"):
        await expect(page.locator(".pane-chooser summary", has_text=name)).to_have_count(0)


async def test_the_next_message_with_a_value_is_found(page: Page, tmp_path: Path) -> None:
    await open_file(page, write_cdr(tmp_path / "n.mcap"))
    find = page.get_by_label("Find the next message")
    await find.fill("47")
    await find.press("Enter")
    await shown(page, 47)
    await find.press("Enter")
    await expect(page.get_by_text("not found")).to_be_visible()
    await shown(page, 47)


async def test_a_plot_has_the_range_that_it_shows_before_a_moment(
    page: Page, tmp_path: Path
) -> None:
    await open_file(page, write_cdr(tmp_path / "n.mcap"))
    await page.get_by_role("button", name="Plot data").click()
    await page.get_by_label("Time range").select_option("120")
    await press(page, "End")
    await expect(page.locator(".plot-legend li")).to_contain_text(f"1 … {COUNT}")


async def test_a_recording_is_played(page: Page, tmp_path: Path) -> None:
    await open_file(page, write(tmp_path / "n.mcap"))
    bar = page.locator("#timebar")
    await bar.get_by_label("Speed").select_option("50")
    await bar.get_by_role("button", name="Play").click()
    await shown(page, COUNT)
    await expect(bar).to_have_attribute("data-state", "paused")
    await bar.get_by_label("loop").check()
    await bar.get_by_role("button", name="Play").click()
    await expect(bar).to_have_attribute("data-state", "playing")
    await bar.get_by_label("Speed").select_option("10")
    value = page.locator(".echo .tree-value")
    for part in (r"^[3-6]\d$", r"^[12]?\d$", r"^[3-6]\d$"):
        await expect(value).to_have_text(re.compile(part))
    await bar.get_by_role("button", name="Pause all").click()
    await expect(bar).to_have_attribute("data-state", "paused")


async def test_a_recording_of_the_hub_is_shown_in_parts(
    open_page: OpenPage, tmp_path: Path
) -> None:
    recorded = write(tmp_path / "n.bag", "lz4").read_bytes()
    settings = Settings(
        **PATIENT, record=tmp_path / "bags", record_at_start=False, record_min_space=0
    )
    async with HubServer(settings) as hub:
        file = await record(hub)
        file.write_bytes(recorded)
        sent: list[int] = []
        page = await open_page(hub, "#/graph")
        page.on("response", lambda response: sent.append(response.status))
        await page.goto(f"{web_address(hub)}/?file=recordings/{file.name}#/topics")
        await choose(page, "/n")
        await walk(page)
        assert sent.count(206) > 3
        await page.context.close()


@pytest.mark.parametrize("name", ["cut.bag", "cut.mcap"])
async def test_a_recording_without_an_index_is_shown(page: Page, tmp_path: Path, name: str) -> None:
    path = write(tmp_path / name)
    data = path.read_bytes()
    path.write_bytes(data[: len(data) // 3])
    await open_file(page, path)
    await expect(page.locator(".file-problem")).to_contain_text("no index")
    await press(page, "Home")
    await page.locator("#timebar").get_by_role("button", name="Next message").click()
    await shown(page, 1)


async def test_damaged_parts_are_left_out(page: Page, tmp_path: Path) -> None:
    path = write(tmp_path / "damaged.mcap", "zstd")
    data = path.read_bytes()
    first = b"\x28\xb5\x2f\xfd"
    chunks = data.split(first)
    assert len(chunks) > 20
    path.write_bytes(first.join(chunks[:10]) + b"none" + first.join(chunks[10:]))
    await open_file(page, path)
    bar = page.locator("#timebar")
    await press(page, "Home")
    await bar.get_by_label("Speed").select_option("50")
    await bar.get_by_role("button", name="Play").click()
    await shown(page, COUNT)
    await expect(page.locator(".file-problem")).to_contain_text("left out")


async def test_other_files_are_refused(page: Page, tmp_path: Path) -> None:
    path = tmp_path / "notes.mcap"
    path.write_text("no recording")
    await page.get_by_label("Recording").set_input_files(path)
    await expect(page.locator(".file-problem")).to_contain_text("neither an MCAP file nor a bag")


async def test_a_file_is_dropped_on_the_page(page: Page, tmp_path: Path) -> None:
    numbers = list(write(tmp_path / "n.bag").read_bytes())
    await page.evaluate(
        """(numbers) => {
            const data = new DataTransfer();
            data.items.add(new File([new Uint8Array(numbers)], "n.bag"));
            const event = {dataTransfer: data, bubbles: true, cancelable: true};
            document.body.dispatchEvent(new DragEvent("drop", event));
        }""",
        numbers,
    )
    await choose(page, "/n")
    await walk(page)


async def test_a_file_is_opened_in_place_of_a_hub(
    open_page: OpenPage, hub: HubServer, tmp_path: Path
) -> None:
    page = await open_page(hub, "#/topics")
    await open_file(page, write(tmp_path / "n.mcap"))
    await walk(page)
    await expect(page.locator("#state")).to_contain_text("2 topics")
    await page.get_by_role("button", name="Close file").click()
    await page.wait_for_selector("#hub[data-state=open]")
