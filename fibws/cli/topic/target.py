"""What a tool's argument TOPIC names: a topic, and maybe a field of its messages."""

from __future__ import annotations

import time
from contextlib import suppress
from typing import NamedTuple

import click

from fibws.cli.link import QUEUE_LENGTH, Link
from fibws.cli.message.paths import Path, splits
from fibws.cli.message.typedefs import Field, Typedefs, if_known
from fibws.errors import ServiceError
from fibws.hint import hint

INTERVAL = 0.1
"""Seconds between two looks at whether a topic is there now, as rostopic takes them."""


class Target(NamedTuple):
    """A topic that has a type."""

    topic: str
    type: str
    typedefs: Typedefs
    """Of its type; none if nobody has defined that."""
    path: Path
    """The way to the field that is meant; nothing for the whole message."""
    field: Field
    """What that leads to."""


def global_name(link: Link, name: str) -> str:
    """The global name that an argument means; it raises `InvalidName` if that is none."""
    before, bracket, behind = name.rstrip("/").partition("[")
    return f"{link.resolve(before)}{bracket}{behind}"


def find(link: Link, name: str) -> Target | None:
    """The topic, or the field, of this global name, or None if no topic with a type is called so.

    Raises:
        ClickException: the messages of the topic have no such field.
    """
    type_ = link.call("/rosapi/topic_type", {"topic": name})["type"] if _is_name(name) else ""
    if type_:
        return _target(link, name, type_, Path(""))
    fault: LookupError | None = None
    types = all_types(link)
    for topic, path in splits(name, (topic for topic, type_ in types.items() if type_)):
        try:
            return _target(link, topic, types[topic], Path(path))
        except LookupError as error:
            fault = fault or error
    if fault is not None:
        raise click.ClickException(f"{name}: {fault}")
    return None


def wait(link: Link, name: str, *, queue_length: int = QUEUE_LENGTH) -> Target:
    """Subscribe to the topic, or to that of the field, of this global name, once there is one.

    It is subscribed to before it is looked for, so that nothing is missed; raises as `find`.
    """
    if _is_name(name):
        link.subscribe(name, queue_length=queue_length)
    target = find(link, name)
    if target is None:
        meant = hint(name, (topic for topic, type_ in all_types(link).items() if type_))
        click.echo(f"WARNING: topic [{name}] does not appear to be published yet{meant}", err=True)
        while target is None:
            time.sleep(INTERVAL)
            target = find(link, name)
    if target.topic != name:
        if _is_name(name):
            link.send({"op": "unsubscribe", "topic": name})
        link.subscribe(target.topic, queue_length=queue_length)
    return target


def retarget(link: Link, target: Target, type_: str) -> Target:
    """The same topic and field, of another type, which may have no such field."""
    target = target._replace(type=type_, typedefs=if_known(Typedefs.of_message, link, type_))
    with suppress(LookupError):
        target = target._replace(field=target.path.field(target.typedefs))
    return target


def all_types(link: Link) -> dict[str, str]:
    """The names of all topics, each with its type's, which is empty if it has none."""
    found = link.call("/rosapi/topics")
    topics, types = found["topics"], found["types"]
    if len(topics) != len(types):
        fault = f"/rosapi/topics told {len(topics)} topics, but {len(types)} types"
        raise ServiceError("/rosapi/topics", f"{fault}: this may be another kind of hub")
    return dict(zip(topics, types, strict=True))


def _target(link: Link, topic: str, type_: str, path: Path) -> Target:
    typedefs = if_known(Typedefs.of_message, link, type_)
    return Target(topic, type_, typedefs, path, path.field(typedefs))


def _is_name(name: str) -> bool:
    return "[" not in name
