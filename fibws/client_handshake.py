"""The handshake of an asyncio client: it follows redirects, and knows why TLS failed."""

from __future__ import annotations

from typing import Any
from urllib.parse import parse_qs

from websockets.asyncio.client import ClientConnection
from websockets.exceptions import InvalidMessage, InvalidStatus

from fibws.hub_address import node_url, redirected


class RedirectedToTls(Exception):
    """A server without TLS has redirected the client to one with it, at ``url``."""

    def __init__(self, url: str) -> None:
        self.url = url


class ClientHandshake(ClientConnection):
    """websockets' connection; the error of its handshake has the cause that TLS gives.

    With TLS 1.3, a client has ended its part before the server looks at its certificate. So it is
    refused while it waits for the response to its request, and the library reports an end of file.
    """

    async def handshake(self, *arguments: Any, **named: Any) -> None:
        """Do the handshake; `connect` follows a redirect, of which it knows only ws and wss.

        Raises:
            InvalidHandshake: it failed.
            RedirectedToTls: the hub is at another address, which needs TLS.
            InvalidAddress: the server redirects to what cannot be a hub's address.
        """
        try:
            await super().handshake(*arguments, **named)
        except InvalidMessage as error:
            raise error from (self.connection_exc or error.__cause__)
        except InvalidStatus as error:
            headers, uri = error.response.headers, self.protocol.uri
            if location := headers.get("Location"):
                url = f"{'wss' if uri.secure else 'ws'}://{uri.host}:{uri.port}{uri.path}"
                target = redirected(url, location)
                if target.startswith("wss:") and not uri.secure:
                    raise RedirectedToTls(target) from None
                [node] = parse_qs(uri.query)["node"]
                del headers["Location"]
                headers["Location"] = node_url(target, node)
            raise
