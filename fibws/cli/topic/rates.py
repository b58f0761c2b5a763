"""``fibws topic hz``, ``bw`` and ``delay``: measure topics and print a report every second."""

from __future__ import annotations

import json
import re
import struct
import time
from collections.abc import Callable
from functools import partial

import click

from fibws.cli import completers, output
from fibws.cli.common_options import json_option, with_hub
from fibws.cli.topic.topic_argument import FoundTopic, global_name, wait_for_topic
from fibws.client.hub_client import HubClient, OnMessage, RawMessage
from fibws.values.rates import (
    BANDWIDTH_WINDOW,
    MAX_WINDOW,
    Bandwidth,
    MessageRate,
    Summary,
    Window,
    as_object,
    bandwidth_text,
    delay_text,
    poll,
    rates_text,
)

QUEUE_LENGTH = 10_000
"""Messages of a topic that the hub keeps while the tool reads too slowly."""
PERIOD = 1.0
"""Seconds between two reports."""

_topic_argument = click.argument("topic", shell_complete=completers.topics)
_count_option = click.option(
    "-n", "count", metavar="COUNT", type=click.IntRange(min=1), help="Exit after COUNT reports."
)


def _window_option(
    default: int, *, least: int
) -> Callable[[Callable[..., None]], Callable[..., None]]:
    return click.option(
        "-w",
        "--window",
        metavar="COUNT",
        type=click.IntRange(min=least),
        default=default,
        show_default=True,
        help="Number of latest messages to measure.",
    )


def subscribe(
    client: HubClient, name: str, on_message: OnMessage, *, quiet: bool = False
) -> FoundTopic:
    """Subscribe to the raw messages of a topic, and wait until it is published.

    Args:
        name: its global name.
        on_message: called with each message; see `HubClient.subscribe_raw`.
        quiet: print nothing.
    """
    subscribe_raw = partial(client.subscribe_raw, on_message=on_message, queue_length=QUEUE_LENGTH)
    found = wait_for_topic(client, name, subscribe=subscribe_raw)
    if found.path:
        raise click.UsageError(f"{name} is a field of {found.topic}: name a topic.")
    if not quiet:
        output.line(f"subscribed to [{found.topic}]")
    return found


def report(client: HubClient, show: Callable[[], None], count: int | None = None) -> None:
    """Call ``show`` every second, ``count`` times or until Ctrl-C.

    Raises:
        OperationRejected: the hub refused an operation.
        HubLost: the connection is lost.
    """
    due = time.monotonic()
    while count is None or count > 0:
        due += PERIOD
        if due <= (now := time.monotonic()):
            due = now + PERIOD  # After Ctrl-Z, missed reports are not printed.
        client.process(due - time.monotonic())
        show()
        if count is not None:
            count -= 1


@click.command()
@click.argument(
    "topics", metavar="TOPIC...", nargs=-1, required=True, shell_complete=completers.topics
)
@_window_option(MAX_WINDOW, least=2)
@_count_option
@json_option
@with_hub("hz", endless=True)
def hz(
    client: HubClient, topics: tuple[str, ...], window: int, count: int | None, as_json: bool
) -> None:
    """Show the publishing rate of each TOPIC every second."""
    rates: dict[str, MessageRate] = {}
    for topic in topics:
        name = global_name(client, topic)
        rates[name] = MessageRate(window)
        subscribe(client, name, _counter(rates[name]), quiet=as_json)

    def show() -> None:
        polled = poll(rates)
        if not as_json:
            output.line(rates_text(polled, len(rates)))
        for topic, (rate, deltas, number) in polled.items() if as_json else ():
            output.as_json({"topic": topic, "rate": rate} | as_object(deltas) | {"window": number})

    report(client, show, count)


def _counter(rate: MessageRate) -> OnMessage:
    def count(message: object) -> None:
        rate.add(time.perf_counter())

    return count


@click.command()
@_topic_argument
@_window_option(BANDWIDTH_WINDOW, least=2)
@_count_option
@json_option
@with_hub("bw", endless=True)
def bw(client: HubClient, topic: str, window: int, count: int | None, as_json: bool) -> None:
    """Show the bandwidth of TOPIC every second.

    Sizes are those of serialized messages, as in rostopic bw. With a plain rosbridge server, or for
    an undefined type, they are those of messages in JSON.
    """
    bandwidth = Bandwidth(window)
    name = global_name(client, topic)

    def receive(message: RawMessage) -> None:
        bandwidth.add(len(message.data), time.perf_counter())

    subscribe(client, name, receive, quiet=as_json)

    def show() -> None:
        measured = bandwidth.at(time.perf_counter())
        if measured is not None and as_json:
            rate, sizes, number = measured
            sizes_ = {"mean": sizes.mean} | as_object(sizes)
            output.as_json({"topic": name, "rate": rate} | sizes_ | {"window": number})
        elif measured is not None:
            output.line(bandwidth_text(*measured))

    report(client, show, count)


_SERIALIZED_STAMP = struct.Struct("<II")
"""A stamp in a header: seconds, nanoseconds."""
_JSON_STAMP = re.compile(rb'\{"header":\{(?:"seq":\d+,)?"stamp":\{"secs":(\d+),"nsecs":(\d+)\}')
"""The same in JSON as fibws writes it; the rest may be an image, so it is not parsed."""


class Delay:
    """The delay of a topic.

    Args:
        window: number of latest messages to measure.
    """

    def __init__(self, window: int = MAX_WINDOW) -> None:
        self.type: str | None = None
        """The topic's type, if known: serialized messages of another one are ignored."""
        self.has_seq = True
        """Whether headers begin with a sequence number; those of ROS 2 do not."""
        self._delays = Window(window)
        self._is_reported = True

    def receive(self, message: RawMessage) -> None:
        """Count a message that is received now, if it has a stamp."""
        now = time.time_ns()
        if message.type is None:
            stamp = json_stamp(message.data)
        elif self.type in (None, message.type):
            stamp = serialized_stamp(message.data, has_seq=self.has_seq)
        else:
            stamp = None
        if stamp is not None:
            self.add((now - stamp) / 1e9)

    def add(self, delay: float) -> None:
        """Count a message with a delay in seconds."""
        self._delays.add(delay)
        self._is_reported = False

    def poll(self) -> tuple[Summary, int] | None:
        """Return the delays in seconds, and their number.

        Return None if there is no new message since the last poll.
        """
        if self._is_reported:
            return None
        self._is_reported = True
        return self._delays.summary(), len(self._delays)


def serialized_stamp(message: bytes | memoryview, *, has_seq: bool = True) -> int | None:
    """Return the stamp of a serialized message that begins with a header, in nanoseconds.

    Return None if the message is too short for a header.
    """
    place = 4 if has_seq else 0
    if len(message) < place + _SERIALIZED_STAMP.size:
        return None
    secs, nsecs = _SERIALIZED_STAMP.unpack_from(message, place)
    return int(secs) * 10**9 + int(nsecs)


def json_stamp(message: bytes | memoryview) -> int | None:
    """Return the stamp in the header of a message in JSON, in nanoseconds, or None."""
    found = _JSON_STAMP.match(message)
    if found is not None:
        return int(found[1]) * 10**9 + int(found[2])
    header = json.loads(bytes(message)).get("header")
    if not isinstance(header, dict) or "stamp" not in header:
        return None
    return int(header["stamp"]["secs"]) * 10**9 + int(header["stamp"]["nsecs"])


@click.command()
@_topic_argument
@_window_option(MAX_WINDOW, least=1)
@_count_option
@json_option
@with_hub("delay", endless=True)
def delay(client: HubClient, topic: str, window: int, count: int | None, as_json: bool) -> None:
    """Show the delay of TOPIC every second, by the stamps in its messages' headers."""
    measured = Delay(window)
    name = global_name(client, topic)
    found = subscribe(client, name, measured.receive, quiet=True)
    if not found.typedefs.has_header(found.type):
        raise click.ClickException(
            f"msg does not have header: {found.type} does not begin with a std_msgs/Header"
        )
    measured.type = found.type
    measured.has_seq = found.typedefs.has_sequenced_header(found.type)
    if not as_json:
        output.line(f"subscribed to [{name}]")
    has_begun = False

    def show() -> None:
        nonlocal has_begun
        polled = measured.poll()
        if polled is None:
            if has_begun and not as_json:
                output.line("no new messages")
            return
        has_begun = True
        delays, number = polled
        if as_json:
            delays_ = {"delay": delays.mean} | as_object(delays)
            output.as_json({"topic": name} | delays_ | {"window": number})
        else:
            output.line(delay_text(*polled))

    report(client, show, count)
