"""Audit events: their fields, their counts, and limits on their lines."""

from __future__ import annotations

import asyncio
import logging
import urllib.error
import urllib.request
from pathlib import Path
from typing import Any

import pytest
from conftest import StartHub

from fibws.hub.log.audit import Audit, ClientIdentity
from fibws.hub.log.text import MAX_LINES, REPEAT_AFTER
from fibws.hub.server import HubServer

from ..raw_client import Client, connected, dialled, handshake
from ..token_clients import entry

GUEST = ClientIdentity("guest", "10.0.0.7")


class Clock:
    """A clock that the test sets."""

    def __init__(self) -> None:
        self.now = 0.0

    def __call__(self) -> float:
        return self.now


@pytest.fixture
def clock() -> Clock:
    return Clock()


@pytest.fixture
def audit(clock: Clock, caplog: pytest.LogCaptureFixture) -> Audit:
    caplog.set_level(logging.INFO, "fibws.hub.audit")
    return Audit(clock, lambda node: GUEST if node == "/joystick" else ClientIdentity())


def events(caplog: pytest.LogCaptureFixture) -> list[dict[str, Any]]:
    """Return the events with their fields, without those that are empty."""
    return [
        {"event": vars(each)["event"], **{k: v for k, v in vars(each)["fields"].items() if v}}
        for each in caplog.records
        if each.name == "fibws.hub.audit"
    ]


def test_refusal_names_the_client_by_its_node(
    audit: Audit, caplog: pytest.LogCaptureFixture
) -> None:
    audit.refused("right", 'publish /cmd_vel: missing right "publish"', node="/joystick")
    assert events(caplog) == [
        {
            "event": "refused",
            "reason": "right",
            "node": "/joystick",
            "principal": "guest",
            "ip": "10.0.0.7",
        }
    ]
    assert caplog.messages == [
        'Refused /joystick (guest, 10.0.0.7): publish /cmd_vel: missing right "publish".'
    ]


def test_refusal_before_there_is_a_node_names_the_address(
    audit: Audit, caplog: pytest.LogCaptureFixture
) -> None:
    audit.refused("authentication", "unknown token", ip="10.0.0.8")
    assert events(caplog) == [
        {"event": "refused", "reason": "authentication", "ip": "10.0.0.8"},
    ]


def test_repeated_refusals_are_counted_but_logged_once(
    audit: Audit, clock: Clock, caplog: pytest.LogCaptureFixture
) -> None:
    for _ in range(1000):
        audit.refused("authentication", "unknown token", ip="10.0.0.8")
    assert len(caplog.records) == 1
    clock.now = REPEAT_AFTER
    audit.refused("authentication", "unknown token", ip="10.0.0.8")
    assert "(999 more since the last line)" in caplog.messages[-1]
    assert {reason: n for reason, n in audit.refusals.items() if n} == {"authentication": 1001}


def test_repeated_logins_are_logged_once(
    audit: Audit, clock: Clock, caplog: pytest.LogCaptureFixture
) -> None:
    for _ in range(1000):
        audit.login(principal="guest", ip="10.0.0.8")
        audit.login(principal="other", ip="10.0.0.8")
    assert [event["principal"] for event in events(caplog)] == ["guest", "other"]
    clock.now = REPEAT_AFTER
    audit.login(principal="guest", ip="10.0.0.8")
    assert "(999 more since the last line)" in caplog.messages[-1]


def test_logins_of_many_clients_are_all_logged(
    audit: Audit, caplog: pytest.LogCaptureFixture
) -> None:
    for number in range(500):
        audit.login(principal="robot", ip=f"10.0.{number % 256}.{number // 256}")
    assert len(caplog.records) == 500


def test_refusals_of_many_clients_are_limited(
    audit: Audit, caplog: pytest.LogCaptureFixture
) -> None:
    for number in range(1000):
        audit.refused("origin", f"https://{number}.example may not connect", ip=f"10.0.0.{number}")
    assert len(caplog.records) == MAX_LINES
    assert audit.refusals["origin"] == 1000


def test_refusal_may_be_counted_without_a_line(
    audit: Audit, caplog: pytest.LogCaptureFixture
) -> None:
    audit.count("limit")
    assert (audit.refusals["limit"], caplog.records) == (1, [])


def test_changes_are_recorded_with_their_author(
    audit: Audit, caplog: pytest.LogCaptureFixture
) -> None:
    audit.login(principal="guest", ip="10.0.0.7")
    audit.parameter_written("/gain", node="/joystick")
    audit.parameter_written("/gain", node="/joystick", deleted=True)
    audit.node_killed("/camera", node="/joystick")
    audit.node_unregistered("/lidar", node="/joystick")
    audit.name_taken(node="/camera", principal="robot", ip="10.0.0.9")
    audit.hub_joined("cloud", "wss://cloud", node="/hub")
    audit.hub_lost("cloud", "the connection was closed", node="/hub")
    audit.reloaded("tokens", ["token guest revoked", "1 client closed"], [])
    audit.reload_failed("certificates", "file not found")
    joystick = {"node": "/joystick", "principal": "guest", "ip": "10.0.0.7"}
    assert events(caplog) == [
        {"event": "login", "principal": "guest", "ip": "10.0.0.7"},
        {"event": "parameter_set", "parameter": "/gain", **joystick},
        {"event": "parameter_deleted", "parameter": "/gain", **joystick},
        {"event": "node_killed", "killed": "/camera", **joystick},
        {"event": "node_unregistered", "unregistered": "/lidar", **joystick},
        {"event": "name_taken", "node": "/camera", "principal": "robot", "ip": "10.0.0.9"},
        {"event": "hub_joined", "hub": "cloud", "node": "/hub"},
        {"event": "hub_lost", "hub": "cloud", "node": "/hub", "why": "the connection was closed"},
        {
            "event": "reloaded",
            "what": "tokens",
            "changes": "token guest revoked, 1 client closed",
        },
        {"event": "reload_failed", "what": "certificates", "error": "file not found"},
    ]


@pytest.mark.parametrize("files", [["/etc/tokens.toml"], []])
def test_reload_that_changes_nothing_is_a_warning(
    audit: Audit, caplog: pytest.LogCaptureFixture, files: list[str]
) -> None:
    audit.reloaded("tokens", [], [Path(each) for each in files])
    (record,) = caplog.records
    assert record.levelno == logging.WARNING
    assert all(each in record.getMessage() for each in ["Reloaded", *files])
    assert events(caplog) == [{"event": "reloaded", "what": "tokens"}]


def test_text_of_a_client_stays_on_one_line(audit: Audit, caplog: pytest.LogCaptureFixture) -> None:
    audit.refused("right", "publish /a\n[INFO] forged", node="/x")
    audit.parameter_written("/a\x1b[31m", node="/x")
    assert not any("\n" in text or "\x1b" in text for text in caplog.messages)


class TestHub:
    """Events that clients of a real hub cause."""

    FILE = entry("operator", "admin = true", "one")
    FILE += entry("guest", 'allow = {call = ["/**"], node = ["/guest", "/page"]}', "two")

    @pytest.fixture
    async def guarded(
        self, start_hub: StartHub, tmp_path: Path, caplog: pytest.LogCaptureFixture
    ) -> HubServer:
        caplog.set_level(logging.INFO, "fibws.hub.audit")
        path = tmp_path / "tokens.toml"
        path.write_text(self.FILE, "utf-8")
        return await start_hub(tokens=path)

    async def call(self, client: Client, service: str, **args: object) -> None:
        """Call a service, and wait for the response."""
        await client.send_operation("call_service", service=service, args=args, id="1")
        while (await client.receive())["op"] != "service_response":
            pass

    async def test_login_is_recorded(
        self, guarded: HubServer, caplog: pytest.LogCaptureFixture
    ) -> None:
        async with connected(guarded.port, Authorization="Bearer one") as client:
            await client.is_processed()
        assert events(caplog) == [{"event": "login", "principal": "operator", "ip": "127.0.0.1"}]

    @pytest.mark.parametrize(
        ("token", "path", "reason"),
        [("wrong", "/", "authentication"), ("two", "/?node=/robot", "right")],
    )
    async def test_client_that_may_not_enter_is_recorded(
        self,
        guarded: HubServer,
        caplog: pytest.LogCaptureFixture,
        token: str,
        path: str,
        reason: str,
    ) -> None:
        async with connected(guarded.port, path, Authorization=f"Bearer {token}") as client:
            await client.is_closed()
        found = events(caplog)[-1]
        assert (found["event"], found["reason"], found["ip"]) == ("refused", reason, "127.0.0.1")
        assert found.get("principal") == (None if reason == "authentication" else "guest")

    async def test_operations_without_a_token_are_recorded_once(
        self, guarded: HubServer, caplog: pytest.LogCaptureFixture
    ) -> None:
        async with connected(guarded.port) as client:
            for _ in range(3):
                await client.send_operation("call_service", service="/rosapi/get_time")
                assert (await client.receive())["op"] == "status"
        (found,) = events(caplog)
        assert found == {"event": "refused", "reason": "authentication", "ip": "127.0.0.1"}
        (record,) = (each for each in caplog.records if each.levelno >= logging.WARNING)
        assert "call_service: this hub needs a token" in record.getMessage()
        assert guarded.audit.refusals["authentication"] == 1

    @pytest.mark.parametrize("protocol", ["foxglove.sdk.v1", "fibws.hub.v1", "fibws.v1", ""])
    async def test_client_without_a_token_is_recorded_in_each_protocol(
        self,
        start_hub: StartHub,
        tmp_path: Path,
        caplog: pytest.LogCaptureFixture,
        protocol: str,
    ) -> None:
        path = tmp_path / "tokens.toml"
        path.write_text(self.FILE, "utf-8")
        hub = await start_hub(tokens=path, auth_timeout=0.01)
        headers: dict[str, Any] = {"Sec-WebSocket-Protocol": protocol} if protocol else {}
        async with connected(hub.port, **headers) as client:
            await client.is_closed()
        (found,) = events(caplog)
        assert found == {"event": "refused", "reason": "authentication", "ip": "127.0.0.1"}

    @pytest.mark.parametrize("token", [None, "wrong"])
    @pytest.mark.parametrize("path", ["/metrics", "/assets/package/a/b.stl", "/recordings/a.bag"])
    async def test_requests_that_need_a_token_are_recorded(
        self,
        start_hub: StartHub,
        tmp_path: Path,
        caplog: pytest.LogCaptureFixture,
        path: str,
        token: str | None,
    ) -> None:
        tokens = tmp_path / "tokens.toml"
        tokens.write_text(self.FILE, "utf-8")
        hub = await start_hub(tokens=tokens, record=tmp_path / "bags", record_at_start=False)
        headers = {"Authorization": f"Bearer {token}"} if token is not None else {}
        request = urllib.request.Request(f"http://127.0.0.1:{hub.port}{path}", headers=headers)
        with pytest.raises(urllib.error.HTTPError) as refused:
            await asyncio.to_thread(urllib.request.urlopen, request)
        refused.value.close()
        assert refused.value.code == 401
        (found,) = events(caplog)
        assert found == {"event": "refused", "reason": "authentication", "ip": "127.0.0.1"}

    async def test_missing_right_is_recorded_whatever_needs_it(
        self, guarded: HubServer, caplog: pytest.LogCaptureFixture
    ) -> None:
        async with connected(guarded.port, "/?node=/guest", Authorization="Bearer two") as client:
            for op in ("subscribe", "advertise"):
                await client.send_operation(op, topic="/t", type="std_msgs/Int32")
                await client.receive()
            await client.send_operation("advertise_service", service="/s", type="std_srvs/Empty")
            await client.receive()
            await self.call(client, "/rosapi/set_param", name="/gain", value="1")
        texts = [text for text in caplog.messages if text.startswith("Refused /guest (guest, ")]
        for right in ("subscribe", "publish", "provide", "param_write"):
            assert any(right in text for text in texts), (right, texts)
        assert guarded.audit.refusals["right"] == len(texts) == 4

    async def test_parameters_and_kills_are_recorded_with_their_author(
        self, guarded: HubServer, caplog: pytest.LogCaptureFixture
    ) -> None:
        async with (
            connected(guarded.port, "/?node=/boss", Authorization="Bearer one") as boss,
            connected(guarded.port, "/?node=/page", Authorization="Bearer two") as page,
        ):
            await page.is_processed()
            caplog.clear()
            await self.call(boss, "/rosapi/set_param", name="/gain", value="1")
            await self.call(boss, "/rosapi/delete_param", name="/gain")
            await self.call(boss, "/rosapi/kill_node", node="/page")
        author = {"node": "/boss", "principal": "operator", "ip": "127.0.0.1"}
        assert events(caplog) == [
            {"event": "parameter_set", "parameter": "/gain", **author},
            {"event": "parameter_deleted", "parameter": "/gain", **author},
            {"event": "node_killed", "killed": "/page", **author},
        ]

    async def test_client_that_loses_its_name_is_recorded(
        self, guarded: HubServer, caplog: pytest.LogCaptureFixture
    ) -> None:
        async with connected(guarded.port, "/?node=/page", Authorization="Bearer two") as older:
            await older.is_processed()
            async with connected(guarded.port, "/?node=/page", Authorization="Bearer two"):
                assert (await older.is_closed())[0] == 4001
        client = {"node": "/page", "principal": "guest", "ip": "127.0.0.1"}
        assert {"event": "name_taken", **client} in events(caplog)

    async def test_page_of_another_origin_is_recorded(
        self, guarded: HubServer, caplog: pytest.LogCaptureFixture
    ) -> None:
        async with dialled(guarded.port) as client:
            await client.send(handshake(Origin="https://evil.example"))
            assert (await client.response())[0] == 403
        assert events(caplog)[-1]["reason"] == "origin"
        assert "evil.example" in caplog.text
