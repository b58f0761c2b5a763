"""The options that nodes' programs have in common."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable
from functools import wraps
from typing import Any

import click

import fibws
from fibws.cli import tool
from fibws.msg import message_class

SETTINGS = tool.SETTINGS


def node(
    default_name: str, *, anonymous: bool = True, arguments: str | None = None
) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Give a command the options of a node, and the node itself as its argument ``node``.

    Args:
        default_name: the node's name if none is chosen.
        anonymous: make this one that no other node has; what others call by the node's name has to
            keep it.
        arguments: how the help writes the arguments that are no remappings, which the command gets
            as ``arguments``; else there may be none.
    """
    default = f"{default_name}_<pid>_<number>" if anonymous else default_name

    def decorate(command: Callable[..., None]) -> Callable[..., None]:
        @wraps(command)
        def with_node(
            hub: str | None, node_name: str | None, words: tuple[str, ...], **others: Any
        ) -> None:
            remapping, rest = _remapping(words)
            if arguments is not None:
                others["arguments"] = rest
            elif rest:
                raise click.UsageError(
                    f"Got unexpected argument {rest[0]!r}: it is neither an option nor a "
                    "remapping, which is written from:=to."
                )
            try:
                node = fibws.Node(
                    node_name or default_name,
                    hub=hub,
                    anonymous=anonymous and node_name is None,
                    remapping=remapping,
                )
            except fibws.FibwsError as error:
                raise click.UsageError(str(error)) from None
            command(node=node, **others)

        for option in (
            click.argument(
                "words",
                nargs=-1,
                metavar=f"{arguments} [FROM:=TO]..." if arguments else "[FROM:=TO]...",
            ),
            click.option(
                "--node-name",
                metavar="NAME",
                help=f"The node's name, used as it is.  [default: {default}]",
            ),
        ):
            with_node = option(with_node)
        return tool.hub_option(with_node)

    return decorate


number_type: Callable[[Callable[..., None]], Callable[..., None]] = click.option(
    "--type",
    "type_",
    metavar="TYPE",
    default="std_msgs/Int32",
    show_default=True,
    callback=lambda context, parameter, name: _number_type(name),
    help="The numbers' type: any that has one number, called data.",
)

rate: Callable[[Callable[..., None]], Callable[..., None]] = click.option(
    "--rate",
    metavar="HZ",
    type=float,
    default=1.0,
    show_default=True,
    callback=lambda context, parameter, hz: _rate(hz),
    help="Numbers a second.",
)


def _remapping(words: tuple[str, ...]) -> tuple[fibws.Remapping, tuple[str, ...]]:
    """What is remapped, and the arguments that do not say so."""
    try:
        remapping = fibws.parse_remappings(word for word in words if ":=" in word)
    except fibws.InvalidName as error:
        raise click.UsageError(str(error)) from None
    return remapping, tuple(word for word in words if ":=" not in word)


def _number_type(name: str) -> str:
    try:
        message = message_class(name)
    except fibws.FibwsError as error:
        raise click.BadParameter(str(error)) from None
    default = message()
    fields = {field.name: getattr(default, field.name) for field in dataclasses.fields(message)}
    if fields.keys() != {"data"} or type(fields["data"]) not in (int, float):
        raise click.BadParameter(f"{name} does not hold one number, called data.")
    return message._type


def _rate(hz: float) -> float:
    if not 0 < hz < math.inf:
        raise click.BadParameter(f"{hz:g} is no finite number above 0.")
    return hz
