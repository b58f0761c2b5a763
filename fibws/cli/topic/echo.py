"""``fibws topic echo``: the messages of a topic, as they come."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import click

from fibws.cli import completers, output
from fibws.cli.common_options import json_option, with_hub
from fibws.cli.topic.target import Target, global_name, retarget, wait
from fibws.client.hub_client import HubClient
from fibws.errors import UnknownField
from fibws.values.yaml_text import Style, value_text

if TYPE_CHECKING:
    from fibws.values.filters import Filter

CLEAR = "\033[2J\033[;H"


def _filter(context: click.Context, parameter: click.Parameter, text: str | None) -> Filter | None:
    if text is None:
        return None
    from fibws.values.filters import Filter  # which few need

    return Filter(text)


def _no_bags(context: click.Context, parameter: click.Parameter, file: str | None) -> None:
    if file is not None:
        raise click.UsageError(
            "-b is not here, as fibws reads no bag files: the package rosbags of PyPI does."
        )


@click.command()
@click.argument("topic", metavar="TOPIC[/FIELD]", shell_complete=completers.topics)
@click.option(
    "-n", "count", metavar="COUNT", type=click.IntRange(min=1), help="End after so many messages."
)
@click.option("-c", "--clear", is_flag=True, help="Clear the screen before each message.")
@click.option("-p", "plot", is_flag=True, help="Print comma-separated values, as for plots.")
@click.option(
    "-w",
    "width",
    metavar="NUM_WIDTH",
    type=click.IntRange(min=2),
    help="The characters that each number has.",
)
@click.option("--noarr", is_flag=True, help="Print the lengths of arrays only.")
@click.option("--nostr", is_flag=True, help="Print the lengths of strings only.")
@click.option("--offset", is_flag=True, help="Print times as seconds from now on.")
@click.option(
    "--filter",
    "wanted",
    metavar="CONDITION",
    callback=_filter,
    help="Print only messages m of which this is true: 'm.data > 5'.",
)
@click.option("-b", "--bag", expose_value=False, hidden=True, callback=_no_bags)
@json_option
@with_hub("echo", endless=True)
def command(
    client: HubClient,
    topic: str,
    count: int | None,
    clear: bool,
    plot: bool,
    wanted: Filter | None,
    as_json: bool,
    **style: Any,
) -> None:
    """Print the messages of TOPIC, or of a FIELD of them: /pose/position/x, /scan/ranges[0].

    What is printed is YAML, with --- between the messages. If nobody publishes the topic yet, this
    waits for it.
    """
    if as_json and (plot or any(style.values())):
        raise click.UsageError("--json prints whole values: it goes with neither -p nor a style.")
    target = wait(client, global_name(client, topic))
    show = _json if as_json else _csv(**style) if plot else _yaml(clear=clear, **style)
    if wanted is not None:
        try:
            wanted.check(target.typedefs)
        except UnknownField as error:
            raise click.UsageError(f"--filter: {error}") from None
    for message in client.messages(target.topic):
        target = _up_to_date(client, target, message)
        try:
            if wanted is not None and not wanted.passes(message, target.typedefs):
                continue
            value = target.path.pick(message, target.typedefs)
        except UnknownField as error:
            click.echo(str(error), err=True)
            continue
        show(value, target)
        if count is not None:
            count -= 1
            if not count:
                return


def _up_to_date(client: HubClient, target: Target, message: dict[str, Any]) -> Target:
    """The target as it is now: a topic may come back with another type."""
    if target.typedefs.fits(message):
        return target
    type_ = client.call("/rosapi/topic_type", {"topic": target.topic})["type"]
    return target if type_ in ("", target.type) else retarget(client, target, type_)


def _json(value: Any, target: Target) -> None:
    output.as_json(value)


def _yaml(
    *, clear: bool, noarr: bool, nostr: bool, width: int | None, offset: bool
) -> Callable[[Any, Target], None]:
    style = Style(noarr, nostr, width)
    before = CLEAR if clear and output.has_control_sequences() else ""

    def show(value: Any, target: Target) -> None:
        now = style._replace(offset=time.time_ns()) if offset else style
        if before:
            click.echo(before, nl=False, color=True)
        output.line(f"{value_text(value, target.field, target.typedefs, now)}\n---")

    return show


def _csv(
    *, noarr: bool, nostr: bool, width: int | None, offset: bool
) -> Callable[[Any, Target], None]:
    from fibws.values import csv_rows  # which few need

    is_first = True

    def show(value: Any, target: Target) -> None:
        nonlocal is_first
        rows = csv_rows.Rows(target.typedefs, target.field, noarr=noarr, nostr=nostr)
        if is_first:
            output.line(rows.head(value))
            is_first = False
        output.line(rows.row(value, now=time.time_ns(), relative=offset))

    return show
