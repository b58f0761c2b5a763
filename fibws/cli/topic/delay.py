"""``fibws topic delay``: the delay of a topic, by the stamps in its messages' headers."""

from __future__ import annotations

import json
import re
import struct
import time

import click

from fibws.cli import completers, output
from fibws.cli.common_options import json_option, with_hub
from fibws.cli.topic.every_second import count_option, report, subscribe, window_option
from fibws.cli.topic.target import global_name
from fibws.client.hub_client import HubClient, RawMessage
from fibws.values.rates import MOST, Summary, Window, as_object, in_seconds

# A message that begins with a header: the number, the seconds and the nanoseconds.
_SERIALIZED_STAMP = struct.Struct("<III")
# The same in JSON, as fibws writes it; the rest may be an image, so it is not parsed.
_JSON_STAMP = re.compile(rb'\{"header":\{"seq":\d+,"stamp":\{"secs":(\d+),"nsecs":(\d+)\}')


class Delay:
    """The delay of a topic.

    Args:
        window: number of latest messages to measure.
    """

    def __init__(self, window: int = MOST) -> None:
        self.type: str | None = None
        """The topic's type, if known: serialized messages of another one are ignored."""
        self._delays = Window(window)
        self._is_reported = True

    def receive(self, message: RawMessage) -> None:
        """Count a message that is received now, if it has a stamp."""
        now = time.time_ns()
        if message.type is None:
            stamp = json_stamp(message.data)
        elif self.type in (None, message.type):
            stamp = serialized_stamp(message.data)
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


def serialized_stamp(message: bytes | memoryview) -> int | None:
    """Return the stamp of a serialized message that begins with a header, in nanoseconds.

    Return None if the message is too short for a header.
    """
    if len(message) < _SERIALIZED_STAMP.size:
        return None
    _, secs, nsecs = _SERIALIZED_STAMP.unpack_from(message)
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
@click.argument("topic", shell_complete=completers.topics)
@window_option(MOST, least=1)
@count_option
@json_option
@with_hub("delay", endless=True)
def command(client: HubClient, topic: str, window: int, count: int | None, as_json: bool) -> None:
    """Show the delay of TOPIC every second, by the stamps in its messages' headers."""
    delay = Delay(window)
    name = global_name(client, topic)
    target = subscribe(client, name, delay.receive, quiet=True)
    if not target.typedefs.has_header(target.type):
        raise click.ClickException(
            f"msg does not have header: {target.type} does not begin with a std_msgs/Header"
        )
    delay.type = target.type
    if not as_json:
        output.line(f"subscribed to [{name}]")
    has_begun = False

    def show() -> None:
        nonlocal has_begun
        polled = delay.poll()
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
            output.line(text(*polled))

    report(client, show, count)


def text(delays: Summary, number: int) -> str:
    """Return the delays of ``number`` messages in the format of rostopic delay."""
    return f"average delay: {delays.mean:.3f}\n\t{in_seconds(delays)} window: {number}"
