"""The text of an HTTP response that refuses a WebSocket."""

from __future__ import annotations

import re
from typing import NamedTuple

LONGEST = 500
"""Most characters of a server's text that are shown."""
_GATEWAY = (502, 503, 504)
"""What proxies answer if nothing answers them; a hub explains its own 503 in plain
text."""
_TITLE = re.compile(r"<title>(.*?)</title>", re.IGNORECASE)


class Refusal(NamedTuple):
    """A response other than the handshake's.

    Attributes:
        status: its status.
        phrase: the reason phrase of the status.
        content_type: of the body; empty if it is not given.
        body: the body.
    """

    status: int
    phrase: str
    content_type: str
    body: bytes | bytearray

    @property
    def text(self) -> str:
        """What the body says: that of a web page is its title."""
        text = " ".join(self.body.decode("utf-8", "replace").split())
        if text.startswith("<") or "html" in self.content_type:
            title = _TITLE.search(text)
            text = title[1].strip() if title is not None else ""
            text = text.removeprefix(f"{self.status} ")  # As nginx writes it.
        elif self.content_type and not self.content_type.startswith("text/plain"):
            return ""
        return text.rstrip(".")[:LONGEST]

    def __str__(self) -> str:
        """Return the status, the text, and what to do if that is known."""
        text = self.text or self.phrase
        return f"HTTP {self.status}: {text}{self._advice(text)}"

    def _advice(self, text: str) -> str:
        if self.status == 400 and "https" in text.lower():
            return "; use wss://"
        if 200 <= self.status < 300:  # A page, or a proxy that has not passed on the request whole.
            slash = "which may need a slash at its end"
            return f"; check the address's path, {slash}, and that a proxy passes on Upgrade"
        if self.status in _GATEWAY and not self.content_type.startswith("text/plain"):
            return (
                "; a proxy answers, which does not reach its hub: start the hub, or correct its "
                "address in the proxy"
            )
        return ""
