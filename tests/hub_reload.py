"""Reloads a hub's files, as SIGHUP does."""

from __future__ import annotations

import asyncio

from fibws.hub.server import HubServer


async def reloaded(hub: HubServer) -> list[str]:
    """Reload, wait until all clients have lost what they may not do any more; return what changed.

    Raises:
        FibwsError: a file is invalid; nothing has changed.
    """
    done: asyncio.Future[list[str]] = asyncio.get_running_loop().create_future()
    hub.reload(done.set_result)
    return await done
