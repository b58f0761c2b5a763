"""Files of robots that clients fetch."""

from __future__ import annotations

import struct
from collections.abc import Callable, Collection
from pathlib import Path

import pytest

from fibws.access.rights import Right
from fibws.errors import OperationError
from fibws.hub.foxglove import assets, session

from .foxglove_client import FoxgloveClient, FoxgloveHub

MESH = "package://my_robot/arm.stl"


class Files:
    """Files of one folder, for clients that may read the robot's description."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self.reads = 0

    def named(self, allows: Callable[[Right, str], bool], /) -> Collection[str]:
        return ["my_robot"] if allows("param_read", "/robot_description") else []

    def resolve(self, uri: str, named: Collection[str], /) -> Path:
        self.reads += 1
        package, _, name = uri.removeprefix("package://").partition("/")
        if package not in named:
            raise OperationError(f"package {package} is not in a robot_description")
        return self._folder / name


@pytest.fixture
def files(tmp_path: Path) -> Files:
    (tmp_path / "arm.stl").write_bytes(b"solid arm")
    return Files(tmp_path)


def fetch(client: FoxgloveClient, uri: str, request: int = 1) -> None:
    client.send("fetchAsset", uri=uri, requestId=request)


def answers(client: FoxgloveClient) -> list[tuple[int, str, bytes]]:
    """Return the request, the error and the data of each answer that came."""
    found = []
    for each in client.receive():
        assert isinstance(each, bytes), each
        kind, request, status, size = struct.unpack_from("<BIBI", each)
        error, data = each[10 : 10 + size].decode(), each[10 + size :]
        assert kind == 4
        assert (status, bool(error), data if status else b"") in ((0, False, b""), (1, True, b""))
        found.append((request, error, data))
    return found


def test_file_is_sent(files: Files) -> None:
    client = FoxgloveHub(assets=files).foxglove_client()
    client.receive()
    assert "assets" in client.info["capabilities"]
    fetch(client, MESH, 7)
    assert answers(client) == [(7, "", b"solid arm")]


@pytest.mark.parametrize(
    ("uri", "fault"),
    [
        ("package://other/arm.stl", "other"),
        ("package://my_robot/leg.stl", "No such file"),
        ("file:///etc/passwd", "robot_description"),
        ("", "robot_description"),
    ],
)
def test_refusal_says_why(files: Files, uri: str, fault: str) -> None:
    client = FoxgloveHub(assets=files).foxglove_client()
    client.receive()
    fetch(client, uri)
    [(request, error, _)] = answers(client)
    assert request == 1
    assert fault in error


def test_hub_without_assets_refuses_all() -> None:
    client = FoxgloveHub().foxglove_client()
    client.receive()
    assert "assets" not in client.info["capabilities"]
    fetch(client, MESH)
    [(_, error, _)] = answers(client)
    assert "no assets" in error


def test_nothing_is_read_before_the_client_reads(files: Files) -> None:
    hub = FoxgloveHub(assets=files)
    client = hub.foxglove_client()
    client.pause()
    for request in range(5):
        fetch(client, MESH, request)
    assert (files.reads, client.queue.kept_bytes) == (0, 0)
    client.queue.resume()
    assert [request for request, *_ in answers(client)] == [0, 1, 2, 3, 4]


SIZE = len(b"solid arm")


def room_for(count: int, monkeypatch: pytest.MonkeyPatch, files: Files) -> FoxgloveHub:
    """A hub in which so many files may be on their way at once."""
    monkeypatch.setattr(session, "MOST_HELD", count * SIZE)
    return FoxgloveHub(assets=files)


def test_files_of_clients_that_do_not_read_are_bounded_together(
    files: Files, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The first file of each counts, too."""
    hub = room_for(2, monkeypatch, files)
    clients = [hub.foxglove_client(f"/client{number}") for number in range(5)]
    for client in clients:
        client.receive()
        fetch(client, MESH)
        fetch(client, MESH, 2)
        client.queue.pause()
    hub.clock.advance(0)
    assert hub.foxglove.asset_room.held == 2 * SIZE
    assert sum(client.queue.kept_bytes > 0 for client in clients) == 2
    for client in clients:
        client.queue.resume()
    hub.clock.advance(0)
    for _ in range(4):
        hub.clock.advance(0)
        hub.clock.turn()
    for client in clients:
        assert answers(client) == [(1, "", b"solid arm"), (2, "", b"solid arm")]
    assert hub.foxglove.asset_room.held == 0


def test_client_that_leaves_gives_its_turn_to_the_next(
    files: Files, monkeypatch: pytest.MonkeyPatch
) -> None:
    hub = room_for(1, monkeypatch, files)
    first, second, third = (hub.foxglove_client(f"/client{number}") for number in range(3))
    for client in (first, second, third):
        client.receive()
    first.pause()
    for client in (first, second, third):
        fetch(client, MESH)
    first.queue.resume()
    first.queue.pause()
    assert answers(second) == [(1, "", b"solid arm")]
    assert answers(third) == [(1, "", b"solid arm")]
    for client in (first, second, third):
        client.disconnect()
    hub.clock.advance(hub.settings.close_timeout)
    assert hub.foxglove.asset_room.held == 0
    assert hub.empty


def test_half_written_file_counts_until_its_connection_is_closed(
    files: Files, monkeypatch: pytest.MonkeyPatch
) -> None:
    hub = room_for(1, monkeypatch, files)
    client, other = hub.foxglove_client("/a"), hub.foxglove_client("/b")
    client.receive()
    other.receive()
    fetch(client, MESH)
    client.queue.pause()
    hub.clock.advance(0)
    client.disconnect()
    fetch(other, MESH)
    assert answers(other) == []
    hub.clock.advance(hub.settings.close_timeout)
    assert answers(other) == [(1, "", b"solid arm")]


def test_file_that_never_fits_is_refused(files: Files, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(session, "MOST_HELD", SIZE - 1)
    hub = FoxgloveHub(assets=files)
    client = hub.foxglove_client()
    client.receive()
    fetch(client, MESH)
    [(_, error, _)] = answers(client)
    assert "too large" in error


def test_long_uri_does_not_wait(files: Files) -> None:
    client = FoxgloveHub(assets=files).foxglove_client()
    client.pause()
    fetch(client, "package://my_robot/" + "x" * assets.LONGEST_URI)
    client.queue.resume()
    [(request, error, _)] = answers(client)
    assert (request, files.reads) == (1, 0)
    assert str(assets.LONGEST_URI) in error


def test_too_many_requests_are_refused_and_forgotten_with_the_client(files: Files) -> None:
    hub = FoxgloveHub(assets=files, max_calls=2)
    client = hub.foxglove_client()
    client.pause()
    for request in range(3):
        fetch(client, MESH, request)
    client.queue.resume()
    first, *_ = answers(client)
    assert (first[0], "limit 2" in first[1]) == (2, True)
    fetch(client, MESH)
    client.disconnect()
    assert hub.empty
