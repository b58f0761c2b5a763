"""What the tools have in common: options, and a client to the hub."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import Any

import click

from fibws.cli.exit_handling import ending

SETTINGS = {"help_option_names": ["-h", "--help"], "max_content_width": 100}
"""Of a command that is called by itself; those in a group have their group's."""


def linked(
    tool: str = "tool", *, endless: bool = False
) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Give a command the option ``--hub``, and an open `HubClient` as its argument ``client``.

    Args:
        tool: what the tool is called among the nodes; whoever only asks is a ``tool``.
        endless: whether Ctrl-C is how it ends, which is no failure then.
    """

    def decorate(command: Callable[..., None]) -> Callable[..., None]:
        @wraps(command)
        def with_client(hub: str | None, **others: Any) -> None:
            from fibws.client.hub_client import (
                HubClient,  # 60 ms, which the help of a group has no use for
            )

            with ending(endless=endless), HubClient(tool, hub) as client:
                command(client=client, **others)

        return hub_option(with_client)

    return decorate


hub_option: Callable[[Callable[..., None]], Callable[..., None]] = click.option(
    "--hub",
    metavar="URL",
    help="The hub's address.  [default: $FIBWS_HUB, else ws://127.0.0.1:9090]",
)

json_option: Callable[[Callable[..., None]], Callable[..., None]] = click.option(
    "--json", "as_json", is_flag=True, help="Print JSON, one value a line."
)
