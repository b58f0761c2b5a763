"""Resolve the argument TOPIC of a tool: a topic, or a field of its messages."""

from __future__ import annotations

import time
from collections.abc import Callable
from contextlib import suppress
from typing import NamedTuple

import click

from fibws.client.hub_client import HubClient
from fibws.errors import ServiceError, UnknownField
from fibws.suggestions import suggestion
from fibws.values.field_paths import Path, splits
from fibws.values.typedefs import Field, Typedefs, if_known

INTERVAL = 0.1
"""Seconds between two checks whether a topic is published now, as in rostopic."""


class Target(NamedTuple):
    """A topic that has a type, or a field of its messages."""

    topic: str
    type: str
    typedefs: Typedefs
    """Of its type; empty if that is not defined."""
    path: Path
    """The path to the field; empty for the whole message."""
    field: Field
    """The field at `path`."""


def global_name(client: HubClient, name: str) -> str:
    """Return the global name for an argument; raise `InvalidName` if it is invalid."""
    before, bracket, behind = name.rstrip("/").partition("[")
    return f"{client.resolve(before)}{bracket}{behind}"


def find(client: HubClient, name: str) -> Target | None:
    """Return the topic or the field of a global name, or None if no topic with a type matches.

    Raises:
        ClickException: the messages of the topic have no such field.
    """
    type_ = client.call("/rosapi/topic_type", {"topic": name})["type"] if _is_name(name) else ""
    if type_:
        return _target(client, name, type_, Path(""))
    fault: UnknownField | None = None
    types = all_types(client)
    for topic, path in splits(name, (topic for topic, type_ in types.items() if type_)):
        try:
            return _target(client, topic, types[topic], Path(path))
        except UnknownField as error:
            fault = fault or error
    if fault is not None:
        raise click.ClickException(f"{name}: {fault}")
    return None


def wait(client: HubClient, name: str, *, subscribe: Callable[[str], None] | None = None) -> Target:
    """Subscribe to the topic of a global name, and wait until it is published.

    It subscribes first, so that no message is missed. If the name is that of a field, it subscribes
    to the field's topic.

    Args:
        subscribe: subscribes to a topic; by default `HubClient.subscribe`.

    Raises:
        ClickException: the messages of the topic have no such field.
    """
    subscribe = subscribe or client.subscribe
    if _is_name(name):
        subscribe(name)
    target = find(client, name)
    if target is None:
        meant = suggestion(name, (topic for topic, type_ in all_types(client).items() if type_))
        click.echo(f"WARNING: topic [{name}] does not appear to be published yet{meant}", err=True)
        while target is None:
            time.sleep(INTERVAL)
            target = find(client, name)
    if target.topic != name:
        if _is_name(name):
            client.unsubscribe(name)
        subscribe(target.topic)
    return target


def retarget(client: HubClient, target: Target, type_: str) -> Target:
    """Return a target with another type, which may lack the field."""
    target = target._replace(type=type_, typedefs=if_known(Typedefs.of_message, client, type_))
    with suppress(UnknownField):
        target = target._replace(field=target.path.field(target.typedefs))
    return target


def all_types(client: HubClient) -> dict[str, str]:
    """Return the types of all topics by their names; a type may be empty."""
    found = client.call("/rosapi/topics")
    topics, types = found["topics"], found["types"]
    if len(topics) != len(types):
        fault = f"/rosapi/topics returned {len(topics)} topics, but {len(types)} types"
        raise ServiceError("/rosapi/topics", f"{fault}: this may be another kind of hub")
    return dict(zip(topics, types, strict=True))


def _target(client: HubClient, topic: str, type_: str, path: Path) -> Target:
    typedefs = if_known(Typedefs.of_message, client, type_)
    return Target(topic, type_, typedefs, path, path.field(typedefs))


def _is_name(name: str) -> bool:
    return "[" not in name
