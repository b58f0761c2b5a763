"""``fibws topic pub``: publish messages."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import repeat
from typing import Any, TextIO

import click

from fibws import names
from fibws.cli import completers, output
from fibws.cli.arguments import DigitOptions, piped_input
from fibws.cli.common_options import examples, with_hub
from fibws.cli.topic import pipe
from fibws.cli.topic.publisher import Publisher
from fibws.cli.types import full_name
from fibws.client.hub_client import HubClient
from fibws.values import parsing
from fibws.values.typedefs import Typedefs
from fibws.values.yaml_text import message_text

LINGER = 3.0
"""Seconds that a message is there for late listeners if it is published once, as in rostopic."""
RATE = 10.0
"""Messages a second of those that come from a file or a pipe."""


@click.command(cls=DigitOptions)
@click.argument("topic", shell_complete=completers.topics)
@click.argument("type_", metavar="TYPE", shell_complete=completers.type_of_topic)
@click.argument("words", metavar="[ARGS]...", nargs=-1)
@click.option("-v", "verbose", is_flag=True, help="Print the messages.")
@click.option(
    "-r",
    "--rate",
    metavar="HZ",
    type=click.FloatRange(min=0, min_open=True, max=1e6),
    help=f"Publish so many messages a second.  [default: {RATE:g} for those of -f and of a pipe]",
)
@click.option(
    "-1", "--once", is_flag=True, help=f"Publish one message, and end {LINGER:g} seconds later."
)
@click.option("-f", "--file", type=click.File("r", "utf-8"), help="Take the messages from a file.")
@click.option("-l", "--latch", is_flag=True, help="Latch also with -r, -f and a pipe.")
@click.option(
    "-s",
    "--substitute-keywords",
    "substitute",
    is_flag=True,
    help="With -r, let now and auto be the time of each message.",
)
@with_hub("pub", endless=True)
@examples(
    '{topic pub} -r 10 /chatter std_msgs/String "data: hello"',
    '{topic pub} -1 /cmd_vel geometry_msgs/Twist "{linear: {x: 1.5}}"',
    "{topic pub} /point geometry_msgs/Point 1 2 3",
)
def command(
    client: HubClient,
    topic: str,
    type_: str,
    words: tuple[str, ...],
    verbose: bool,
    rate: float | None,
    once: bool,
    file: TextIO | None,
    latch: bool,
    substitute: bool,
) -> None:
    """Publish messages of TYPE on TOPIC.

    ARGS are YAML: one object, or a value for each field in order. In them, now stands for the time
    and auto for a header of now. If one begins with a minus, write -- before them all. Without
    ARGS, the messages are those of a file or of standard input, with --- between them.
    """
    if rate is not None and once:
        raise click.UsageError("You cannot select both -r and -1 (--once)")
    if words and file is not None:
        raise click.UsageError("args conflict with -f setting")
    values = [parsing.parse(word) for word in words]
    name = client.resolve(names.check(topic))
    publisher = Publisher(client, name, full_name(type_), latch=latch or rate is None)
    typedefs = publisher.typedefs
    if values or _has_no_fields(typedefs):
        messages = _of_words(values, typedefs, anew=substitute)
    else:
        if file is None and piped_input() is None:
            raise click.UsageError("Please specify message values")
        if rate is None and not once and not latch:
            rate = RATE
        messages = _of_stream(publisher, file, repeated=rate is not None)
    if rate is not None:
        publisher.publish_all(_shown(messages, typedefs) if verbose else messages, rate)
        return
    for message in messages:
        publisher.publish(message)
        what = f"[{message_text(message, typedefs)}]" if verbose else "message"
        until = f" for {LINGER} seconds" if once else ". Press ctrl-C to terminate"
        output.line(f"publishing and latching {what}{until}")
        client.process(LINGER if once else None)
        return


def _of_words(values: list[Any], typedefs: Typedefs, *, anew: bool) -> Iterator[dict[str, Any]]:
    """The message of the command line, without end; if ``anew``, each with its own time."""
    message = parsing.fill(values, typedefs)
    while True:
        yield message
        if anew:
            message = parsing.fill(values, typedefs)


def _of_stream(
    publisher: Publisher, file: TextIO | None, *, repeated: bool
) -> Iterator[dict[str, Any]]:
    """The messages of a file or of standard input; the only one of a file is ``repeated``."""
    given = parsing.documents(file) if file is not None else pipe.documents(publisher)
    messages = (
        parsing.fill(each if isinstance(each, list) else [each], publisher.typedefs)
        for each in given
        if each is not None
    )
    if file is None:
        return messages
    all_ = list(messages)
    if not all_:
        raise click.UsageError(f"There is no message in {file.name}")
    if len(all_) == 1 and repeated:
        output.line("Got one message and a rate, publishing repeatedly")
        return repeat(all_[0])
    return iter(all_)


def _shown(messages: Iterable[dict[str, Any]], typedefs: Typedefs) -> Iterator[dict[str, Any]]:
    for message in messages:
        output.line(f"publishing {message_text(message, typedefs)}")
        yield message


def _has_no_fields(typedefs: Typedefs) -> bool:
    return typedefs.root in typedefs and not typedefs.fields(typedefs.root)
