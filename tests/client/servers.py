"""WebSocket servers that are not hubs."""

from __future__ import annotations

import socket
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TypeAlias

from websockets.sync.server import ServerConnection, serve
from websockets.typing import Subprotocol

Reply: TypeAlias = str | bytes | list[str]


@contextmanager
def websocket_server(
    handle: Callable[[ServerConnection], None], subprotocol: str | None = None
) -> Iterator[str]:
    """Run a WebSocket server; the context's value is its address.

    Args:
        handle: called with each connection, in a thread.
        subprotocol: selected if a client offers it; None for a plain rosbridge server.
    """
    subprotocols = None if subprotocol is None else [Subprotocol(subprotocol)]
    with serve(handle, "127.0.0.1", 0, subprotocols=subprotocols) as server:
        thread = threading.Thread(target=server.serve_forever)
        thread.start()
        yield f"ws://127.0.0.1:{server.socket.getsockname()[1]}"
        server.shutdown()
        thread.join(60)


@contextmanager
def replying_server(*replies: Reply, subprotocol: str | None = None) -> Iterator[str]:
    """Run a server that sends these messages in reply to each message.

    They are sent as text, a list in fragments; bytes are binary for a ``subprotocol``.
    """

    def handle(connection: ServerConnection) -> None:
        for _ in connection:
            for reply in replies:
                is_binary = subprotocol is not None and isinstance(reply, bytes)
                connection.send(reply, text=not is_binary)

    with websocket_server(handle, subprotocol) as url:
        yield url


@contextmanager
def redirecting_server(location: str, times: int = 1) -> Iterator[str]:
    """Run a server that redirects some requests; the context's value is its address."""
    response = f"HTTP/1.1 301 Moved\r\nLocation: {location}\r\nContent-Length: 0\r\n\r\n"
    with socket.create_server(("127.0.0.1", 0)) as server:

        def answer() -> None:
            for _ in range(times):
                connection, _ = server.accept()
                with connection:
                    connection.recv(2**16)
                    connection.sendall(response.encode())

        thread = threading.Thread(target=answer)
        thread.start()
        yield f"ws://127.0.0.1:{server.getsockname()[1]}/robot"
        thread.join(60)
