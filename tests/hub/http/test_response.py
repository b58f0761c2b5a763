"""Plain HTTP responses."""

from __future__ import annotations

import email.utils
import http
from datetime import UTC, datetime, timedelta

import pytest

from fibws.hub.http.requests import response, text_response


@pytest.mark.parametrize(
    ("content_type", "expected"),
    [
        ("text/html", "text/html; charset=utf-8"),
        ("application/json", "application/json; charset=utf-8"),
        ("image/png", "image/png"),
    ],
)
def test_text_has_charset_utf_8(content_type: str, expected: str) -> None:
    found = response(http.HTTPStatus.OK, content_type, b"8")
    assert found.headers["Content-Type"] == expected
    assert (found.status_code, found.reason_phrase, found.body) == (200, "OK", b"8")


def test_content_length_counts_bytes() -> None:
    found = response(http.HTTPStatus.OK, "text/plain", "ä".encode())
    assert found.headers["Content-Length"] == "2"


def test_response_without_content_has_no_type_and_no_length() -> None:
    found = response(http.HTTPStatus.NOT_MODIFIED)
    assert "Content-Type" not in found.headers
    assert "Content-Length" not in found.headers


def test_response_has_a_date_and_closes_the_connection() -> None:
    headers = response(http.HTTPStatus.OK, "text/plain", b"").headers
    age = datetime.now(UTC) - email.utils.parsedate_to_datetime(headers["Date"])
    assert timedelta(seconds=-1) < age < timedelta(minutes=1)
    assert headers["Connection"] == "close"


def test_response_forbids_content_sniffing() -> None:
    assert response(http.HTTPStatus.OK).headers["X-Content-Type-Options"] == "nosniff"


def test_text_response_ends_with_a_full_stop() -> None:
    found = text_response(http.HTTPStatus.NOT_FOUND, "Nothing is at /ä")
    assert found.body == "Nothing is at /ä.\n".encode()
    assert found.headers["Content-Type"] == "text/plain; charset=utf-8"
