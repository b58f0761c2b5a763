"""The hub's settings."""

from __future__ import annotations

import math
from dataclasses import Field, FrozenInstanceError, fields
from pathlib import Path
from typing import Any

import pytest

from fibws.errors import HubError, SettingError
from fibws.hub.settings import _NEEDED, Settings, flag_of


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
    with pytest.raises(HubError, match=r"allow_origin=.*lab\.example"):
        Settings(allow_origin=("lab.example",))


@pytest.mark.parametrize(
    ("setting", "value", "argument"),
    [
        ("port", -1, "port="),
        ("port", 65536, "port="),
        ("queue_length", -1, "queue_length="),
        ("ping_interval", -0.1, "ping_interval="),
        ("ping_interval", math.inf, "ping_interval="),
        ("stall_timeout", math.nan, "stall_timeout="),
    ],
)
def test_number_out_of_range_is_refused(setting: str, value: float, argument: str) -> None:
    values: dict[str, Any] = {setting: value}
    with pytest.raises(HubError) as caught:
        Settings(**values)
    assert argument in str(caught.value)
    assert str(value) in str(caught.value)


@pytest.mark.parametrize(
    ("setting", "value", "argument"),
    [
        ("hub_name", "x\udcff", "hub_name="),
        ("record", Path("bad_\udcff"), "record="),
        ("zenoh", ("tcp/\udcff:1",), "zenoh="),
    ],
)
def test_text_that_messages_cannot_hold_is_refused(setting: str, value: Any, argument: str) -> None:
    with pytest.raises(HubError, match=rf"{argument}\.\.\.\) is not UTF-8"):
        Settings(**{setting: value})


@pytest.mark.parametrize(
    ("files", "arguments"),
    [
        ({"cert": "hub.pem"}, ("cert=", "key=")),
        ({"key": "hub.key"}, ("key=", "cert=")),
        ({"client_ca": "ca.pem"}, ("client_ca=", "cert=")),
    ],
)
def test_tls_requires_certificate_and_key(
    files: dict[str, str], arguments: tuple[str, str]
) -> None:
    values: dict[str, Any] = {name: Path(file) for name, file in files.items()}
    with pytest.raises(HubError) as caught:
        Settings(**values)
    assert all(argument in str(caught.value) for argument in arguments)


def test_unknown_format_of_the_log_is_refused() -> None:
    xml: Any = "xml"
    with pytest.raises(HubError, match=r"log_format=.* must be text or json, got xml"):
        Settings(log_format=xml)


@pytest.mark.parametrize(
    ("setting", "value"),
    [
        ("port", "9090"),
        ("port", True),
        ("ros1", 1.5),
        ("drain", "5"),
        ("self_signed", 1),
        ("tokens", "tokens.toml"),
        ("allow_origin", "https://lab.example"),
        ("allow_origin", (5,)),
        ("hub_name", None),
    ],
)
def test_value_of_another_type_is_refused_by_the_name_of_its_argument(
    setting: str, value: Any
) -> None:
    with pytest.raises(SettingError) as caught:
        Settings(**{setting: value})
    assert f"Settings({setting}=...) must be " in str(caught.value)
    assert repr(value) in str(caught.value)


def test_unknown_argument_names_the_nearest_one() -> None:
    values: dict[str, Any] = {"allow_orign": ("*",)}
    with pytest.raises(TypeError, match=r"allow_orign; did you mean allow_origin\?"):
        Settings(**values)


@pytest.mark.parametrize("setting", fields(Settings), ids=lambda each: each.name)
def test_error_has_the_name_of_the_argument(setting: Field[Any]) -> None:
    error = SettingError(f"--{flag_of(setting)} must be small")
    assert str(error) == f"Settings({setting.name}=...) must be small"


OTHERS: dict[str, Any] = {
    "tokens": Path("tokens.toml"),
    "join": ("ws://lab",),
    "zenoh": ("auto",),
    "ros1": 0,
    "ros2": ("tcp/robot:7447",),
    "record": Path("recordings"),
}
"""Settings without which some have no effect."""
VALUES: dict[str, Any] = {
    "auth_timeout": 1.0,
    "ros1_allow": ("10.0.0.0/8",),
    "ros1_state": Path("file"),
    "join_prefix": "/robot",
    "join_export": ("/a",),
    "join_import": ("/a",),
    "zenoh_config": Path("file"),
    "domain": "lab",
    "ros2_domain": 7,
    "record_at_start": False,
    "record_mcap": True,
    "record_compression": "lz4",
    "record_size": 5,
    "record_duration": 60.0,
    "record_files": 3,
    "record_min_space": 5,
    "record_buffer": 5,
}


@pytest.mark.parametrize("name", _NEEDED)
def test_setting_that_needs_another_is_told_from_one_that_has_an_effect(name: str) -> None:
    values = {name: VALUES[name]}
    assert Settings().without_effect() == []
    [error] = Settings(**values).without_effect()
    needed = next(each for each in OTHERS if each in _NEEDED[name])
    assert f"{name}=" in str(error) and f"{needed}=" in str(error)
    assert Settings(**values, **{needed: OTHERS[needed]}).without_effect() == []


@pytest.mark.parametrize(
    "values", [{"jwt_algorithm": "EdDSA"}, {"jwt_audience": "robots"}, {"jwt_leeway": 0.0}]
)
def test_hub_does_not_start_without_the_authentication_that_was_meant(
    values: dict[str, Any],
) -> None:
    with pytest.raises(SettingError, match=r"jwt_key="):
        Settings(**values)
    Settings(**values, jwt_key=Path("key.pem"))
