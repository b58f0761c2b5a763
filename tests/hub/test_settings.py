"""What an operator can set."""

from __future__ import annotations

from dataclasses import FrozenInstanceError, fields

import pytest

from fibws.errors import HubError
from fibws.hub.settings import Settings


@pytest.mark.parametrize("name", [field.name for field in fields(Settings)])
def test_every_setting_has_a_default_and_says_what_it_is_for(name: str) -> None:
    [field] = [field for field in fields(Settings) if field.name == name]
    assert getattr(Settings(), name) == field.default
    assert field.metadata["help"].endswith(".")


def test_the_hub_listens_on_this_machine_alone_unless_told_otherwise() -> None:
    assert Settings().host == "127.0.0.1"
    assert Settings().allow_origin == ()


def test_settings_do_not_change() -> None:
    with pytest.raises(FrozenInstanceError):
        Settings().port = 1  # type: ignore[misc]


@pytest.mark.parametrize("origin", ["https://lab.example", "http://lab:8000", "null", "*"])
def test_an_origin_is_what_a_browser_sends_or_a_word_for_any_or_none(origin: str) -> None:
    assert Settings(allow_origin=(origin,)).allow_origin == (origin,)


def test_a_host_alone_is_no_origin() -> None:
    with pytest.raises(HubError, match="not lab"):
        Settings(allow_origin=("lab.example",))
