"""``fibws topic echo``: print the messages of a topic."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, TypeAlias

import click

from fibws.cli import completers, output
from fibws.cli.common_options import hub_option, json_option, with_hub
from fibws.cli.exit_handling import clean_exit
from fibws.cli.topic.topic_argument import FoundTopic, global_name, wait_for_topic, with_type
from fibws.client.hub_client import HubClient
from fibws.errors import UnknownField
from fibws.suggestions import suggestion
from fibws.values.field_paths import Path, splits
from fibws.values.yaml_text import Style, value_text

if TYPE_CHECKING:
    from fibws.values.filters import Filter

Show: TypeAlias = Callable[[Any, FoundTopic, int], None]
"""Prints a value of a topic; the number is the current time in ns, or that in the bag."""
CLEAR = "\033[2J\033[;H"


def _filter(context: click.Context, parameter: click.Parameter, text: str | None) -> Filter | None:
    if text is None:
        return None
    from fibws.values.filters import Filter  # Few need it.

    return Filter(text)


@click.command()
@click.argument("topic", metavar="TOPIC[/FIELD]", required=False, shell_complete=completers.topics)
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
@click.option("-b", "--bag", metavar="BAG", help="Print the messages in BAG, without a hub.")
@click.option("-a", "--all", "all_topics", is_flag=True, help="With --bag, print all topics.")
@json_option
@hub_option
def command(
    topic: str | None,
    bag: str | None,
    all_topics: bool,
    hub: str | None,
    count: int | None,
    clear: bool,
    plot: bool,
    wanted: Filter | None,
    as_json: bool,
    **style: Any,
) -> None:
    """Print the messages of TOPIC, or a FIELD of them: /pose/position/x, /scan/ranges[0].

    Messages are printed as YAML, separated by ---. If the topic is not published yet, the command
    waits for it. With --all --json each line has the topic, the time and the message.
    """
    if as_json and (plot or any(style.values())):
        raise click.UsageError("--json excludes -p, -w, --noarr, --nostr and --offset.")
    if all_topics and bag is None:
        raise click.UsageError("--all needs --bag: it prints all topics of a bag.")
    if all_topics and topic is not None:
        raise click.UsageError(f"--all prints all topics of the bag: leave out {topic}, or --all.")
    if topic is None and not all_topics:
        raise click.UsageError("Missing argument 'TOPIC[/FIELD]'.")
    in_bag = bag is not None
    as_text = _json_of_all if all_topics else _json
    show = as_text if as_json else _csv(in_bag, **style) if plot else _yaml(clear=clear, **style)
    if bag is None:
        _echo_topic(hub=hub, topic=topic, count=count, wanted=wanted, show=show)
        return
    with clean_exit():
        _echo_bag(bag, None if all_topics else topic, count, wanted, show)


@with_hub("echo", endless=True)
def _echo_topic(
    client: HubClient, topic: str, count: int | None, wanted: Filter | None, show: Show
) -> None:
    """Print messages as they arrive."""
    found = wait_for_topic(client, global_name(client, topic))
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
        show(value, found, time.time_ns())
        if count is not None:
            count -= 1
            if not count:
                return


def _echo_bag(
    bag: str, name: str | None, count: int | None, wanted: Filter | None, show: Show
) -> None:
    """Print messages of a bag.

    Args:
        name: a topic or a field of its messages; all topics if None.
    """
    from fibws.cli.bag.bag_messages import BagType, open_bag

    left = count
    with open_bag(bag) as reader:
        topics = {each.topic for each in reader.connections}
        path = Path("")
        if name is not None:
            topic, path = _topic_in_bag(name, topics)
            topics = {topic}
        known: dict[int, tuple[BagType, FoundTopic]] = {}
        for connection, stamp, data in reader.messages(topics):
            if connection.id not in known:
                type_ = BagType(connection)
                typedefs = type_.typedefs
                try:
                    field = path.field(typedefs)
                    if wanted is not None:
                        wanted.check(typedefs)
                except UnknownField as error:
                    raise click.UsageError(f"{connection.topic}: {error}") from None
                named = FoundTopic(connection.topic, type_.name, typedefs, path, field)
                known[connection.id] = type_, named
            type_, found = known[connection.id]
            message = type_.values(data)
            try:
                if wanted is not None and not wanted.passes(message, found.typedefs):
                    continue
                value = path.pick(message, found.typedefs)
            except UnknownField as error:
                click.echo(str(error), err=True)
                continue
            show(value, found, stamp)
            if left is not None:
                left -= 1
                if not left:
                    return


def _topic_in_bag(name: str, topics: set[str]) -> tuple[str, Path]:
    """Return the topic, and the path to a field, for an argument."""
    own = {f"/{topic.lstrip('/')}": topic for topic in topics}
    for topic, path in splits(f"/{name.lstrip('/')}", own):
        return own[topic], Path(path)
    listed = ", ".join(sorted(topics)) or "none"
    raise click.UsageError(
        f"the bag has no topic {name}{suggestion(name, topics)}; topics: {listed}"
    )


def _up_to_date(client: HubClient, found: FoundTopic, message: dict[str, Any]) -> FoundTopic:
    """Return the topic with its current type, which may have changed."""
    if found.typedefs.fits(message):
        return found
    type_ = client.call("/rosapi/topic_type", {"topic": found.topic})["type"]
    return found if type_ in ("", found.type) else with_type(client, found, type_)


def _json(value: Any, found: FoundTopic, now: int) -> None:
    output.as_json(value)


def _json_of_all(value: Any, found: FoundTopic, now: int) -> None:
    seconds, rest = divmod(now, 10**9)
    time_ = {"secs": seconds, "nsecs": rest}
    output.as_json({"topic": found.topic, "time": time_, "message": value})


def _yaml(*, clear: bool, noarr: bool, nostr: bool, width: int | None, offset: bool) -> Show:
    style = Style(noarr, nostr, width)
    before = CLEAR if clear and output.has_control_sequences() else ""

    def show(value: Any, found: FoundTopic, now: int) -> None:
        current = style._replace(offset=now) if offset else style
        if before:
            click.echo(before, nl=False, color=True)
        output.line(f"{value_text(value, found.field, found.typedefs, current)}\n---")

    return show


def _csv(in_bag: bool, *, noarr: bool, nostr: bool, width: int | None, offset: bool) -> Show:
    from fibws.values import csv_rows  # Few need it.

    is_first = True

    def show(value: Any, found: FoundTopic, now: int) -> None:
        nonlocal is_first
        rows = csv_rows.Rows(found.typedefs, found.field, noarr=noarr, nostr=nostr)
        if is_first:
            output.line(rows.head(value))
            is_first = False
        output.line(rows.row(value, now=now, relative=offset, by_header=not in_bag))

    return show
