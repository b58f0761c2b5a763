"""``fibws topic find``: the topics of a type."""

from __future__ import annotations

import click

from fibws.cli import completers, output
from fibws.cli.common_options import json_option, with_hub
from fibws.cli.types import full_name
from fibws.client.hub_client import HubClient


@click.command()
@click.argument("type_", metavar="TYPE", shell_complete=completers.types)
@json_option
@with_hub()
def command(client: HubClient, type_: str, as_json: bool) -> None:
    """List the topics of TYPE."""
    found = client.call("/rosapi/topics_for_type", {"type": full_name(type_)})["topics"]
    output.names(found, json_=as_json)
