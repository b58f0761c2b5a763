"""/livez, /readyz and /healthz, and who may read all of /healthz."""

from __future__ import annotations

import asyncio
import json
from pathlib import Path
from typing import Any

import pytest
from conftest import StartHub
from websockets.datastructures import Headers
from websockets.http11 import Request, Response

from fibws import __version__
from fibws.hub.server import HubServer

from ..raw_client import connected, dialled, handshake
from ..token_clients import entry

FILE = entry("operator", "admin = true", "one")
FILE += entry("guest", 'allow = {subscribe = ["/**"]}', "two")
HERE, OTHER = "127.0.0.1", "192.0.2.7"


def get(hub: HubServer, path: str, address: str = HERE, **headers: str) -> Response:
    """Return the response to a request from an address."""
    fields = Headers({name.replace("_", "-"): value for name, value in headers.items()})
    response = hub._requests.respond(Request(path, fields), address)
    assert response is not None
    return response


def health(
    hub: HubServer, address: str = HERE, path: str = "/healthz", **headers: str
) -> dict[str, Any]:
    response = get(hub, path, address, **headers)
    assert response.status_code == 200
    found: dict[str, Any] = json.loads(bytes(response.body))
    return found


@pytest.fixture
async def guarded(start_hub: StartHub, tmp_path: Path) -> HubServer:
    """A hub with tokens."""
    path = tmp_path / "tokens.toml"
    path.write_text(FILE, "utf-8")
    return await start_hub(tokens=path)


class TestLiveAndReady:
    @pytest.mark.parametrize("address", [HERE, OTHER])
    @pytest.mark.parametrize("path", ["/livez", "/readyz"])
    async def test_everybody_may_ask(self, guarded: HubServer, path: str, address: str) -> None:
        response = get(guarded, path, address, Host="10.0.0.3:9090")
        assert response.status_code == 200
        assert response.headers["Cache-Control"] == "no-store"
        assert get(guarded, path, address, Host="any.name.example").status_code == 200

    async def test_late_loop_is_not_alive(
        self, hub: HubServer, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        now = hub._lag._now() + 5.0
        monkeypatch.setattr(hub._lag, "_now", lambda: now)
        response = get(hub, "/livez")
        assert response.status_code == 503
        assert json.loads(bytes(response.body))["lag_seconds"] > 4.0
        monkeypatch.undo()

    async def test_draining_hub_is_alive_but_not_ready(self, hub: HubServer) -> None:
        async with connected(hub.port) as client:
            draining = asyncio.create_task(hub.drain(600))
            assert await client.is_closed() == (1012, "service restart")
            async with dialled(hub.port) as prober:
                await prober.send(b"GET /readyz HTTP/1.1\r\n\r\n")
                status, _, body = await prober.response()
            assert (status, json.loads(body)) == (503, {"status": "draining"})
            assert get(hub, "/livez").status_code == 200
            assert health(hub)["status"] == "draining"
            client.leave()
            await draining

    async def test_draining_hub_opens_no_websocket(self, hub: HubServer) -> None:
        async with connected(hub.port) as client:
            draining = asyncio.create_task(hub.drain(600))
            await client.is_closed()
            async with dialled(hub.port) as late:
                await late.send(handshake())
                assert (await late.response())[0] == 503
            client.leave()
            await draining


class TestHealth:
    async def test_open_hub_shows_all_to_its_own_machine(self, hub: HubServer) -> None:
        for address in (HERE, "::1"):
            found = health(hub, address)
            assert found["status"] == "ok"
            assert {"clients", "dropped", "slow_clients"} <= found.keys()

    @pytest.mark.parametrize(
        ("address", "headers"),
        [
            (OTHER, {}),
            ("", {}),
            (HERE, {"X_Forwarded_For": OTHER}),
            (HERE, {"Forwarded": f"for={OTHER}"}),
            (HERE, {"X_Real_IP": OTHER}),
            (HERE, {"Via": "1.1 proxy"}),
            (HERE, {"Host": "rebound.example"}),
        ],
    )
    async def test_open_hub_shows_others_little(
        self, hub: HubServer, address: str, headers: dict[str, str]
    ) -> None:
        assert health(hub, address, **headers) == {"status": "ok", "version": __version__}

    @pytest.mark.parametrize("address", [HERE, OTHER])
    async def test_admin_may_see_all(self, guarded: HubServer, address: str) -> None:
        assert "clients" in health(guarded, address, Authorization="Bearer one", Host="any.example")
        assert "clients" not in health(guarded, address, "/healthz?token=one")

    @pytest.mark.parametrize("token", ["two", "wrong", ""])
    async def test_others_see_only_the_status(self, guarded: HubServer, token: str) -> None:
        headers = {"Authorization": f"Bearer {token}"} if token else {}
        assert health(guarded, HERE, **headers) == {"status": "ok"}

    async def test_it_may_be_public(self, start_hub: StartHub) -> None:
        hub = await start_hub(public_metrics=True)
        assert "clients" in health(hub, OTHER, Host="any.example")


async def test_proxy_that_is_not_trusted_does_not_open_the_metrics(start_hub: StartHub) -> None:
    hub = await start_hub()
    for headers, status in (({}, 200), ({"X_Forwarded_For": OTHER}, 403)):
        async with dialled(hub.port) as client:
            await client.send(handshake("/metrics", Upgrade="none", **headers))
            assert (await client.response())[0] == status
