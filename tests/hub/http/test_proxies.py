"""Proxies in front of the hub: whose headers count, and what they say."""

from __future__ import annotations

import ipaddress
import json

import pytest
from conftest import StartHub
from hypothesis import given
from hypothesis import strategies as st
from websockets.asyncio.client import connect
from websockets.datastructures import Headers

from fibws.errors import HubError
from fibws.hub import Settings
from fibws.hub.http.proxies import FOR, HOST, PROTO, TrustedProxies, is_secure

from ..raw_client import dialled

CLIENT, OTHER, INNER, PROXY = "203.0.113.9", "198.51.100.7", "10.0.0.5", "127.0.0.1"


def resolved(
    *forwarded: str,
    peer: str = PROXY,
    trusted: tuple[str, ...] = (PROXY, "10.0.0.0/8"),
    tls: bool = False,
    **headers: str,
) -> tuple[str, Headers]:
    """Return the client's address and the headers that are left."""
    found = Headers([("Host", "hub:9090"), *((FOR, each) for each in forwarded)])
    for name, value in headers.items():
        found[name.replace("_", "-")] = value
    return TrustedProxies(trusted).resolve(peer, found, tls=tls), found


@pytest.mark.parametrize(
    ("forwarded", "address"),
    [
        ((), PROXY),
        ((CLIENT,), CLIENT),
        ((f"{CLIENT}:5120",), CLIENT),
        (("[2001:db8::5]:5120",), "2001:db8::5"),
        (("2001:DB8::0:5",), "2001:db8::5"),
        ((f"{OTHER}, {CLIENT}",), CLIENT),
        ((OTHER, CLIENT), CLIENT),
        ((f"{OTHER}, {CLIENT}, {INNER}",), CLIENT),
        ((f"{CLIENT},{INNER}, ,",), CLIENT),
        ((INNER,), INNER),
        (("unknown",), PROXY),
        ((f"{CLIENT}, unknown, {INNER}",), INNER),
        (("::ffff:203.0.113.9",), CLIENT),
        (("1.2.3.4.5", "<script>"), PROXY),
    ],
)
def test_client_is_the_nearest_hop_that_is_not_trusted(
    forwarded: tuple[str, ...], address: str
) -> None:
    assert resolved(*forwarded)[0] == address


@pytest.mark.parametrize("peer", [OTHER, "::1", "unknown"])
def test_headers_of_strangers_count_for_nothing(peer: str) -> None:
    address, headers = resolved(
        CLIENT, peer=peer, X_Forwarded_Proto="https", X_Forwarded_Host="robot.example"
    )
    assert address == peer
    assert not is_secure(headers)
    assert headers["Host"] == "hub:9090"
    assert HOST not in headers
    assert FOR in headers  # It shows that there is a proxy.


@pytest.mark.parametrize(
    "forwarded",
    [
        *("unknown", "unix:", "_hidden", "", ",", f"{CLIENT}, unknown", f"unknown, {PROXY}"),
        f"{CLIENT}%eth0",
    ],
)
def test_unknown_client_is_not_this_machine(forwarded: str) -> None:
    """The header stays, which is the sign that another machine may be the client."""
    address, headers = resolved(forwarded)
    assert address == PROXY
    assert FOR in headers
    assert FOR not in resolved(CLIENT)[1]


@pytest.mark.parametrize("name", [FOR, "Forwarded"])
def test_proxy_that_is_not_trusted_is_logged_once(
    name: str, caplog: pytest.LogCaptureFixture
) -> None:
    proxies = TrustedProxies([PROXY])
    proxies.resolve(OTHER, Headers({"Host": "hub"}), tls=False)
    proxies.resolve(PROXY, Headers({name: CLIENT}), tls=False)
    assert not caplog.records
    for _ in range(3):
        proxies.resolve(OTHER, Headers({name: CLIENT}), tls=False)
    (record,) = caplog.records
    assert f"--trusted-proxy {OTHER}" in record.getMessage() and name in record.getMessage()


@pytest.mark.parametrize(
    ("forwarded", "status"), [("127.0.0.1", 200), (CLIENT, 403), ("unix:", 403), ("unknown", 403)]
)
async def test_metrics_are_for_clients_whose_address_is_known(
    start_hub: StartHub, forwarded: str, status: int
) -> None:
    hub = await start_hub(trusted_proxy=("127.0.0.1",))
    async with dialled(hub.port) as client:
        await client.send(
            f"GET /metrics HTTP/1.1\r\nHost: localhost\r\n{FOR}: {forwarded}\r\n\r\n".encode()
        )
        assert (await client.response())[0] == status


def test_proxy_may_be_an_ipv4_address_on_a_socket_of_ipv6() -> None:
    assert resolved(CLIENT, peer="::ffff:127.0.0.1")[0] == CLIENT


@pytest.mark.parametrize(
    ("proto", "secure"),
    [("https", True), ("HTTPS", True), ("wss", True), ("http", False), ("https, http", False)],
)
def test_nearest_proxy_names_the_scheme_of_the_browser(proto: str, secure: bool) -> None:
    _, headers = resolved(X_Forwarded_Proto=proto)
    assert is_secure(headers) is secure
    assert headers[PROTO] in ("http", "https")


def test_tls_between_a_proxy_and_the_hub_says_nothing_of_the_browser() -> None:
    assert not is_secure(resolved(tls=True)[1])
    assert is_secure(resolved(peer=CLIENT, tls=True)[1])


def test_host_in_the_address_bar_is_known() -> None:
    assert resolved(X_Forwarded_Host="evil.example, robot.example")[1]["Host"] == "robot.example"


@given(
    st.lists(
        st.sampled_from([CLIENT, OTHER, INNER, PROXY, "unknown", ""])
        | st.text(st.characters(min_codepoint=32, max_codepoint=126))
    )
)
def test_any_header_gives_an_address(values: list[str]) -> None:
    address, _ = resolved(*values)
    assert str(ipaddress.ip_address(address)) == address


@pytest.mark.parametrize("network", ["proxy", "10.0.0.0/33", "", "10.0.0.1:80"])
def test_invalid_network_is_refused(network: str) -> None:
    with pytest.raises(HubError, match="trusted_proxy"):
        Settings(trusted_proxy=(network,))


@pytest.mark.parametrize("trusted", [True, False])
async def test_address_behind_a_proxy_is_shown(start_hub: StartHub, trusted: bool) -> None:
    hub = await start_hub(trusted_proxy=("127.0.0.0/8",) if trusted else ())
    async with connect(hub.url, additional_headers={FOR: CLIENT}) as client:
        await client.send(
            json.dumps({"op": "subscribe", "topic": "/connected_clients", "id": "clients"})
        )
        [shown] = json.loads(await client.recv())["msg"]["clients"]
        assert shown["ip_address"] == (CLIENT if trusted else "127.0.0.1")
