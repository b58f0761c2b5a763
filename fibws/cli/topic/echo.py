"""``fibws topic echo``: print the messages of a topic."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import click

from fibws.cli import completers, output
from fibws.cli.common_options import json_option, with_hub
from fibws.cli.topic.topic_argument import FoundTopic, global_name, wait_for_topic, with_type
from fibws.client.hub_client import HubClient
from fibws.errors import UnknownField
from fibws.values.yaml_text import Style, value_text

if TYPE_CHECKING:
    from fibws.values.filters import Filter

CLEAR = "\033[2J\033[;H"


def _filter(context: click.Context, parameter: click.Parameter, text: str | None) -> Filter | None:
    if text is None:
        return None
    from fibws.values.filters import Filter  # Few need it.

    return Filter(text)


def _no_bags(context: click.Context, parameter: click.Parameter, file: str | None) -> None:
    if file is not None:
        raise click.UsageError(
            "-b is not supported: fibws cannot read bag files. Try the PyPI package rosbags."
        )


@click.command()
@click.argument("topic", metavar="TOPIC[/FIELD]", shell_complete=completers.topics)
@click.option(
    "-n", "count", metavar="COUNT", type=click.IntRange(min=1), help="Exit after COUNT messages."
)
@click.option("-c", "--clear", is_flag=True, help="Clear the screen before each message.")
@click.option("-p", "plot", is_flag=True, help="Print comma-separated values.")
@click.option(
    "-w",
    "width",
    metavar="NUM_WIDTH",
    type=click.IntRange(min=2),
    help="Width of numbers in characters.",
)
@click.option("--noarr", is_flag=True, help="Print the lengths of arrays only.")
@click.option("--nostr", is_flag=True, help="Print the lengths of strings only.")
@click.option("--offset", is_flag=True, help="Print times relative to the current time.")
@click.option(
    "--filter",
    "wanted",
    metavar="EXPRESSION",
    callback=_filter,
    help="Print only messages m matching this expression, such as 'm.data > 5'.",
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
    """Print the messages of TOPIC, or a FIELD of them: /pose/position/x, /scan/ranges[0].

    Messages are printed as YAML, separated by ---. If the topic is not published yet, the command
    waits for it.
    """
    if as_json and (plot or any(style.values())):
        raise click.UsageError("--json excludes -p, -w, --noarr, --nostr and --offset.")
    found = wait_for_topic(client, global_name(client, topic))
    show = _json if as_json else _csv(**style) if plot else _yaml(clear=clear, **style)
    if wanted is not None:
        try:
            wanted.check(found.typedefs)
        except UnknownField as error:
            raise click.UsageError(f"--filter: {error}") from None
    for message in client.messages(found.topic):
        found = _up_to_date(client, found, message)
        try:
            if wanted is not None and not wanted.passes(message, found.typedefs):
                continue
            value = found.path.pick(message, found.typedefs)
        except UnknownField as error:
            click.echo(str(error), err=True)
            continue
        show(value, found)
        if count is not None:
            count -= 1
            if not count:
                return


def _up_to_date(client: HubClient, found: FoundTopic, message: dict[str, Any]) -> FoundTopic:
    """Return the topic with its current type, which may have changed."""
    if found.typedefs.fits(message):
        return found
    type_ = client.call("/rosapi/topic_type", {"topic": found.topic})["type"]
    return found if type_ in ("", found.type) else with_type(client, found, type_)


def _json(value: Any, found: FoundTopic) -> None:
    output.as_json(value)


def _yaml(
    *, clear: bool, noarr: bool, nostr: bool, width: int | None, offset: bool
) -> Callable[[Any, FoundTopic], None]:
    style = Style(noarr, nostr, width)
    before = CLEAR if clear and output.has_control_sequences() else ""

    def show(value: Any, found: FoundTopic) -> None:
        now = style._replace(offset=time.time_ns()) if offset else style
        if before:
            click.echo(before, nl=False, color=True)
        output.line(f"{value_text(value, found.field, found.typedefs, now)}\n---")

    return show


def _csv(
    *, noarr: bool, nostr: bool, width: int | None, offset: bool
) -> Callable[[Any, FoundTopic], None]:
    from fibws.values import csv_rows  # Few need it.

    is_first = True

    def show(value: Any, found: FoundTopic) -> None:
        nonlocal is_first
        rows = csv_rows.Rows(found.typedefs, found.field, noarr=noarr, nostr=nostr)
        if is_first:
            output.line(rows.head(value))
            is_first = False
        output.line(rows.row(value, now=time.time_ns(), relative=offset))

    return show
