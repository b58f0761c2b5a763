"""``fibws topic type``: the type of a topic or of a field."""

from __future__ import annotations

import click

from fibws.cli import completers, output
from fibws.cli.common_options import json_option, with_hub
from fibws.cli.topic.target import all_types, find, global_name
from fibws.client.hub_client import HubClient
from fibws.suggestions import suggestion


@click.command()
@click.argument("topic", metavar="TOPIC[/FIELD]", shell_complete=completers.topics)
@json_option
@with_hub()
def command(client: HubClient, topic: str, as_json: bool) -> None:
    """Show the type of TOPIC; with FIELD, the topic's type, the field and the field's type."""
    name = global_name(client, topic)
    target = find(client, name)
    if target is None:
        typed = [topic for topic, type_ in all_types(client).items() if type_]
        raise click.ClickException(f"unknown topic type [{name}]{suggestion(name, typed)}")
    if as_json:
        found = {"topic": target.topic, "type": target.type}
        if target.path:
            found |= {"field": str(target.path), "field_type": target.field.written_type}
        output.as_json(found)
    elif target.path:
        output.line(f"{target.type} {target.path} {target.field.written_type}")
    else:
        output.line(target.type)
