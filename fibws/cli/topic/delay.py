"""``fibws topic delay``: how old messages are when they come, by the stamps in their headers."""

from __future__ import annotations

import json
import re
import time

import click

from fibws.cli import complete, output
from fibws.cli.link import Link
from fibws.cli.tool import json_option, linked
from fibws.cli.topic.every_second import count_option, hear, report, window_option
from fibws.cli.topic.target import global_name
from fibws.cli.topic.window import MOST, Summary, Window, as_object, in_seconds

# How the hub writes messages that begin with a header; the rest may be an image.
_STAMP = re.compile(rb'\{"header":\{"seq":\d+,"stamp":\{"secs":(\d+),"nsecs":(\d+)\}')


class Delay:
    """How old messages are.

    Args:
        window: the newest messages that count.
    """

    def __init__(self, window: int = MOST) -> None:
        self._delays = Window(window)
        self._is_told = True

    def hear(self, message: bytes) -> None:
        """Take note that a message has come now."""
        now = time.time_ns()
        stamped = stamp(message)
        if stamped is not None:
            self.take((now - stamped) / 1e9)

    def take(self, delay: float) -> None:
        """Take note of a message that was so many seconds old."""
        self._delays.add(delay)
        self._is_told = False

    def news(self) -> tuple[Summary, int] | None:
        """What the delays are like, in seconds, and how many they are.

        None if no message has come since the last time this was asked.
        """
        if self._is_told:
            return None
        self._is_told = True
        return self._delays.summary(), len(self._delays)


def stamp(message: bytes) -> int | None:
    """The stamp in the header of a message, which is JSON text, in nanoseconds since 1970.

    None if it has none.
    """
    found = _STAMP.match(message)
    if found is not None:
        return int(found[1]) * 10**9 + int(found[2])
    header = json.loads(message).get("header")
    if not isinstance(header, dict) or "stamp" not in header:
        return None
    return int(header["stamp"]["secs"]) * 10**9 + int(header["stamp"]["nsecs"])


@click.command()
@click.argument("topic", shell_complete=complete.topics)
@window_option(MOST, least=1)
@count_option
@json_option
@linked("delay", endless=True)
def command(link: Link, topic: str, window: int, count: int | None, as_json: bool) -> None:
    """Show once a second how old the messages of TOPIC are when they come, by their headers."""
    delay = Delay(window)
    name = global_name(link, topic)
    target = hear(link, name, delay.hear, quiet=True)
    if not target.typedefs.has_header(target.type):
        raise click.ClickException(
            f"msg does not have header: {target.type} does not begin with a std_msgs/Header"
        )
    if not as_json:
        output.line(f"subscribed to [{name}]")
    has_begun = False

    def show() -> None:
        nonlocal has_begun
        news = delay.news()
        if news is None:
            if has_begun and not as_json:
                output.line("no new messages")
            return
        has_begun = True
        delays, number = news
        if as_json:
            delays_ = {"delay": delays.mean} | as_object(delays)
            output.as_json({"topic": name} | delays_ | {"window": number})
        else:
            output.line(text(*news))

    report(link, show, count)


def text(delays: Summary, number: int) -> str:
    """What the delays of so many messages are like, as rostopic delay prints them."""
    return f"average delay: {delays.mean:.3f}\n\t{in_seconds(delays)} window: {number}"
