"""Plain HTTP responses, which end their connection."""

from __future__ import annotations

import email.utils
import http

from websockets.datastructures import Headers
from websockets.http11 import Response


def respond(
    status: http.HTTPStatus, content_type: str | None = None, body: bytes = b""
) -> Response:
    """A response whose content a browser may not guess the type of.

    Args:
        content_type: of the body, as in ``text/plain``; None where there is none, by the status.
    """
    headers = Headers(
        {
            "Date": email.utils.formatdate(usegmt=True),
            "Connection": "close",
            "X-Content-Type-Options": "nosniff",
        }
    )
    if content_type is not None:
        text = content_type.startswith("text/") or content_type == "application/json"
        headers["Content-Type"] = f"{content_type}; charset=utf-8" if text else content_type
        headers["Content-Length"] = str(len(body))
    return Response(status.value, status.phrase, headers, body)


def respond_text(status: http.HTTPStatus, text: str) -> Response:
    """A response of one sentence, given without its full stop."""
    return respond(status, "text/plain", f"{text}.\n".encode())
