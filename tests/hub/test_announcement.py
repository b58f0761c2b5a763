"""The addresses that the hub prints when it starts."""

from __future__ import annotations

import re
import socket
from types import SimpleNamespace

import ifaddr
import pytest

from fibws.hub import Settings, announcement
from fibws.hub.announcement import addresses_for_others

LAN, VPN, V6 = "192.168.1.20", "10.8.0.2", "2001:db8::5"
URL = "ws://127.0.0.1:9090"


@pytest.fixture(autouse=True)
def machine(monkeypatch: pytest.MonkeyPatch) -> None:
    """A machine with two networks, called robot."""
    interfaces: list[list[object]] = [
        ["127.0.0.1", ("::1", 0, 0)],
        [LAN, (V6, 0, 0), ("fe80::1", 0, 2)],
        [VPN, LAN],
    ]
    adapters = [
        SimpleNamespace(ips=[SimpleNamespace(ip=ip) for ip in addresses])
        for addresses in interfaces
    ]
    monkeypatch.setattr(ifaddr, "get_adapters", lambda: adapters)
    monkeypatch.setattr(socket, "gethostname", lambda: "Robot")


@pytest.mark.parametrize(
    ("host", "addresses"),
    [
        ("127.0.0.1", []),
        ("127.0.0.2", []),
        ("::1", []),
        ("localhost", []),
        ("0.0.0.0", [VPN, LAN]),
        ("::", [VPN, LAN, f"[{V6}]"]),
        ("", [VPN, LAN, f"[{V6}]"]),
        (LAN, [LAN]),
        (V6, [f"[{V6}]"]),
        ("robot.lan", ["robot.lan"]),
    ],
)
def test_addresses_are_those_of_the_interfaces_that_it_listens_on(
    host: str, addresses: list[str]
) -> None:
    assert addresses_for_others(host) == addresses


def test_hub_for_this_machine_has_one_line() -> None:
    text = announcement.announcement(Settings(), URL)
    assert text.count("\n") == 0
    assert URL in text
    assert "http://127.0.0.1:9090/" in text


def test_every_address_is_printed_for_nodes_and_for_browsers() -> None:
    text = announcement.announcement(Settings(host=""), URL)
    for address in (LAN, VPN, f"[{V6}]"):
        assert f"ws://{address}:9090" in text
        assert f"http://{address}:9090/" in text
    assert "fe80" not in text


@pytest.mark.parametrize("allowed", [(), ("http://robot:8080",), ("https://robot:9090",)])
def test_option_for_the_machines_name_is_printed(allowed: tuple[str, ...]) -> None:
    text = announcement.announcement(Settings(host="0.0.0.0", allow_origin=allowed), URL)
    [option] = re.findall(r"--allow-origin (\S+)", text)
    assert option == "http://robot:9090"
    assert Settings(allow_origin=(option,)).allow_origin == (option,)


@pytest.mark.parametrize("allowed", ["*", "http://robot:9090", "http://ROBOT:9090/"])
def test_option_is_not_printed_if_the_name_is_allowed(allowed: str) -> None:
    text = announcement.announcement(Settings(host="0.0.0.0", allow_origin=(allowed,)), URL)
    assert "--allow-origin" not in text


def test_machine_without_a_network_prints_no_empty_list(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ifaddr, "get_adapters", list)
    assert announcement.announcement(Settings(host="0.0.0.0"), URL).count("\n") == 0


def test_master_for_other_machines_is_printed_if_they_may_use_it() -> None:
    local = "http://localhost:11311/"
    for settings, others in [
        (Settings(), []),
        (Settings(ros1_allow=("10.0.0.0/8",)), [f"http://{VPN}:11311/", f"http://{LAN}:11311/"]),
        (Settings(ros1_allow=("10.0.0.0/8",), ros1_host="robot"), []),
    ]:
        text = announcement.announcement(settings, URL, local)
        assert re.findall(r"http://\S+:11311/", text) == [local, *others]
