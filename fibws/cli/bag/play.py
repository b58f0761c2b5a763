"""``fibws bag play``: a node that publishes the messages of bags, as rosbag play does."""

from __future__ import annotations

import asyncio
import logging
import math
import os
import re
import struct
import sys
from collections.abc import Iterable, Sequence
from contextlib import AsyncExitStack, ExitStack, nullcontext
from dataclasses import dataclass
from typing import Any

import click

import fibws
from fibws.bags import Connection, Reader
from fibws.bags.ros2_messages import ROS1, with_encoding
from fibws.bags.summary import span_text
from fibws.cli import completers, output
from fibws.cli.arguments import spread
from fibws.cli.bag.bag_messages import open_bag
from fibws.cli.bag.playback import Bags, Playback, PlaybackOptions, Target
from fibws.cli.common_options import examples
from fibws.cli.keyboard import reading_keys
from fibws.cli.node_program import SETTINGS, node, run
from fibws.errors import BagError, FibwsError
from fibws.interfaces import Time
from fibws.msg.fibws_msgs import PlaybackState
from fibws.msg.rosgraph_msgs import Clock
from fibws.srv.fibws_msgs import ControlPlayback, ControlPlaybackRequest, ControlPlaybackResponse
from fibws.srv.std_srvs import SetBool, SetBoolRequest, SetBoolResponse
from fibws.suggestions import suggestion

MOST_NODES = 64
"""Nodes that publish at once: one for each publisher that one topic had. The messages of further
ones come from the last, which names them in its connection header."""
PROGRESS_INTERVAL = 0.1
"""Seconds between two lines of progress."""
STATE_INTERVAL = 0.25
"""Seconds between two messages of the state."""
SWITCH_INTERVAL = 0.0005
"""Seconds after which the thread that reads lets the event loop run: by default 5 ms, which would
delay messages."""
LONG_SPAN = 3600.0
"""Seconds without messages that are skipped, which is said, unless others are asked for."""
NEVER = 1e10
"""More seconds than any bag has."""
_TIME = struct.Struct("<II")
_FIRST_FIELD = re.compile(r"\A(?:\s*(?:#.*)?\n)*\s*(?:std_msgs/)?Header\s", re.ASCII)


@dataclass(frozen=True, slots=True, kw_only=True)
class PlayOptions:
    """What to play, and how to publish it.

    Attributes:
        hub: the hub's address with its token, as it was given; None for the default.
        topics: the topics to play, without the slash before them; all if it is empty.
        prefix: put before the names of all topics.
        queue_size: of the publishers.
        delay: seconds to wait after the topics were advertised.
        waits_for_subscribers: whether to wait until each topic has a subscriber.
        clock_rate: how often the time is published on /clock besides before messages, in hertz; 0
            for never.
        control_topic: the topic of `Playback.controlled`; empty for none.
        is_quiet: whether to print no progress.
    """

    hub: str | None
    topics: frozenset[str]
    prefix: str
    queue_size: int
    delay: float
    waits_for_subscribers: bool
    clock_rate: float
    control_topic: str
    is_quiet: bool


class ConnectionTarget:
    """Publishes the messages of one publisher of a topic; a `Target`."""

    __slots__ = ("_callerid", "_outlet", "topic")

    def __init__(self, topic: str, callerid: str, outlet: Outlet) -> None:
        self.topic = topic
        self._callerid = callerid
        self._outlet = outlet

    def publish(self, data: bytes) -> None:
        """Publish a message in the name of the publisher."""
        self._outlet.publish(self._callerid, data)


class Outlet:
    """A publisher of one node, which has the name of the recorded publisher in its header."""

    __slots__ = ("_callerid", "publisher")

    def __init__(self, publisher: fibws.Publisher[Any, ...], callerid: str) -> None:
        self.publisher = publisher
        self._callerid = callerid

    def publish(self, callerid: str, data: bytes) -> None:
        """Publish a message in the name of a publisher."""
        publisher = self.publisher
        if callerid != self._callerid:
            self._callerid = callerid
            publisher._introduce(_headers(callerid))
        publisher._send(publisher._encode_serialized(data))


def _headers(callerid: str) -> dict[str, str]:
    """Return the connection header; it is not the player that has published, if it is unknown."""
    return {"callerid": callerid}


class Player:
    """The player's nodes: publishers, the clock, services, keys and the progress line.

    Args:
        node: publishes all messages, except those of further publishers of one topic.
        readers: of the bags.
    """

    def __init__(
        self,
        node: fibws.Node,
        readers: Sequence[Reader],
        paths: Sequence[str],
        options: PlayOptions,
        playback_options: PlaybackOptions,
    ) -> None:
        self._node = node
        self._readers = readers
        self._paths = paths
        self._options = options
        self._playback_options = playback_options
        self._nodes = [node]
        self._outlets: dict[tuple[str, int], Outlet] = {}
        self._one_of_each: dict[int, fibws.Publisher[Any, ...]] = {}
        """One publisher of each node."""
        self._callers: dict[str, list[str]] = {}
        """The publishers of each topic that is played."""
        self._playback: Playback
        self._clock: fibws.Publisher[Any, ...] | None = None
        self._time = -1
        """The last time that was published on /clock, in nanoseconds."""
        self._state: fibws.Publisher[Any, ...]

    async def run(self) -> None:
        """Play the bags.

        Raises:
            BagError: a bag is damaged, or has nothing to play.
        """
        async with AsyncExitStack() as stack:
            tasks = stack.enter_context(_Tasks())
            targets = [await self._targets(reader, stack) for reader in self._readers]
            if not any(targets):
                raise BagError("none of the topics can be played")
            bags = Bags(list(zip(self._readers, targets, strict=True)), self._playback_options.end)
            stack.callback(bags.close)
            self._playback = Playback(
                bags,
                self._playback_options,
                self._room,
                on_change=self._publish_state,
                on_time=self._publish_time if self._options.clock_rate else lambda time: None,
                on_skip=self._report_skip,
            )
            await self._advertise_own()
            if self._options.clock_rate:
                tasks.start(self._run_clock())
            if self._options.control_topic:
                self._follow(self._options.control_topic)
            await self._wait_for_others()
            stack.enter_context(self._keys())
            tasks.start(self._run_state())
            if self._shows_progress:
                tasks.start(self._run_progress())
            await self._playback.run()
            if self._shows_progress:
                self._show_progress()
            if not self._options.is_quiet:
                output.line("\nDone.")

    # Publishers

    async def _targets(self, reader: Reader, stack: AsyncExitStack) -> dict[int, Target]:
        """Advertise the topics of a bag; return where its connections are published."""
        targets: dict[int, Target] = {}
        for connection in reader.connections:
            if self._options.topics and connection.topic.lstrip("/") not in self._options.topics:
                continue
            if connection.id in reader.not_converted:
                self._node.log.error(
                    "%s is not played: %s", connection.topic, reader.not_converted[connection.id]
                )
                continue
            try:
                outlet = await self._outlet(connection, stack)
            except FibwsError as error:
                self._node.log.error("%s is not played: %s", connection.topic, error)
                continue
            targets[connection.id] = ConnectionTarget(connection.topic, connection.callerid, outlet)
        return targets

    async def _outlet(self, connection: Connection, stack: AsyncExitStack) -> Outlet:
        """Return what publishes for a connection: a node publishes for one on each topic."""
        topic = self._node.resolve(f"{self._options.prefix}{connection.topic}")
        callers = self._callers.setdefault(topic, [])
        if connection.callerid not in callers:
            callers.append(connection.callerid)
        number = min(callers.index(connection.callerid), MOST_NODES - 1)
        found = self._outlets.get((topic, number))
        if found is None:
            while len(self._nodes) <= number:
                self._nodes.append(await stack.enter_async_context(self._another_node()))
            publisher = await self._nodes[number].advertise_serialized(
                topic,
                connection.type,
                md5sum=connection.md5sum if connection.md5sum != "*" else None,
                definition=connection.definition or None,
                queue_size=max(1, self._options.queue_size),
                latch=connection.latching,
                headers=_headers(connection.callerid),
                peers=self._options.waits_for_subscribers,
                keep_seq=True,
            )
            self._one_of_each.setdefault(number, publisher)
            found = self._outlets[topic, number] = Outlet(publisher, connection.callerid)
        return found

    def _another_node(self) -> fibws.Node:
        name = f"{self._node.name.rpartition('/')[2]}_{len(self._nodes) + 1}"
        namespace = self._node.name.rpartition("/")[0] or "/"
        return fibws.Node(
            name, hub=self._options.hub, namespace=namespace, rosout=False, log=self._node.log
        )

    async def _room(self) -> None:
        for publisher in self._one_of_each.values():
            await publisher._room()

    async def _wait_for_others(self) -> None:
        """Give subscribers time to connect, as rosbag does."""
        options, is_quiet = self._options, self._options.is_quiet
        if not is_quiet:
            click.echo(f"Waiting {options.delay:g} seconds after advertising topics...", nl=False)
        await asyncio.sleep(options.delay)
        if not is_quiet:
            output.line(" done.\n")
        if options.waits_for_subscribers:
            if not is_quiet:
                output.line("Waiting for subscribers.")
            for outlet in self._outlets.values():
                async for names in outlet.publisher.peers.changes():
                    if names:
                        break
            if not is_quiet:
                output.line("Finished waiting for subscribers.")

    # Services and topics of the player itself

    async def _advertise_own(self) -> None:
        node = self._node
        await node.service("~pause_playback", SetBool, self._handle_pause)
        await node.service("~control_playback", ControlPlayback, self._handle_control)
        self._state = await node.advertise("~playback", PlaybackState, queue_size=1, latch=True)
        self._publish_state()
        if self._options.clock_rate:
            self._clock = await node.advertise("/clock", Clock, queue_size=1)

    def _handle_pause(self, request: SetBoolRequest) -> SetBoolResponse:
        is_new = request.data != self._playback.is_paused
        if not is_new:
            state = "paused." if request.data else "running."
            return SetBoolResponse(False, f"Bag is already {state}")
        self._playback.pause(request.data)
        return SetBoolResponse(True, f"Playback is now {'paused' if request.data else 'resumed'}")

    def _handle_control(self, request: ControlPlaybackRequest) -> ControlPlaybackResponse:
        playback, fault = self._playback, ""
        match request.command:
            case "play" | "pause":
                playback.pause(request.command == "pause")
            case "step":
                if playback.is_paused:
                    playback.step()
                else:
                    fault = "step needs a pause"
            case "seek":
                playback.seek(request.position.to_nanoseconds())
            case "rate":
                try:
                    playback.set_rate(request.rate)
                except ValueError as error:
                    fault = str(error)
            case _:
                fault = (
                    "command must be play, pause, step, seek or rate, "
                    f"got {output.visible(request.command)!r}"
                )
        return ControlPlaybackResponse(not fault, fault, self._current_state())

    def _current_state(self) -> PlaybackState:
        playback, options = self._playback, self._playback_options
        return PlaybackState(
            status=playback.status,
            start=Time.from_nanoseconds(options.start),
            end=Time.from_nanoseconds(options.end),
            position=Time.from_nanoseconds(playback.position),
            rate=playback.rate,
            bags=list(self._paths),
        )

    def _publish_state(self) -> None:
        self._state._send_while_open(self._state._encode(self._current_state()))

    def _publish_time(self, time: int) -> None:
        """Publish a time on /clock, unless it is the last one that was published."""
        if self._clock is not None and time != self._time:
            self._publish_clock(time)

    def _publish_clock(self, time: int) -> None:
        assert self._clock is not None
        self._time = time
        data = _TIME.pack(*divmod(time, 10**9))
        self._clock._send_while_open(self._clock._encode_serialized(data))

    def _report_skip(self, span: int) -> None:
        """Say that a span without messages is skipped, unless that is as long as was asked for."""
        if span >= LONG_SPAN * 1e9:
            self._node.log.warning("Skipping %s without messages.", span_text(span / 1e9))

    async def _run_state(self) -> None:
        while True:
            await asyncio.sleep(STATE_INTERVAL)
            self._publish_state()

    async def _run_clock(self) -> None:
        loop = asyncio.get_running_loop()
        period = 1 / self._options.clock_rate
        due = loop.time()
        while True:
            self._publish_clock(self._playback.position)
            due = max(due + period, loop.time())
            await asyncio.sleep(due - loop.time())

    def _follow(self, topic: str) -> None:
        """Let the playback wait for the stamps of a topic's messages."""
        playback = self._playback
        playback.controlled = self._playback_options.start

        def take(message: memoryview, header: bytes, received: int, type_: Any) -> None:
            if _FIRST_FIELD.match(type_.definition) is None:
                if type_ not in warned:
                    warned.append(type_)
                    self._node.log.warning(
                        "Rate control topic %s is bad: %s does not begin with a header.",
                        topic,
                        type_.name,
                    )
                return
            seconds, nanoseconds = _TIME.unpack_from(message, 4)
            playback.controlled = seconds * 10**9 + nanoseconds

        warned: list[Any] = []
        self._node.subscribe_serialized(topic, take)

    # The terminal

    def _keys(self) -> Any:
        """Return a context in which the keys of the terminal control the playback."""
        if sys.stdin is None or not sys.stdin.isatty():
            return nullcontext()
        if not self._options.is_quiet:
            output.line("Hit space to toggle paused, or 's' to step.")
        return reading_keys(self._type)

    def _type(self, text: str | None) -> None:
        playback = self._playback
        for key in text or "":
            match key:
                case " ":
                    playback.pause(not playback.is_paused)
                case "s":
                    playback.step()
                case "t":
                    playback.toggle_pause_topics()
        if self._shows_progress:
            self._show_progress()

    @property
    def _shows_progress(self) -> bool:
        return not self._options.is_quiet and output.is_terminal()

    async def _run_progress(self) -> None:
        while True:
            self._show_progress()
            await asyncio.sleep(PROGRESS_INTERVAL)

    def _show_progress(self) -> None:
        click.echo(progress_line(self._playback), nl=False)


def progress_line(playback: Playback) -> str:
    """Return the line that rosbag shows while it plays, between carriage returns."""
    options, position = playback.options, playback.position
    state, delay = "RUNNING", ""
    if playback.is_paused:
        state = "PAUSED "
    elif playback.is_delayed:
        state = "DELAYED"
        delay = f"Delay: {(position - (playback.controlled or 0)) / 1e9:.2f}"
    passed, whole = (position - options.start) / 1e9, (options.end - options.start) / 1e9
    text = f" [{state}]  Bag Time: {position / 1e9:13.6f}   Duration: {passed:.6f} / {whole:.6f}"
    return f"\r{text}   {delay:12}\r"


class _Tasks:
    """Tasks that run until the end of the block."""

    def __init__(self) -> None:
        self._tasks: list[asyncio.Task[None]] = []

    def start(self, coroutine: Any) -> None:
        """Start a task."""
        self._tasks.append(asyncio.ensure_future(coroutine))

    def __enter__(self) -> _Tasks:
        return self

    def __exit__(self, *error: object) -> None:
        for task in self._tasks:
            task.cancel()


# The command


class _PlayCommand(click.Command):
    """A command whose options --topics, --pause-topics and --bags take all words that follow."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Parse the arguments."""
        return super().parse_args(ctx, spread(args, ("--topics", "--pause-topics", "--bags")))


@click.command(cls=_PlayCommand, context_settings=SETTINGS)
@click.option(
    "-p", "--prefix", metavar="PREFIX", default="", help="Put PREFIX before all topics' names."
)
@click.option("-q", "--quiet", is_flag=True, help="Print warnings and errors only.")
@click.option("-i", "--immediate", is_flag=True, help="Play all messages without waiting.")
@click.option("--pause", is_flag=True, help="Start in paused mode.")
@click.option(
    "--queue",
    metavar="SIZE",
    type=click.IntRange(min=0),
    default=100,
    show_default=True,
    help="Queue size of the publishers.",
)
@click.option("--clock", is_flag=True, help="Publish the time of the bag on /clock.")
@click.option(
    "--hz",
    metavar="HZ",
    type=click.FloatRange(min=0, max=1000, min_open=True),
    default=100.0,
    show_default=True,
    help="How often to publish the time with --clock.",
)
@click.option(
    "-d",
    "--delay",
    metavar="SEC",
    type=click.FloatRange(min=0),
    default=0.2,
    show_default=True,
    help="Seconds to wait after topics were advertised, for subscribers to connect.",
)
@click.option(
    "-r",
    "--rate",
    metavar="FACTOR",
    type=click.FloatRange(min=0, min_open=True),
    default=1.0,
    show_default=True,
    help="How much faster than recorded to play.",
)
@click.option(
    "-s",
    "--start",
    metavar="SEC",
    type=float,
    default=0.0,
    help="Start SEC seconds into the bags; a negative number counts from the end.",
)
@click.option(
    "-u",
    "--duration",
    metavar="SEC",
    type=click.FloatRange(min=0),
    help="Play only SEC seconds of the bags.",
)
@click.option(
    "--skip-empty",
    metavar="SEC",
    type=click.FloatRange(min=0),
    default=LONG_SPAN,
    show_default=True,
    help="Skip spans of more than SEC seconds without messages.",
)
@click.option("-l", "--loop", is_flag=True, help="Begin again at the end.")
@click.option(
    "-k", "--keep-alive", is_flag=True, help="Stay at the end, for subscribers of latched topics."
)
@click.option("--try-future-version", is_flag=True, help="Ignored; accepted for compatibility.")
@click.option("--topics", metavar="TOPIC...", multiple=True, help="Play only these topics.")
@click.option(
    "--pause-topics", metavar="TOPIC...", multiple=True, help="Pause before messages of these."
)
@click.option(
    "--bags",
    metavar="BAG...",
    multiple=True,
    shell_complete=completers.files,
    help="Bags to play.",
)
@click.option(
    "--wait-for-subscribers", is_flag=True, help="Wait until each topic has a subscriber."
)
@click.option(
    "--rate-control-topic",
    metavar="TOPIC",
    default="",
    help="Wait while the stamps of this topic's messages are too old.",
)
@click.option(
    "--rate-control-max-delay",
    metavar="SEC",
    type=click.FloatRange(min=0),
    default=1.0,
    show_default=True,
    help="How old they may be.",
)
@examples(
    ("{bag play} walk.bag", "in a terminal: space pauses, s steps"),
    ("{bag play} walk.bag --clock -l", "for nodes that use simulated time"),
    ("{bag play} walk.bag --topics /scan /tf", "two of its topics"),
    ("{bag play} walk.bag /scan:=/laser", "with another name"),
)
@node("play", arguments="BAG...", complete=completers.files)
def command(
    node: fibws.Node,
    arguments: tuple[str, ...],
    bags: tuple[str, ...],
    start: float,
    duration: float | None,
    topics: tuple[str, ...],
    pause_topics: tuple[str, ...],
    quiet: bool,
    **others: Any,
) -> None:
    """Publish the messages of bags as they were recorded.

    Messages arrive with the names of their publishers, and latched topics are latched. The service
    ~pause_playback pauses, too; ~control_playback also steps, seeks and sets the rate.
    """
    paths = (*arguments, *bags)
    if not paths:
        fault = "You must specify at least one bag file to play from"
        for each in filter(os.path.isfile, (*topics, *pause_topics)):
            fault += f": name it before the options, {each} is taken for a topic"
        raise click.UsageError(fault)
    if quiet:
        node.log.setLevel(logging.WARNING)
    if not all(map(math.isfinite, (start, duration or 0.0, others["rate"]))):
        raise click.UsageError("--start, --duration and --rate must be finite numbers")
    with ExitStack() as stack:
        readers = list[Reader]()
        for path in paths:
            if not os.path.lexists(path) and path.lstrip("/") in _topics_of(readers):
                raise click.UsageError(f"no file is named {path}; write --topics before topics")
            reader = stack.enter_context(open_bag(path))
            node.log.info("Opening %s", path)
            readers.append(with_encoding(reader, ROS1))
        readers = [reader for reader in readers if reader.message_count]
        if not readers:
            raise click.ClickException(f"{', '.join(paths)}: no messages to play")
        _check_known("--topics", topics, readers)
        _check_known("--pause-topics", pause_topics, readers)
        _check_playable(readers, _without_slashes(topics))
        playback_options = PlaybackOptions(
            **_span(readers, start, duration),
            rate=others["rate"],
            is_immediate=others["immediate"],
            is_paused=others["pause"],
            is_loop=others["loop"],
            stays=others["keep_alive"],
            skip_empty=round(min(others["skip_empty"], NEVER) * 1e9),
            pause_topics=_without_slashes(pause_topics),
            max_delay=round(others["rate_control_max_delay"] * 1e9),
        )
        options = PlayOptions(
            hub=click.get_current_context().params["hub"],
            topics=_without_slashes(topics),
            prefix=others["prefix"],
            queue_size=others["queue"],
            delay=others["delay"],
            waits_for_subscribers=others["wait_for_subscribers"],
            clock_rate=others["hz"] if others["clock"] else 0.0,
            control_topic=others["rate_control_topic"],
            is_quiet=quiet,
        )
        sys.setswitchinterval(SWITCH_INTERVAL)
        run(_play(node, readers, paths, options, playback_options))


def _without_slashes(topics: Iterable[str]) -> frozenset[str]:
    """Return names as `PlayOptions` has them: bags may hold names without a slash before them."""
    return frozenset(topic.lstrip("/") for topic in topics)


def _topics_of(readers: Iterable[Reader]) -> frozenset[str]:
    """Return the names of all topics of bags, as `PlayOptions` has them."""
    return _without_slashes(each.topic for reader in readers for each in reader.connections)


def _check_known(option: str, topics: Iterable[str], readers: Sequence[Reader]) -> None:
    """Raise a UsageError for a topic that none of the bags has."""
    known = {each.topic for reader in readers for each in reader.connections}
    for topic in topics:
        if topic.lstrip("/") not in _topics_of(readers):
            wanted = f"/{topic.lstrip('/')}"
            fault = f"the bags have no topic {wanted}{suggestion(wanted, known)}"
            raise click.UsageError(f"{option}: {fault}; they have {', '.join(sorted(known))}")


def _check_playable(readers: Sequence[Reader], topics: frozenset[str]) -> None:
    """Raise an error if nothing of the bags can be played, before a hub is waited for.

    Args:
        topics: those to play, as `PlayOptions` has them; all if it is empty.
    """
    faults = []
    for reader in readers:
        for each in reader.connections:
            if topics and each.topic.lstrip("/") not in topics:
                continue
            if each.id not in reader.not_converted:
                return
            faults.append(reader.not_converted[each.id])
    raise click.ClickException(output.visible(f"nothing can be played: {faults[0]}"))


def _span(readers: Sequence[Reader], start: float, duration: float | None) -> dict[str, int]:
    """Return the times at which the playback begins and ends."""
    first, last = min(each.start for each in readers), max(each.end for each in readers)
    begin = (first if start >= 0 else last) + round(start * 1e9)
    end = last if duration is None else min(last, begin + round(duration * 1e9))
    if not first <= begin <= last:
        seconds = (last - first) / 1e9
        raise click.UsageError(f"--start must be within the {seconds:.3f} s of the bags")
    return {"start": begin, "end": end}


async def _play(
    node: fibws.Node,
    readers: Sequence[Reader],
    paths: Sequence[str],
    options: PlayOptions,
    playback_options: PlaybackOptions,
) -> None:
    async with node:
        await Player(node, readers, paths, options, playback_options).run()
