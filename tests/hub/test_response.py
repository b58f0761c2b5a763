"""Plain HTTP responses."""

from __future__ import annotations

import email.utils
import http
from datetime import UTC, datetime, timedelta

import pytest

from fibws.hub.response import respond, respond_text


@pytest.mark.parametrize(
    ("content_type", "told"),
    [
        ("text/html", "text/html; charset=utf-8"),
        ("application/json", "application/json; charset=utf-8"),
        ("image/png", "image/png"),
    ],
)
def test_text_is_told_to_be_utf_8(content_type: str, told: str) -> None:
    response = respond(http.HTTPStatus.OK, content_type, b"8")
    assert response.headers["Content-Type"] == told
    assert (response.status_code, response.reason_phrase, response.body) == (200, "OK", b"8")


def test_the_length_is_that_of_the_bytes() -> None:
    response = respond(http.HTTPStatus.OK, "text/plain", "ä".encode())
    assert response.headers["Content-Length"] == "2"


def test_a_response_without_content_has_no_type_and_no_length() -> None:
    response = respond(http.HTTPStatus.NOT_MODIFIED)
    assert "Content-Type" not in response.headers
    assert "Content-Length" not in response.headers


def test_a_response_is_dated_and_the_last_of_its_connection() -> None:
    headers = respond(http.HTTPStatus.OK, "text/plain", b"").headers
    age = datetime.now(UTC) - email.utils.parsedate_to_datetime(headers["Date"])
    assert timedelta(seconds=-1) < age < timedelta(minutes=1)
    assert headers["Connection"] == "close"


def test_a_browser_may_not_guess_what_it_is() -> None:
    assert respond(http.HTTPStatus.OK).headers["X-Content-Type-Options"] == "nosniff"


def test_a_sentence_gets_its_full_stop() -> None:
    response = respond_text(http.HTTPStatus.NOT_FOUND, "Nothing is at /ä")
    assert response.body == "Nothing is at /ä.\n".encode()
    assert response.headers["Content-Type"] == "text/plain; charset=utf-8"
