"""What an operator can set."""

from __future__ import annotations

from dataclasses import FrozenInstanceError, fields

import pytest

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
