"""The hub's settings."""

from __future__ import annotations

import math
from dataclasses import FrozenInstanceError, fields
from pathlib import Path
from typing import Any

import pytest

from fibws.errors import HubError
from fibws.hub.settings import Settings


@pytest.mark.parametrize("name", [field.name for field in fields(Settings)])
def test_every_setting_has_a_default_and_a_help_text(name: str) -> None:
    [field] = [field for field in fields(Settings) if field.name == name]
    assert getattr(Settings(), name) == field.default
    assert field.metadata["help"].endswith(".")


def test_by_default_the_hub_listens_on_this_machine_only() -> None:
    assert Settings().host == "127.0.0.1"
    assert Settings().allow_origin == ()


def test_settings_cannot_be_changed() -> None:
    with pytest.raises(FrozenInstanceError):
        Settings().port = 1  # type: ignore[misc]


@pytest.mark.parametrize("origin", ["https://lab.example", "http://lab:8000", "null", "*"])
def test_origin_may_be_a_scheme_and_host_or_any_or_null(origin: str) -> None:
    assert Settings(allow_origin=(origin,)).allow_origin == (origin,)


def test_origin_without_a_scheme_is_refused() -> None:
    with pytest.raises(HubError, match=r"--allow-origin.*lab\.example"):
        Settings(allow_origin=("lab.example",))


@pytest.mark.parametrize(
    ("setting", "value", "flag"),
    [
        ("port", -1, "--port"),
        ("port", 65536, "--port"),
        ("queue_length", -1, "--queue-length"),
        ("ping_interval", -0.1, "--ping-interval"),
        ("ping_interval", math.inf, "--ping-interval"),
        ("stall_timeout", math.nan, "--stall-timeout"),
    ],
)
def test_number_out_of_range_is_refused(setting: str, value: float, flag: str) -> None:
    values: dict[str, Any] = {setting: value}
    with pytest.raises(HubError) as caught:
        Settings(**values)
    assert flag in str(caught.value)
    assert str(value) in str(caught.value)


@pytest.mark.parametrize(
    ("setting", "value", "flag"),
    [
        ("hub_name", "x\udcff", "--hub-name"),
        ("record", Path("bad_\udcff"), "--record"),
        ("zenoh", ("tcp/\udcff:1",), "--zenoh"),
    ],
)
def test_text_that_messages_cannot_hold_is_refused(setting: str, value: Any, flag: str) -> None:
    with pytest.raises(HubError, match=f"{flag} is not UTF-8"):
        Settings(**{setting: value})


@pytest.mark.parametrize(
    ("files", "flags"),
    [
        ({"cert": "hub.pem"}, ("--cert", "--key")),
        ({"key": "hub.key"}, ("--key", "--cert")),
        ({"client_ca": "ca.pem"}, ("--client-ca", "--cert")),
    ],
)
def test_tls_requires_certificate_and_key(files: dict[str, str], flags: tuple[str, str]) -> None:
    values: dict[str, Any] = {name: Path(file) for name, file in files.items()}
    with pytest.raises(HubError) as caught:
        Settings(**values)
    assert all(flag in str(caught.value) for flag in flags)


def test_unknown_format_of_the_log_is_refused() -> None:
    xml: Any = "xml"
    with pytest.raises(HubError, match="--log-format must be text or json, got xml"):
        Settings(log_format=xml)
