"""Downloads of recordings: which files, for whom, and how they are sent."""

from __future__ import annotations

import asyncio
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from conftest import StartHub
from patience import PATIENCE

from fibws.bags import open_reader
from fibws.hub.http.recording_downloads import HELD
from fibws.hub.http.requests import PIECE
from fibws.hub.server import HubServer

from ..raw_client import Gone, dialled, longest_turn
from ..token_clients import entry
from .test_robot_assets import get


async def record(hub: HubServer) -> Path:
    """Make a recording, and return its file."""
    recording = hub.recording
    assert recording is not None
    await called(lambda done: _start(hub, done))
    await called(recording.stop)
    state = recording.state()
    assert state is not None and not state.fault
    return Path(state.file)


def _start(hub: HubServer, done: Callable[[], None]) -> None:
    assert hub.recording is not None
    hub.recording._starting.append(done)
    hub.recording.start()


async def called(begin: Callable[[Callable[[], None]], object]) -> None:
    """Wait until a function calls what it is given."""
    event = asyncio.Event()
    begin(event.set)
    await event.wait()


@pytest.fixture
async def hub(start_hub: StartHub, tmp_path: Path) -> HubServer:
    return await recorder(start_hub, tmp_path)


async def recorder(start_hub: StartHub, folder: Path, **settings: Any) -> HubServer:
    return await start_hub(
        record=folder / "bags", record_at_start=False, record_min_space=0, **settings
    )


async def test_recording_is_downloaded_as_it_is(hub: HubServer, tmp_path: Path) -> None:
    file = await record(hub)
    status, headers, body = await get(hub, f"/recordings/{file.name}")
    assert (status, body) == (200, file.read_bytes())
    assert int(headers["content-length"]) == len(body)
    assert headers["content-disposition"].startswith("attachment")
    assert file.name in headers["content-disposition"]
    assert headers["cross-origin-resource-policy"] == "same-origin"
    copy = tmp_path / "copy.bag"
    copy.write_bytes(body)
    with open_reader(copy):
        pass


async def test_head_has_no_body(hub: HubServer) -> None:
    file = await record(hub)
    status, headers, body = await get(hub, f"/recordings/{file.name}", method="HEAD")
    assert (status, body) == (200, b"")
    assert int(headers["content-length"]) == file.stat().st_size


@pytest.mark.parametrize(
    ("asked", "part"),
    [
        ("bytes=0-0", slice(0, 1)),
        ("bytes=10-19", slice(10, 20)),
        ("bytes=10-999999999999", slice(10, None)),
        ("bytes=10-", slice(10, None)),
        ("bytes=-7", slice(-7, None)),
        ("bytes=-999999999999", slice(0, None)),
    ],
)
async def test_range_of_a_recording_is_sent(hub: HubServer, asked: str, part: slice) -> None:
    file = await record(hub)
    data = file.read_bytes()
    start, end, _ = part.indices(len(data))
    status, headers, body = await get(hub, f"/recordings/{file.name}", Range=asked)
    assert (status, body) == (206, data[part])
    assert int(headers["content-length"]) == len(body)
    assert headers["content-range"] == f"bytes {start}-{end - 1}/{len(data)}"


@pytest.mark.parametrize("asked", ["bytes=9-2", "bytes=0-1,3-4", "lines=1-2", "bytes=", "bytes=a-"])
async def test_other_ranges_are_the_whole_recording(hub: HubServer, asked: str) -> None:
    file = await record(hub)
    status, headers, body = await get(hub, f"/recordings/{file.name}", Range=asked)
    assert (status, body) == (200, file.read_bytes())
    assert headers["accept-ranges"] == "bytes"


@pytest.mark.parametrize("asked", ["bytes=999999999-", "bytes=-0"])
async def test_range_after_the_end_is_refused(hub: HubServer, asked: str) -> None:
    file = await record(hub)
    size = file.stat().st_size
    status, headers, _ = await get(hub, f"/recordings/{file.name}", Range=asked)
    assert (status, headers["content-range"]) == (416, f"bytes */{size}")


@pytest.mark.both_loops
async def test_large_recording_arrives_whole_in_pieces(hub: HubServer) -> None:
    file = await record(hub)
    data = os.urandom(40 * PIECE + 1)  # More than sockets buffer.
    file.write_bytes(data)
    async with longest_turn() as longest:
        status, _, body = await get(hub, f"/recordings/{file.name}")
    assert status == 200
    assert body == data
    assert longest() < 0.5
    await asyncio.wait_for(hub._empty.wait(), PATIENCE)
    assert hub._asset_room.held == 0


async def test_memory_of_a_client_that_does_not_read_is_bounded(hub: HubServer) -> None:
    file = await record(hub)
    file.write_bytes(bytes(200 * PIECE))
    async with dialled(hub.port) as client:
        request = f"GET /recordings/{file.name} HTTP/1.1\r\nHost: localhost\r\n\r\n"
        await client.send(request.encode())
        await client._until(b"\r\n\r\n")
        assert hub._asset_room.held == HELD
        [connection] = hub._connections
        assert len(connection._rest) <= PIECE


async def test_file_that_becomes_shorter_ends_the_connection(hub: HubServer) -> None:
    file = await record(hub)
    file.write_bytes(bytes(200 * PIECE))
    async with dialled(hub.port) as client:
        request = f"GET /recordings/{file.name} HTTP/1.1\r\nHost: localhost\r\n\r\n"
        await client.send(request.encode())
        await client._until(b"\r\n\r\n")
        os.truncate(file, 10 * PIECE)
        with pytest.raises(Gone):
            await client._until(b"no such bytes")
        assert len(client._read) < 200 * PIECE


@pytest.mark.parametrize(
    "name",
    ["", "other.bag", "../secret", "..%2Fsecret", "%2e%2e/secret", "/etc/passwd", "a\0b", "bags"],
)
async def test_only_what_the_hub_has_recorded_is_sent(
    hub: HubServer, tmp_path: Path, name: str
) -> None:
    file = await record(hub)
    (tmp_path / "secret").write_text("secret")
    (file.parent / "other.bag").write_text("of another recorder")
    status, _, body = await get(hub, f"/recordings/{name}")
    assert status in (400, 404)
    assert b"secret" not in body and b"another" not in body


async def test_file_that_is_being_written_is_not_sent(hub: HubServer) -> None:
    await called(lambda done: _start(hub, done))
    assert hub.recording is not None
    state = hub.recording.state()
    assert state is not None
    status, _, body = await get(hub, f"/recordings/{Path(state.file).name}")
    assert (status, b"not complete" in body) == (404, True)


async def test_link_in_place_of_a_recording_is_not_followed(hub: HubServer, tmp_path: Path) -> None:
    file = await record(hub)
    secret = tmp_path / "secret"
    secret.write_text("secret")
    file.unlink()
    file.symlink_to(secret)
    status, _, body = await get(hub, f"/recordings/{file.name}")
    assert status == 404
    assert b"secret" not in body


async def test_download_needs_the_right_admin(start_hub: StartHub, tmp_path: Path) -> None:
    tokens = tmp_path / "tokens.toml"
    tokens.write_text(
        entry("boss", "admin = true") + entry("ann", 'allow = {subscribe = ["/**"]}'), "utf-8"
    )
    hub = await recorder(start_hub, tmp_path, tokens=tokens)
    file = await record(hub)
    path = f"/recordings/{file.name}"
    assert (await get(hub, path))[0] == 401
    assert (await get(hub, f"{path}?token=boss"))[0] == 401
    assert (await get(hub, path, Authorization="Bearer wrong"))[0] == 401
    assert (await get(hub, path, Authorization="Bearer ann"))[0] == 403
    assert (await get(hub, "/recordings/none", Authorization="Bearer ann"))[0] == 403
    status, _, body = await get(hub, path, Authorization="Bearer boss")
    assert (status, body) == (200, file.read_bytes())


async def test_pages_of_other_origins_get_nothing(hub: HubServer) -> None:
    file = await record(hub)
    path = f"/recordings/{file.name}"
    assert (await get(hub, path, Origin="http://evil.example"))[0] == 403
    assert (await get(hub, path, Host="evil.example"))[0] == 403


async def test_downloads_are_bounded(hub: HubServer) -> None:
    file = await record(hub)
    room = hub._asset_room
    assert room.take(room.size - HELD + 1)
    status, headers, _ = await get(hub, f"/recordings/{file.name}")
    assert (status, headers["retry-after"]) == (503, "1")


async def test_hub_that_records_nothing_has_no_downloads(start_hub: StartHub) -> None:
    assert (await get(await start_hub(), "/recordings/x.bag"))[0] == 404
