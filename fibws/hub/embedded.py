"""The hub of a program that has one of its own: what is public of `fibws.hub.server`."""

from __future__ import annotations

from collections.abc import Callable
from typing import ClassVar, Self

from fibws.hub.server import HubServer
from fibws.hub.settings import Settings
from fibws.public_classes import AsyncContext


class Hub(AsyncContext):
    """A hub that listens while its ``async with`` block runs, or from `start` to `close`.

    It is the hub of ``python -m fibws.hub``, for programs that have one of their own:

        async with fibws.Hub(fibws.Settings(port=0)) as hub:
            async with fibws.Node("robot", hub=hub.url) as node:
                ...

    It shares the event loop with the program: a function that blocks delays all its clients.

    Args:
        settings: the port and the limits; the defaults are those of ``python -m fibws.hub``, whose
            environment variables have no effect here.

    Raises:
        HubError: on entering, when it cannot listen, most likely because the port is taken, or when
            it cannot use a certificate, or another file, folder or address of its settings.
        SettingError: a folder of definitions is not there.
    """

    _hints: ClassVar = {
        "__init__": "write Hub(Settings(port=9090)), with the settings in fibws.Settings"
    }

    def __init__(self, settings: Settings | None = None) -> None:
        if not isinstance(settings, Settings | None):
            raise TypeError(f"expected fibws.Settings, such as Settings(port=0), got {settings!r}")
        self._server = HubServer(settings)

    def __repr__(self) -> str:
        return f"<Hub at {self.url}>"

    @property
    def url(self) -> str:
        """The URL by which nodes on this machine reach it."""
        return self._server.url

    @property
    def port(self) -> int:
        """The port it listens on; once entered, also when the system chose it."""
        return self._server.port

    def health(self) -> dict[str, object]:
        """Return what ``/healthz`` shows: counts, and the clients that read too slowly."""
        return self._server.health()

    async def start(self) -> Self:
        """Listen until `close`, without ``async with``, such as in a notebook; return the hub.

        Raises:
            HubError: as on entering.
        """
        await self._server.start()
        return self

    async def drain(self, seconds: float) -> None:
        """Close all clients little by little, with a code on which they connect again elsewhere.

        From now on /readyz answers 503 and no WebSocket opens, so that a load balancer sends
        clients to another hub. It returns once all have left; `close` ends the hub.

        Args:
            seconds: most that it takes until the last client is closed.
        """
        await self._server.drain(seconds)

    def reload(self, done: Callable[[list[str]], object] = lambda changes: None) -> list[str]:
        """Read the files of certificates, tokens and keys again.

        New connections get the new certificate. Clients lose what they may not do any more, one
        after the other: there may be many.

        Args:
            done: called once all clients have lost it, with what has changed, and how many clients
                were closed.

        Returns:
            What has changed in the files, as in ``token teleop revoked``; empty if nothing has.

        Raises:
            HubError: a certificate or its key cannot be used; nothing has changed.
            AccessError: a file of tokens or keys is invalid; nothing has changed.
        """
        return self._server.reload(done)

    async def close(self) -> None:
        """Close all connections and stop; clients that do not answer in time are cut off."""
        await self._server.close()

    async def __aenter__(self) -> Self:
        return await self.start()

    async def __aexit__(self, *error: object) -> None:
        await self.close()
