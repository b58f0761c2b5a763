"""The extension permessage-deflate (RFC 7692) in the library's part of a connection.

The library negotiates it, and says which frames begin a compressed message; `MessageReader`
inflates messages, in turns.
"""

from __future__ import annotations

import ipaddress
from collections.abc import Sequence
from dataclasses import replace
from typing import Literal

from websockets.extensions import Extension, ServerExtensionFactory
from websockets.extensions.permessage_deflate import ServerPerMessageDeflateFactory
from websockets.frames import Frame, Opcode
from websockets.typing import ExtensionParameter

_NEGOTIATION = ServerPerMessageDeflateFactory(
    server_no_context_takeover=True, client_no_context_takeover=True
)


class DeflatedFrame(Frame):
    """The first frame of a compressed message."""


class DeflateExtension(Extension):
    """What was negotiated with one client.

    Attributes:
        bits: the size of the client's window, as a power of two.
    """

    name = _NEGOTIATION.name

    def __init__(self, bits: int) -> None:
        self.bits = bits

    def decode(self, frame: Frame, *, max_size: int | None = None) -> Frame:
        """Return the frame, as another class if a compressed message begins with it."""
        if frame.rsv1 and frame.opcode in (Opcode.TEXT, Opcode.BINARY):
            fields = vars(replace(frame, rsv1=False))
            return DeflatedFrame(**fields)
        return frame

    def encode(self, frame: Frame) -> Frame:
        """Return the frame as it is: the library writes control frames only."""
        return frame


class DeflateFactory(ServerExtensionFactory):
    """Accepts offers of permessage-deflate, without context takeover in both directions."""

    name = _NEGOTIATION.name

    def process_request_params(
        self, params: Sequence[ExtensionParameter], accepted_extensions: Sequence[Extension]
    ) -> tuple[list[ExtensionParameter], DeflateExtension]:
        """Return the parameters of the response, and the extension; raise `NegotiationError`."""
        response, found = _NEGOTIATION.process_request_params(params, accepted_extensions)
        return response, DeflateExtension(found.local_max_window_bits)


def may_deflate(setting: Literal["auto", "always", "never"], address: str) -> bool:
    """Return whether texts of a client at an IP address may be compressed."""
    if setting != "auto":
        return setting == "always"
    try:
        ip = ipaddress.ip_address(address)
    except ValueError:  # A Unix socket, or unknown.
        return False
    mapped = getattr(ip, "ipv4_mapped", None)
    return not (mapped or ip).is_loopback
