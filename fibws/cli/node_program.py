"""The programs of nodes: their common options, and how they run and end."""

from __future__ import annotations

import asyncio
import dataclasses
import math
import signal
from collections.abc import Callable, Coroutine
from contextlib import suppress
from functools import wraps
from typing import Any

import click

import fibws
from fibws.cli import common_options
from fibws.cli.exit_handling import end_line, ending
from fibws.msg import message_class

SETTINGS = common_options.SETTINGS


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
        return common_options.hub_option(with_node)

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


def run(program: Coroutine[Any, Any, None]) -> None:
    """Run ``program``; Ctrl-C, SIGTERM and a reader who leaves (``| head``) end it cleanly.

    Raises:
        ClickException: a node or a hub cannot go on; click prints why and exits with 1.
    """
    with ending(endless=True):
        asyncio.run(_until_told(program))


async def _until_told(program: Coroutine[Any, Any, None]) -> None:
    task = asyncio.ensure_future(program)

    def stop() -> None:
        end_line()
        task.cancel()

    for number in (signal.SIGINT, signal.SIGTERM):
        with suppress(NotImplementedError):  # On Windows, where an event loop handles no signals.
            asyncio.get_running_loop().add_signal_handler(number, stop)
    with suppress(asyncio.CancelledError):
        await task
