"""``fibws topic pub``: publish messages of the command line, a file or standard input."""

from __future__ import annotations

import os
import select
import sys
import time
from codecs import getincrementaldecoder
from collections.abc import Iterable, Iterator
from itertools import repeat
from typing import Any, TextIO

import click

from fibws import names
from fibws.cli import completers, output
from fibws.cli.arguments import DigitOptions, piped_input
from fibws.cli.common_options import examples, with_hub
from fibws.cli.type_names import full_name
from fibws.client.hub_client import HubClient
from fibws.credentials import LONGEST_CHECK
from fibws.values import parsing
from fibws.values.typedefs import Typedefs, if_known
from fibws.values.yaml_text import message_text

LINGER = 3.0
"""Seconds for which a message that is published once stays available, as in rostopic."""
RATE = 10.0
"""Messages per second from a file or standard input."""
MAX_CHARACTERS = 2**26
"""Maximum size of a message from standard input: by default no hub accepts larger ones."""
CHUNK = 2**16


@click.command(cls=DigitOptions)
@click.argument("topic", shell_complete=completers.topics)
@click.argument("type_", metavar="TYPE", shell_complete=completers.type_of_topic)
@click.argument("words", metavar="[ARGS]...", nargs=-1, shell_complete=completers.message)
@click.option("-v", "verbose", is_flag=True, help="Print the messages.")
@click.option(
    "-r",
    "--rate",
    metavar="HZ",
    type=click.FloatRange(min=0, min_open=True, max=1e6),
    help=f"Messages to publish per second.  [default: {RATE:g} from a file or standard input]",
)
@click.option(
    "-1", "--once", is_flag=True, help=f"Publish one message, and exit after {LINGER:g} seconds."
)
@click.option("-f", "--file", type=click.File("r", "utf-8"), help="Read messages from a file.")
@click.option(
    "-l", "--latch", is_flag=True, help="Latch messages from -r, -f or standard input, too."
)
@click.option(
    "-s",
    "--substitute-keywords",
    "substitute",
    is_flag=True,
    help="With -r, replace now and auto by the time of each message.",
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

    ARGS are YAML: one object, or a value for each field in order. The word now is the current time,
    auto a header with the current time. Write -- before ARGS that begin with a minus. Without ARGS,
    messages are read from a file or standard input, separated by lines of ---.
    """
    if rate is not None and once:
        raise click.UsageError("You cannot select both -r and -1 (--once)")
    if words and file is not None:
        raise click.UsageError("args conflict with -f setting")
    values = [parsing.parse(word) for word in words]
    name = client.resolve(names.check(topic))
    publisher = TopicPublisher(client, name, full_name(type_), latch=latch or rate is None)
    typedefs = publisher.typedefs
    if values or _has_no_fields(typedefs):
        messages = _from_arguments(values, typedefs, substitute=substitute)
    elif file is None and piped_input() is None:
        raise click.UsageError("Please specify message values")
    else:
        if rate is None and not once and not latch:
            rate = RATE
        if file is None:
            messages = parsing.messages(documents_from_stdin(publisher), typedefs)
        else:
            messages = _from_file(file, typedefs, is_repeated=rate is not None)
    if rate is not None:
        publisher.publish_all(_printed(messages, typedefs) if verbose else messages, rate)
        return
    for message in messages:
        publisher.publish(message)
        printed = f"[{message_text(message, typedefs)}]" if verbose else "message"
        until = f" for {LINGER} seconds" if once else ". Press ctrl-C to terminate"
        output.line(f"publishing and latching {printed}{until}")
        client.process(LINGER if once else None)
        return


def _from_arguments(
    values: list[Any], typedefs: Typedefs, *, substitute: bool
) -> Iterator[dict[str, Any]]:
    """Yield the message of the command line forever; ``substitute`` updates its times."""
    message = parsing.fill(values, typedefs)
    while True:
        yield message
        if substitute:
            message = parsing.fill(values, typedefs)


def _from_file(file: TextIO, typedefs: Typedefs, *, is_repeated: bool) -> Iterator[dict[str, Any]]:
    """Yield the messages of a file; repeat a single one if ``is_repeated``."""
    messages = list(parsing.messages(parsing.documents(file), typedefs))
    if not messages:
        raise click.UsageError(f"{file.name} contains no message")
    if len(messages) == 1 and is_repeated:
        output.line("Got one message and a rate, publishing repeatedly")
        return repeat(messages[0])
    return iter(messages)


def _printed(messages: Iterable[dict[str, Any]], typedefs: Typedefs) -> Iterator[dict[str, Any]]:
    for message in messages:
        output.line(f"publishing {message_text(message, typedefs)}")
        yield message


def _has_no_fields(typedefs: Typedefs) -> bool:
    return typedefs.root in typedefs and not typedefs.fields(typedefs.root)


class TopicPublisher:
    """A topic that a tool publishes until its client is closed.

    Args:
        topic: its global name.
        latch: have the hub keep the last message for late subscribers.

    Raises:
        OperationRejected: the hub refuses the topic with this type.
    """

    def __init__(self, client: HubClient, topic: str, type_: str, *, latch: bool) -> None:
        self.client = client
        self.topic = topic
        client.send({"op": "advertise", "topic": topic, "type": type_, "latch": latch})
        self.typedefs = if_known(Typedefs.of_message, client, type_)
        """The definition of the type; empty if it is unknown."""
        client.process(0)
        if self.typedefs.root not in self.typedefs:
            warning = f"WARNING: {type_} has no known definition: messages are not checked"
            click.echo(warning, err=True)

    def publish(self, message: dict[str, Any]) -> None:
        """Publish a message, and wait until the hub has sent it to the subscribers.

        Raises:
            OperationRejected: the hub refuses the message.
        """
        self._send(message)
        self._flush()

    def publish_all(self, messages: Iterable[dict[str, Any]], rate: float) -> None:
        """Publish messages at a rate in Hz; raise as `publish`."""
        due = time.monotonic()
        is_first = True
        for message in messages:
            self._send(message)
            if is_first:  # Report an invalid message immediately.
                self._flush()
                is_first = False
            # A delay of more than one period is not made up for.
            due = max(due, time.monotonic() - 1 / rate) + 1 / rate
            self.client.process(due - time.monotonic())
        self._flush()

    def _send(self, message: dict[str, Any]) -> None:
        self.client.send({"op": "publish", "topic": self.topic, "msg": message})

    def _flush(self) -> None:
        """Wait until the hub has processed all messages."""
        self.client.call("/rosapi/get_time")
        self.client.process(0)


def documents_from_stdin(publisher: TopicPublisher) -> Iterator[Any]:
    """Yield each YAML value on standard input as soon as its end is received.

    A document ends with a line of ``---`` or with the input. Meanwhile the publisher's client
    processes what the hub sends: the hub disconnects clients that do not answer pings.

    Raises:
        InvalidValue: invalid YAML.
        UsageError: a document exceeds `MAX_CHARACTERS`.
        OperationRejected: the hub refused an operation.
        HubLost: the connection is lost.
    """
    lines: list[str] = []
    size = 0
    for line in _lines(publisher):
        if line.strip() == "---":
            yield parsing.parse("".join(lines))
            lines, size = [], 0
        else:
            lines.append(line)
            size = _checked(size + len(line))
    if any(line.strip() for line in lines):
        yield parsing.parse("".join(lines))


def _lines(publisher: TopicPublisher) -> Iterator[str]:
    incomplete: list[str] = []
    size = 0
    for text in _chunks(publisher):
        *ends, rest = text.split("\n")
        for end in ends:
            yield "".join([*incomplete, end, "\n"])
            incomplete, size = [], 0
        incomplete.append(rest)
        size = _checked(size + len(rest))
    yield "".join(incomplete)


def _checked(size: int) -> int:
    if size > MAX_CHARACTERS:
        raise click.UsageError(
            f"message too long (limit: {MAX_CHARACTERS} characters): "
            "separate messages by lines of ---"
        )
    return size


def _chunks(publisher: TopicPublisher) -> Iterator[str]:
    try:
        stdin = sys.stdin.fileno()
    except OSError:  # It is not a file of the system, so reading does not wait.
        yield sys.stdin.read()
        return
    decoder = getincrementaldecoder("utf-8")("replace")
    while True:
        ready = [stdin]
        if sys.platform != "win32":  # Windows cannot wait for a pipe like this.
            ready, _, _ = select.select([stdin, publisher.client], [], [], LONGEST_CHECK)
        publisher.client.process(0)
        if stdin in ready:
            data = os.read(stdin, CHUNK)
            yield decoder.decode(data, final=not data)
            if not data:
                return
