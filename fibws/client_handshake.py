"""The handshake of an asyncio client, which knows why TLS failed."""

from __future__ import annotations

from typing import Any

from websockets.asyncio.client import ClientConnection
from websockets.exceptions import InvalidMessage


class ClientHandshake(ClientConnection):
    """websockets' connection; the error of its handshake has the cause that TLS gives.

    With TLS 1.3, a client has ended its part before the server looks at its certificate. So it is
    refused while it waits for the response to its request, and the library reports an end of file.
    """

    async def handshake(self, *arguments: Any, **named: Any) -> None:
        """Do the handshake.

        Raises:
            InvalidHandshake: it failed.
        """
        try:
            await super().handshake(*arguments, **named)
        except InvalidMessage as error:
            raise error from (self.connection_exc or error.__cause__)
