"""Limits for all connections together: how many, and the bytes that are kept for them."""

from __future__ import annotations

import errno
import json
from collections.abc import Callable
from contextlib import AsyncExitStack
from pathlib import Path
from typing import Any

import pytest
from conftest import StartHub

from fibws.access.token_file import digest_of
from fibws.hub.delivery.send_queue import Flusher, Frame, LargeFrame, SendQueue
from fibws.hub.log.audit import Audit
from fibws.hub.memory.account import Account
from fibws.hub.settings import KIB, MIB, Settings
from fibws.hub.websocket import shared_limits as module
from fibws.hub.websocket.endpoint import STRANGER_BYTES
from fibws.hub.websocket.shared_limits import TOO_MUCH_INCOMING, TOO_MUCH_QUEUED, SharedLimits
from fibws.protocol.frame_queue import Lane
from fibws.protocol.websocket import BINARY, CloseReason, client_header

from ..raw_client import (
    CONT,
    PING,
    PONG,
    TEXT,
    Client,
    connected,
    dialled,
    frame,
    handshake,
    nodes,
    operation,
    publish,
    until,
)

LIMIT = 16_000


class Connection:
    """A connection whose client reads nothing."""

    is_open = True
    is_stranger = False

    def __init__(self, hub: Crowd, owner: str) -> None:
        self.owner = owner
        self.unsent_bytes = 0
        self.is_cut_off = False
        self.incoming_bytes = 0
        self.reasons: list[CloseReason] = []
        self.lane = Lane(1000)
        self.queue = SendQueue(lambda _: None, lambda: None, hub.flusher, max_bytes=100 * LIMIT)
        self.queue.pause()

    def fail(self, reason: CloseReason) -> None:
        self.reasons.append(reason)
        self.queue.close()
        self.incoming_bytes = 0

    def abort(self) -> None:
        self.is_cut_off = True
        self.unsent_bytes = 0

    @property
    def kept(self) -> int:
        return self.queue.kept_bytes


class Crowd:
    """Connections under one limit, and the loop that checks it."""

    def __init__(self, count: int, **settings: Any) -> None:
        self.checks: list[Callable[[], None]] = []
        self.connections: list[Connection] = []
        limit = settings.pop("max_memory", 2**40)
        self.account = Account(limit, self.checks.append)
        self.limits = SharedLimits(
            Settings(
                **{
                    "max_total_queued_bytes": LIMIT,
                    "max_total_incoming_bytes": LIMIT,
                    **settings,
                }
            ),
            self.connections,
            self.account,
            Audit(lambda: 0.0),
        )
        self.flusher = Flusher(lambda _: None, allowance=self.account.allowance)
        self.connections += [Connection(self, f"/{number}") for number in range(count)]

    def keep(self, number: int, *frames: Frame) -> None:
        """Keep frames for one of the connections."""
        each = self.connections[number]
        for frame_ in frames:
            each.queue.keep(frame_, each.lane)

    def check(self) -> bool:
        """Run the checks that are due; return whether there were some."""
        due, self.checks[:] = self.checks[:], []
        for check in due:
            check()
        return bool(due)

    @property
    def kept(self) -> list[int]:
        return [each.kept for each in self.connections]


def frames(count: int, size: int = 100) -> list[bytes]:
    return [b"%*d" % (size, number) for number in range(count)]


def test_bytes_are_counted_only_above_a_threshold() -> None:
    crowd = Crowd(2)
    crowd.keep(0, *frames(80))
    crowd.keep(1, *frames(80))
    assert not crowd.check()
    crowd.keep(1, b"x")
    assert crowd.check()


def test_clients_with_most_bytes_lose_their_oldest_messages() -> None:
    crowd = Crowd(3)
    crowd.keep(0, *frames(10))
    crowd.keep(1, *frames(100))
    crowd.keep(2, *frames(200))
    assert crowd.check()
    assert sum(crowd.kept) <= LIMIT
    assert crowd.kept[0] == 1000
    assert crowd.kept[1] == crowd.kept[2] >= 6900
    assert [each.queue.dropped for each in crowd.connections] == [0, 30, 130]
    left = [bytes(buffer) for buffer in crowd.connections[2].queue.buffers()]
    assert left == frames(200)[130:]


def test_bytes_that_have_gone_do_not_count() -> None:
    crowd = Crowd(2)
    for _ in range(5):
        crowd.keep(0, *frames(90))
        crowd.connections[0].queue.resume()
        crowd.connections[0].queue.pause()
        crowd.check()
    assert crowd.connections[0].queue.dropped == 0


@pytest.mark.parametrize("size", [1000, 100_000])
def test_sum_never_exceeds_the_limit_by_much(size: int) -> None:
    crowd = Crowd(20, max_total_queued_bytes=20 * size)
    for number in range(2000):
        crowd.keep(number % 20, b"%*d" % (size // 20, number))
        crowd.check()
        assert sum(crowd.kept) <= 20 * size * 17 // 16
    assert min(crowd.kept) > 0


def test_newest_message_of_each_stays_if_they_share_it() -> None:
    large = LargeFrame(b"head", bytes(LIMIT // 2))
    crowd = Crowd(10)
    for number in range(10):
        crowd.keep(number, *frames(3), large)
    assert crowd.check()
    assert crowd.kept == [len(large)] * 10
    assert [each.reasons for each in crowd.connections] == [[]] * 10


def test_newest_messages_go_if_they_are_too_much_themselves() -> None:
    crowd = Crowd(10)
    for number in range(10):
        crowd.keep(number, bytes(LIMIT // 4))
    assert crowd.check()
    assert LIMIT // 2 <= sum(crowd.kept) <= LIMIT
    assert sum(each.queue.dropped for each in crowd.connections) >= 6
    assert [each.reasons for each in crowd.connections] == [[]] * 10


def test_client_with_the_most_replies_is_closed() -> None:
    crowd = Crowd(3)
    crowd.keep(0, *frames(10))
    crowd.connections[1].queue.reply(bytes(LIMIT - 2000))
    crowd.connections[2].queue.reply(bytes(4000))
    assert crowd.check()
    assert [each.reasons for each in crowd.connections] == [[], [TOO_MUCH_QUEUED], []]
    assert crowd.kept == [1000, 0, 4000]


def test_client_with_a_large_frame_half_written_is_closed() -> None:
    crowd = Crowd(2)
    first = crowd.connections[0]
    first.queue = SendQueue(lambda _: first.queue.pause(), print, crowd.flusher, max_bytes=LIMIT)
    first.queue.write_all([LargeFrame(b"head", bytes(MIB))])
    crowd.keep(1, *frames(20))
    assert crowd.check()
    assert [each.reasons for each in crowd.connections] == [[TOO_MUCH_QUEUED], []]


def test_frame_that_is_half_written_counts_as_a_whole() -> None:
    crowd = Crowd(1)
    first = crowd.connections[0]
    first.queue = SendQueue(lambda _: first.queue.pause(), print, crowd.flusher, max_bytes=LIMIT)
    first.queue.write_all([LargeFrame(b"head", bytes(MIB))])
    first.queue.resume()
    assert first.kept < MIB
    assert crowd.limits.queued_bytes() == crowd.account.total() == MIB


def test_bytes_that_a_closed_connection_has_still_to_send_count() -> None:
    crowd = Crowd(2)
    leaving, other = crowd.connections
    leaving.unsent_bytes = 100 * LIMIT
    crowd.keep(1, *frames(20))
    assert crowd.limits.queued_bytes() == 100 * LIMIT + 2000
    crowd.account.check()
    assert (leaving.is_cut_off, other.is_cut_off, other.kept) == (True, False, 2000)


def test_bytes_that_throttles_hold_back_count() -> None:
    crowd = Crowd(2)
    first, second = crowd.connections
    first.queue.throttled_bytes = LIMIT - 1000
    crowd.keep(1, *frames(20))
    crowd.limits.sweep(0.0)
    assert crowd.check()
    assert (first.reasons, second.reasons) == ([TOO_MUCH_QUEUED], [])


def test_clients_with_most_unfinished_bytes_are_closed() -> None:
    crowd = Crowd(4)
    for each, size in zip(crowd.connections, (LIMIT, 100, 5000, 9000), strict=True):
        each.incoming_bytes = size
    crowd.account.check()
    assert [each.reasons for each in crowd.connections] == [[TOO_MUCH_INCOMING], [], [], []]
    assert crowd.limits.incoming_bytes() == 14_100
    assert crowd.account.allowance.left == LIMIT - 14_100


def test_clients_that_have_not_logged_in_are_closed_first() -> None:
    crowd = Crowd(4)
    robot, *strangers = crowd.connections
    robot.incoming_bytes = LIMIT - 1000
    for each, size in zip(strangers, (300, 800, 700), strict=True):
        each.is_stranger, each.incoming_bytes = True, size
    crowd.account.check()
    assert [each.reasons for each in crowd.connections] == [[], [], [TOO_MUCH_INCOMING], []]


def test_largest_connection_of_the_principal_with_most_bytes_is_closed() -> None:
    crowd = Crowd(5)
    crowd.connections[0].incoming_bytes = 6000
    for each, size in zip(crowd.connections[1:], (2000, 4000, 3000, 3000), strict=True):
        each.owner, each.incoming_bytes = "pages", size
    crowd.account.check()
    assert [len(each.reasons) for each in crowd.connections] == [0, 0, 1, 0, 0]


def test_principals_share_the_bytes_that_wait() -> None:
    crowd = Crowd(9)
    crowd.keep(0, *frames(70))
    for number in range(1, 9):
        crowd.connections[number].owner = "pages"
        crowd.keep(number, *frames(10 * number))
    assert crowd.check()
    assert sum(crowd.kept) <= LIMIT
    assert crowd.kept[:2] == [7000, 1000]
    assert crowd.kept[2] < 2000


def test_replies_to_clients_that_have_not_logged_in_go_first() -> None:
    crowd = Crowd(2)
    stranger, other = crowd.connections
    stranger.is_stranger = True
    stranger.queue.reply(bytes(1000))
    crowd.keep(1, *frames(155))
    assert crowd.check()
    assert [each.reasons for each in crowd.connections] == [[TOO_MUCH_QUEUED], []]
    assert other.queue.dropped == 0


def test_reasons_fit_a_close_frame() -> None:
    for reason in (TOO_MUCH_INCOMING, TOO_MUCH_QUEUED):
        assert len(reason.reason.encode()) <= 123


def test_refusals_are_one_log_line_with_their_number(caplog: pytest.LogCaptureFixture) -> None:
    crowd = Crowd(0, max_connections=5)
    crowd.limits.clients = 5
    for _ in range(1000):
        refusal = crowd.limits.refusal(10)
        assert refusal is not None
        assert "the limit of 5 connections is reached (--max-connections)" in refusal
    crowd.limits.sweep(0.0)
    crowd.limits.sweep(0.0)
    assert [record.message for record in caplog.records] == [
        "Cannot accept more connections: "
        "the limit of 5 connections is reached (--max-connections). 1000 refused."
    ]
    assert crowd.limits.refused == 1000


@pytest.mark.parametrize(
    ("number", "text"),
    [
        (errno.EMFILE, "the limit of 1024 open files is reached (ulimit -n)"),
        (errno.ENFILE, "the system's limit of open files is reached"),
    ],
)
def test_accept_that_fails_a_thousand_times_is_one_log_line(
    caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch, number: int, text: str
) -> None:
    monkeypatch.setattr(module, "_most_files", lambda: 1024)
    crowd = Crowd(0)
    assert all(crowd.limits.accept_failed(OSError(number, "x")) for _ in range(1000))
    assert not crowd.limits.accept_failed(OSError(errno.EPERM, "x"))
    assert not crowd.limits.accept_failed(None)
    crowd.limits.sweep(0.0)
    assert [record.message for record in caplog.records] == [
        f"Cannot accept more connections: {text}."
    ]


def test_last_descriptors_are_for_refusals_and_the_hub_itself(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(module, "_most_files", lambda: 1024)
    limits = Crowd(0).limits
    assert limits.admit(1015)
    assert not limits.admit(1016)
    assert limits.refusal(991) is None
    assert "1024 open files" in (limits.refusal(992) or "")
    monkeypatch.setattr(module, "_most_files", lambda: 16)
    assert limits.refusal(11) is None
    monkeypatch.setattr(module, "_most_files", lambda: None)
    assert limits.admit(10**6)
    assert limits.refusal(10**6) is None


# With real connections.


async def refused(port: int) -> tuple[int, str]:
    async with dialled(port) as client:
        await client.send(handshake())
        status, _, body = await client.response()
        return status, body.decode()


async def health(port: int) -> dict[str, Any]:
    async with dialled(port) as client:
        await client.send(b"GET /healthz HTTP/1.1\r\n\r\n")
        found: dict[str, Any] = json.loads((await client.response())[2])
        return found


@pytest.mark.both_loops
class TestConnections:
    async def test_client_too_many_is_refused_with_503_and_the_option(
        self, start_hub: StartHub, caplog: pytest.LogCaptureFixture
    ) -> None:
        hub = await start_hub(max_connections=2)
        async with connected(hub.port) as one, connected(hub.port) as other:
            status, text = await refused(hub.port)
            assert status == 503
            assert "the limit of 2 connections is reached (--max-connections)" in text
            seen = await health(hub.port)
            assert (seen["clients"], seen["max_clients"], seen["refused"]) == (2, 2, 1)
            await until(lambda: "(--max-connections). 1 refused." in caplog.text)
            await one.is_processed()
            other.leave()
            await until(lambda: len(nodes(hub)) == 1)
            async with connected(hub.port) as next_:
                await next_.is_processed()

    async def test_clients_are_refused_before_the_last_file_is_open(
        self,
        start_hub: StartHub,
        caplog: pytest.LogCaptureFixture,
        monkeypatch: pytest.MonkeyPatch,
    ) -> None:
        hub = await start_hub()
        async with connected(hub.port) as client, AsyncExitStack() as stack:
            lowest = client.socket.fileno()
            files = lowest + 60
            monkeypatch.setattr(module, "_most_files", lambda: files)
            while client.socket.fileno() < files - 40:
                client = await stack.enter_async_context(dialled(hub.port))
            while True:
                status, text = await refused(hub.port)
                if status == 503:
                    break
                await stack.enter_async_context(dialled(hub.port))
            assert f"the limit of {files} open files is reached (ulimit -n)" in text
            assert (await health(hub.port))["status"] == "ok"
            while client.socket.fileno() < files:
                client = await stack.enter_async_context(dialled(hub.port))
            with pytest.raises(OSError):
                await client.send(handshake())
                await client.response()
                raise ConnectionError
            await until(lambda: f"the limit of {files} open files is reached" in caplog.text)
        monkeypatch.undo()
        await until(lambda: not hub._connections)
        async with connected(hub.port) as client:
            await client.is_processed()

    async def test_messages_for_slow_clients_are_bounded_together(
        self, start_hub: StartHub, caplog: pytest.LogCaptureFixture
    ) -> None:
        hub = await start_hub(max_total_queued_bytes=MIB)
        async with AsyncExitStack() as stack:
            for _ in range(5):
                stuck = await stack.enter_async_context(connected(hub.port, receive_buffer=4 * KIB))
                await stuck.subscribes("/t", "std_msgs/String", queue_length=10_000)
            talker = await stack.enter_async_context(connected(hub.port))
            await talker.advertises("/t", "std_msgs/String")
            for _ in range(20):
                await talker.send(publish("/t", "x" * KIB) * 200)
                await talker.is_processed()
                assert hub._limits.queued_bytes() <= MIB * 17 // 16
            seen = await health(hub.port)
            assert seen["dropped"] > 0
            assert 0 < seen["queued_bytes"] <= seen["max_queued_bytes"] * 17 // 16
            await until(lambda: "(--max-total-queued-bytes)" in caplog.text)

    @pytest.mark.parametrize("kind", ["large frame", "fragment", "fragments", "rosbridge"])
    async def test_incomplete_messages_are_bounded_together(
        self, start_hub: StartHub, caplog: pytest.LogCaptureFixture, kind: str
    ) -> None:
        hub = await start_hub(max_total_incoming_bytes=4 * MIB)
        async with connected(hub.port, "/?node=/greedy") as greedy, connected(hub.port) as fair:
            await fair.send(client_header(BINARY, 3 * MIB), bytes(MIB))
            await _send_in_part(greedy, kind, 2)
            await until(lambda: hub._limits.incoming_bytes() >= 3 * MIB)
            assert (await health(hub.port))["incoming_bytes"] >= 3 * MIB
            try:
                await _send_in_part(greedy, kind, 4, more=True)
            except OSError:
                pass  # It is closed already.
            await until(lambda: "/greedy" not in hub.graph.nodes)
            assert hub._limits.incoming_bytes() < 4 * MIB
            assert "/greedy is closed: too many bytes of incomplete messages" in caplog.text
            await fair.send(bytes(2 * MIB))
            assert (await fair.receive())["op"] == "status"
            await until(lambda: hub._limits.incoming_bytes() < MIB)


async def _send_in_part(client: Client, kind: str, mebibytes: int, *, more: bool = False) -> None:
    """Send some of a message, in one of the ways in which it may come in part."""
    data = bytes(mebibytes * MIB)
    if kind == "large frame":
        await client.send(*([] if more else [client_header(BINARY, 60 * MIB)]), data)
    elif kind == "fragment":
        await client.send(*([] if more else [client_header(BINARY & 0x7F, 60 * MIB)]), data)
    elif kind == "fragments":
        await client.send(frame(CONT if more else TEXT, data, fin=False))
    else:
        text = "x" * (mebibytes * MIB)
        await client.send(operation("fragment", id="a", num=int(more), total=3, data=text))


# Before the login.


@pytest.fixture
def tokens(tmp_path: Path) -> Path:
    path = tmp_path / "tokens.toml"
    path.write_text(f'[tokens.robot]\nsha256 = "{digest_of("robot")}"\nadmin = true\n', "utf-8")
    return path


HALF = STRANGER_BYTES // 2


@pytest.mark.both_loops
class TestStrangers:
    @pytest.mark.parametrize("fast_framing", [True, False])
    @pytest.mark.parametrize(
        "data",
        [
            client_header(BINARY, STRANGER_BYTES + 1),
            client_header(BINARY, 60 * MIB),
            client_header(TEXT, 60 * MIB),
            frame(TEXT, bytes(HALF), fin=False) + client_header(0x80 | CONT, HALF + 1),
            frame(TEXT, bytes(HALF), fin=False) + client_header(CONT, 60 * MIB),
        ],
        ids=["just too long", "long", "unfinished", "fragments", "fragments that go on"],
    )
    async def test_message_that_claims_too_much_is_refused_at_its_head(
        self, start_hub: StartHub, tokens: Path, data: bytes, fast_framing: bool
    ) -> None:
        hub = await start_hub(tokens=tokens, fast_framing=fast_framing)
        async with connected(hub.port) as stranger:
            await stranger.send(data)
            code, reason = await stranger.is_closed()
            assert code == 1009
            assert "65536" in reason or "size" in reason

    @pytest.mark.parametrize("fast_framing", [True, False])
    async def test_messages_behind_the_login_may_be_large(
        self, start_hub: StartHub, tokens: Path, fast_framing: bool
    ) -> None:
        hub = await start_hub(tokens=tokens, fast_framing=fast_framing)
        async with connected(hub.port) as client:
            await client.send(
                operation("auth", token="robot") + publish("/a", "x" * MIB) + frame(PING, b"end")
            )
            frames = dict([await client.frame(), await client.frame()])
            assert frames[PONG] == b"end"
            assert b"/a" in frames[TEXT]

    async def test_unfinished_messages_of_strangers_close_no_robot(
        self, start_hub: StartHub, tokens: Path
    ) -> None:
        hub = await start_hub(tokens=tokens, max_total_incoming_bytes=MIB)
        async with AsyncExitStack() as stack:
            robot = await stack.enter_async_context(
                connected(hub.port, Authorization="Bearer robot")
            )
            await robot.advertises("/map", "std_msgs/String")
            for _ in range(20):
                stranger = await stack.enter_async_context(connected(hub.port))
                await stranger.send(
                    client_header(BINARY, STRANGER_BYTES), bytes(STRANGER_BYTES - 1)
                )
            await until(lambda: hub._limits.incoming_bytes() > MIB - 3 * STRANGER_BYTES)
            await robot.send(publish("/map", "m" * (MIB - 4 * KIB)))
            await robot.is_processed()

    async def test_endless_head_of_a_request_is_refused(self, start_hub: StartHub) -> None:
        hub = await start_hub()
        async with dialled(hub.port) as client:
            await client.send(b"GET / HTTP/1.1\r\n" + b"A: %s\r\n" % (b"x" * 4000) * 40)
            assert (await client.response())[0] == 431
