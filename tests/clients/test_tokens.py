"""Clients at a hub that wants a token."""

from __future__ import annotations

from typing import Any

import pytest

from .casts import CASTS, ROSLIBPY, marked

WITH_TOKENS = [cast for cast in CASTS if "tokens" in cast.scenarios]
every = pytest.mark.parametrize("cast", [marked(cast, id=str(cast)) for cast in WITH_TOKENS])
javascript = pytest.mark.parametrize(
    "cast", [marked(cast, id=str(cast)) for cast in WITH_TOKENS if cast.library != ROSLIBPY]
)
roslibpy = pytest.mark.parametrize(
    "cast", [marked(cast, id=str(cast)) for cast in WITH_TOKENS if cast.library == ROSLIBPY]
)


@every
def test_token_in_the_url_lets_a_client_in(seen: Any) -> None:
    assert seen == {"data": 8}


@roslibpy
def test_token_in_a_header_lets_a_client_in(seen: Any) -> None:
    assert seen == {"data": 8}


@javascript
def test_token_follows_by_the_operation_auth(seen: Any) -> None:
    assert seen == {"data": 8}


@javascript
def test_wrong_token_closes_the_connection(seen: Any) -> None:
    assert seen == "closed"


@javascript
def test_missing_right_is_named(seen: Any) -> None:
    [status] = seen
    assert status.startswith("error: advertise: missing right publish for /forbidden")
