"""The argument TOPIC of a tool: a topic, or a field of its messages."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from typing import NamedTuple

import click

from fibws.client.hub_client import HubClient
from fibws.errors import ServiceError, UnknownField
from fibws.suggestions import suggestion
from fibws.values.field_paths import Path, splits
from fibws.values.typedefs import TypedefField, Typedefs, if_known

INTERVAL = 0.1
"""Seconds between two checks whether a topic is published now, as in rostopic."""


class FoundTopic(NamedTuple):
    """A topic that has a type, or a field of its messages."""

    topic: str
    type: str
    typedefs: Typedefs
    """The definition of the type; empty if it is unknown."""
    path: Path
    """The path to the field; empty for the whole message."""
    field: TypedefField
    """The field at `path`."""


def global_name(client: HubClient, name: str) -> str:
    """Return the global name for an argument; raise `InvalidName` if it is invalid."""
    before, bracket, behind = name.rstrip("/").partition("[")
    return f"{client.resolve(before)}{bracket}{behind}"


def find_topic(client: HubClient, name: str) -> FoundTopic | None:
    """Return the topic or the field of a global name, or None if no topic with a type matches.

    Raises:
        ClickException: the messages of the topic have no such field.
    """
    type_ = client.call("/rosapi/topic_type", {"topic": name})["type"] if _is_name(name) else ""
    if type_:
        return _found(client, name, type_, Path(""))
    unknown: UnknownField | None = None
    types = all_types(client)
    for topic, path in splits(name, (topic for topic, type_ in types.items() if type_)):
        try:
            return _found(client, topic, types[topic], Path(path))
        except UnknownField as error:
            unknown = unknown or error
    if unknown is not None:
        raise click.ClickException(f"{name}: {unknown}")
    return None


def wait_for_topic(
    client: HubClient, name: str, *, subscribe: Callable[[str], None] | None = None
) -> FoundTopic:
    """Subscribe to the topic of a global name, and wait until it is published.

    It subscribes first, so that no message is missed. If the name is that of a field, it subscribes
    to the field's topic.

    Args:
        subscribe: subscribes to a topic; by default `HubClient.subscribe`.

    Raises:
        ClickException: the messages of the topic have no such field.
        OperationRejected: the hub refuses the subscription.
    """
    subscribe = subscribe or client.subscribe
    if _is_name(name):
        subscribe(name)
    found = find_topic(client, name)
    if found is None:
        client.wait(0)  # The hub may have refused the subscription.
        meant = suggestion(name, (topic for topic, type_ in all_types(client).items() if type_))
        click.echo(f"WARNING: topic [{name}] does not appear to be published yet{meant}", err=True)
        while found is None:
            client.wait(INTERVAL)
            found = find_topic(client, name)
    if found.topic != name:
        if _is_name(name):
            client.unsubscribe(name)
        subscribe(found.topic)
    return found


def with_type(client: HubClient, found: FoundTopic, type_: str) -> FoundTopic:
    """Return a topic with another type, which may lack the field."""
    found = found._replace(type=type_, typedefs=if_known(Typedefs.of_message, client, type_))
    with suppress(UnknownField):
        found = found._replace(field=found.path.field(found.typedefs))
    return found


def all_types(client: HubClient) -> dict[str, str]:
    """Return the types of all topics by their names; a type may be empty."""
    found = client.call("/rosapi/topics")
    topics, types = found["topics"], found["types"]
    if len(topics) != len(types):
        fault = f"/rosapi/topics returned {len(topics)} topics, but {len(types)} types"
        raise ServiceError("/rosapi/topics", f"{fault}: this may be another kind of hub")
    return dict(zip(topics, types, strict=True))


def _found(client: HubClient, topic: str, type_: str, path: Path) -> FoundTopic:
    typedefs = if_known(Typedefs.of_message, client, type_)
    return FoundTopic(topic, type_, typedefs, path, path.field(typedefs))


def _is_name(name: str) -> bool:
    return "[" not in name
