"""``fibws topic find``: the topics of a type."""

from __future__ import annotations

import click

from fibws.cli import complete, output
from fibws.cli.link import Link
from fibws.cli.tool import json_option, linked
from fibws.cli.types.full_name import full_name


@click.command()
@click.argument("type_", metavar="TYPE", shell_complete=complete.types)
@json_option
@linked()
def command(link: Link, type_: str, as_json: bool) -> None:
    """List the topics of TYPE."""
    found = link.call("/rosapi/topics_for_type", {"type": full_name(type_)})["topics"]
    output.names(found, json_=as_json)
