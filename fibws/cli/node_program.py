"""Programs that are nodes: their common options, and running them until Ctrl-C."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Coroutine
from functools import wraps
from typing import TYPE_CHECKING, Any

import click

import fibws
from fibws.cli import common_options
from fibws.cli.exit_handling import clean_exit
from fibws.msg import message_class
from fibws.node.program import run_until_signal

if TYPE_CHECKING:
    from fibws.cli.completers import Completion

SETTINGS = common_options.SETTINGS


def node(
    default_name: str,
    *,
    anonymous: bool = True,
    arguments: str | None = None,
    complete: Completion | None = None,
) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Give a command the options of a node, and the node itself as its argument ``node``.

    Args:
        default_name: the node's name without --node-name and ``__name:=``.
        anonymous: make the default name unique.
        arguments: the metavar of arguments besides remappings, which the command gets as
            ``arguments``; without it, such arguments are an error.
        complete: completes these arguments.
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
                    f"unexpected argument {rest[0]!r}: expected an option, or a remapping "
                    "written FROM:=TO"
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
                shell_complete=complete,
            ),
            click.option(
                "--node-name",
                metavar="NAME",
                help=f"Name of the node.  [default: {default}]",
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
    help="Type of the numbers: any message type whose only field is a number called data.",
)

rate: Callable[[Callable[..., None]], Callable[..., None]] = click.option(
    "--rate",
    metavar="HZ",
    type=float,
    default=1.0,
    show_default=True,
    callback=lambda context, parameter, hz: _rate(hz),
    help="Numbers per second.",
)


def _remapping(words: tuple[str, ...]) -> tuple[fibws.Remapping, tuple[str, ...]]:
    """Split the arguments into remappings and others."""
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
        raise click.BadParameter(f"{name} is not a type whose only field is a number called data.")
    return message._type


def _rate(hz: float) -> float:
    if not 0 < hz < math.inf:
        raise click.BadParameter(f"expected a number above 0, got {hz:g}")
    return hz


def run(program: Coroutine[Any, Any, None]) -> None:
    """Run ``program``; Ctrl-C, SIGTERM and a closed pipe (``| head``) end it cleanly.

    Raises:
        ClickException: a node or a hub failed; click prints why and exits with 1.
    """
    with clean_exit():
        run_until_signal(program)
