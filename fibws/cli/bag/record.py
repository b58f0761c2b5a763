"""``fibws bag record``: a node that records topics, with the options of rosbag record."""

from __future__ import annotations

import asyncio
import json
import logging
import re
import sys
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import click

import fibws
from fibws.bag_recorder import (
    MIB,
    PLAYBACK,
    Compression,
    Origin,
    Recorder,
    RecordingOptions,
    RecordingState,
    Stream,
)
from fibws.bags.rosbag2 import MCAP_SUFFIX
from fibws.bags.summary import size_text
from fibws.cli import completers, output
from fibws.cli.bag.bag_messages import check_new_name, warn
from fibws.cli.common_options import examples
from fibws.cli.node_program import SETTINGS, node, run
from fibws.errors import BagError, FibwsError, InterfaceError
from fibws.msg import default_interfaces
from fibws.msg.std_msgs import String
from fibws.names import HUB_TOPICS
from fibws.srv import fibws_msgs, rosapi
from fibws.suggestions import suggestion

LOOK_INTERVAL = 0.5
"""Seconds between two looks for new topics; rosbag looks once a second."""
CLOCK_LAG = 10**9
"""Nanoseconds that this node's time may be behind the hub's."""
NEW_LATCHED = 10 * 10**9
"""Nanoseconds after which a latched message that arrives late is not new, at high rates, too."""
REPORT_TIMEOUT = 2.0
"""Seconds that the hub may take at the end to report what it has dropped."""
_MULTIPLIERS = {"": 1, "k": 2**10, "M": 2**20, "G": 2**30}
_DURATIONS = {"": 1, "s": 1, "m": 60, "h": 3600}


@dataclass(frozen=True, slots=True, kw_only=True)
class Topics:
    """Which topics to record.

    Attributes:
        names: of topics, or with ``are_patterns`` regular expressions.
        all: record all topics.
        excluded: matches the topics that are not recorded.
        node: record what this node subscribes to; empty for no such node.
    """

    names: tuple[str, ...]
    are_patterns: bool = False
    all: bool = False
    excluded: re.Pattern[str] | None = None
    node: str = ""

    def wants(self, topic: str) -> bool:
        """Return whether to record a topic that there is."""
        if self.excluded is not None and self.excluded.fullmatch(topic):
            return False
        if self.all:
            return topic not in HUB_TOPICS  # Nobody could play them.
        return self.are_patterns and any(re.fullmatch(each, topic) for each in self.names)

    @property
    def may_grow(self) -> bool:
        """Whether topics that appear later are recorded, too."""
        return self.all or self.are_patterns or bool(self.node)


class RecordingNode:
    """Subscribes to topics and hands their messages to a recorder.

    Args:
        announces: whether to publish each file's name on ``begin_write`` when it begins.
    """

    def __init__(
        self, node: fibws.Node, topics: Topics, options: RecordingOptions, *, announces: bool
    ) -> None:
        self._node = node
        self._topics = topics
        self._loop = asyncio.get_running_loop()
        self._ended = asyncio.Event()
        self._subscriptions: dict[str, fibws.Subscription[Any]] = {}
        self._tasks: set[asyncio.Task[None]] = set()
        self._announces = announces
        self._announcer: fibws.Publisher[Any, ...] | None = None
        self._began = 0
        """The hub's time when the recording began."""
        self._has_limit = bool(options.limit)
        self._fault = ""
        """Why the last look for topics failed."""
        self.recorder = Recorder(
            options,
            lambda: node.now().to_nanoseconds(),
            node.log,
            on_file=lambda path: self._call(self._announce, path),
            on_end=lambda: self._call(self._ended.set),
        )

    async def run(self) -> None:
        """Record until the recording is complete, has failed, or this is cancelled.

        Raises:
            BagError: the server is no fibws hub.
        """
        node = self._node
        if self._announces:
            self._announcer = await node.advertise("begin_write", String, queue_size=1, latch=True)
        if not node.serialized:
            raise BagError(f"cannot record from {node.hub}: it is no fibws hub (fibws.v1)")
        response = await node.call("/rosapi/get_time", rosapi.GetTime)
        self._began = response.time.to_nanoseconds()
        if not self._topics.are_patterns:
            names = [node.resolve(name) for name in self._topics.names]
            await self._report_unpublished(names)
            for name in names:
                self._subscribe(name)
        if self._topics.node:
            await self._report_unknown_node(node.resolve(self._topics.node))
        self.recorder.start()
        watcher = asyncio.create_task(self._look_for_topics()) if self._topics.may_grow else None
        try:
            await self._ended.wait()
        finally:
            if watcher is not None:
                watcher.cancel()
            dropped = await self._dropped_by_hub()
            for subscription in self._subscriptions.values():
                subscription.close()
            await asyncio.to_thread(self.recorder.stop)
            if dropped:
                node.log.warning(
                    "The hub has dropped %d messages, as this recorder read too slowly.", dropped
                )

    def _call(self, function: Callable[..., object], *arguments: Any) -> None:
        """Call a function in the loop, from the recorder's thread."""
        self._loop.call_soon_threadsafe(function, *arguments)

    def _announce(self, path: Path) -> None:
        if self._announcer is not None:
            self._announcer._send_while_open(self._announcer._encode(str(path)))

    # Topics

    async def _report_unpublished(self, names: list[str]) -> None:
        """Say which topics nobody publishes, as they may be misspelled."""
        if not names:
            return
        response = await self._node.call("/rosapi/topics", rosapi.Topics)
        types = dict(zip(response.topics, response.types, strict=True))
        published = [topic for topic, type_ in types.items() if type_]
        for name in names:
            if name not in published:
                text = "topic [%s] does not appear to be published yet%s"
                self._node.log.warning(text, name, suggestion(name, published))

    async def _report_unknown_node(self, name: str) -> None:
        known = await self._node.graph.nodes()
        if name not in known:
            self._node.log.warning("node [%s] is not there yet%s", name, suggestion(name, known))

    async def _look_for_topics(self) -> None:
        """Subscribe to the topics that there are, and to those that appear."""
        while True:
            for name in await self._names():
                if name not in self._subscriptions:
                    self._subscribe(name)
            await asyncio.sleep(LOOK_INTERVAL)

    async def _names(self) -> Iterable[str]:
        try:
            if self._topics.node:
                details = await self._node.graph.node(self._topics.node)
                return details.subscribing
            response = await self._node.call("/rosapi/topics", rosapi.Topics)
        except FibwsError as error:
            if str(error) != self._fault:
                self._fault = str(error)
                self._node.log.warning("Cannot look for topics: %s", error)
            return ()
        types = dict(zip(response.topics, response.types, strict=True))
        return [each for each in types if types[each] != PLAYBACK and self._topics.wants(each)]

    def _subscribe(self, topic: str) -> None:
        self._node.log.info("Subscribing to %s", topic)
        take = self._taker(topic)
        subscription = self._node.subscribe_serialized(topic, take)
        self._subscriptions[topic] = subscription
        task = asyncio.create_task(self._watch(subscription), name=f"record {topic}")
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)

    async def _watch(self, subscription: fibws.Subscription[Any]) -> None:
        try:
            async for _ in subscription:
                pass
        except FibwsError as error:
            self._node.log.error("%s is not recorded: %s", subscription.topic, error)

    def _taker(self, topic: str) -> Callable[[memoryview, bytes, int, Any], None]:
        """Return what records the messages of a topic."""
        recorder, put = self.recorder, self.recorder.put
        known: dict[bytes, tuple[Any, Stream]] = {}
        """By connection headers: the type and the stream."""

        def take(message: memoryview, header: bytes, received: int, type_: Any) -> None:
            found = known.get(header)
            if found is None or found[0] is not type_:
                stream = self._stream(topic, header, type_)
                if found is None and stream.origin.latching:
                    received = self._time_of_latched(received)
                found = known[header] = (type_, stream)
            put(found[1], received, message)
            if self._has_limit and recorder.is_complete(topic):
                self._end_topic(topic)

        return take

    def _time_of_latched(self, received: int) -> int:
        """Return the time of the first message of a latching publisher.

        It may have been published before the recording, by a clock that has jumped since: it is
        recorded as of the beginning then. If time was set back since the beginning, it keeps a time
        shortly before now, as it may be new.
        """
        now = self._node.now().to_nanoseconds()
        if 0 < now < self._began - CLOCK_LAG:
            return received if now - NEW_LATCHED <= received <= now else now
        return received if self._began <= received <= now + CLOCK_LAG else self._began

    def _stream(self, topic: str, header: bytes, type_: Any) -> Stream:
        fields = json.loads(header)
        origin = Origin(
            topic,
            type_.name,
            type_.md5sum,
            type_.definition or _local_definition(type_.name, type_.md5sum),
            fields.get("callerid", ""),
            fields.get("latching") == "1",
        )
        return self.recorder.stream(origin)

    def _end_topic(self, topic: str) -> None:
        self._subscriptions[topic].close()
        if all(map(self.recorder.is_complete, self._subscriptions)):
            self._ended.set()

    async def _dropped_by_hub(self) -> int:
        """Return how many messages the hub could not send, since this node was too slow."""
        try:
            found = await self._node.call(
                "/rosapi/statistics", fibws_msgs.GetStatistics, timeout=REPORT_TIMEOUT
            )
        except FibwsError:
            return 0
        return sum(
            each.dropped
            for topic in found.topics
            for each in topic.subscriptions
            if each.node == self._node.name
        )


def _local_definition(type_: str, md5sum: str) -> str:
    """Return the text of a type that is installed here; empty for another type."""
    interfaces = default_interfaces()
    try:
        return interfaces.full_text(type_) if interfaces.md5(type_) == md5sum else ""
    except InterfaceError:
        return ""


# The command


def _number_with_unit(
    units: dict[str, int], example: str
) -> Callable[[click.Context, click.Parameter, str | None], float]:
    """Return the callback of an option whose value is a number with a unit behind it."""

    def parse(context: click.Context, parameter: click.Parameter, text: str | None) -> float:
        if text is None:
            return 0.0
        found = re.fullmatch(r"(\d+(?:\.\d*)?|\.\d+)([A-Za-z]?)", text.strip())
        known = {unit.lower(): factor for unit, factor in units.items()}
        if found is None or found[2].lower() not in known:
            raise click.BadParameter(f"expected a number such as {example}, got {text!r}")
        return float(found[1]) * known[found[2].lower()]

    return parse


def _pattern(
    context: click.Context, parameter: click.Parameter, text: str | None
) -> re.Pattern[str] | None:
    return _compiled(text) if text is not None else None


def _compiled(text: str) -> re.Pattern[str]:
    try:
        return re.compile(text)
    except re.error as error:
        raise click.BadParameter(f"invalid regular expression {text!r}: {error}") from None


def _compression(name: str, options: dict[str, Any]) -> Compression:
    """Return the compression that was chosen for the bag of a name."""
    methods: tuple[Compression, ...] = ("bz2", "lz4", "zstd")
    chosen = [each for each in methods if options[each]]
    if len(chosen) > 1:
        raise click.UsageError("Can only use one type of compression")
    found = chosen[0] if chosen else "none"
    unknown, format_ = ("bz2", ".mcap") if name.endswith(MCAP_SUFFIX) else ("zstd", ".bag")
    if found == unknown:
        raise click.UsageError(f"--{found} does not exist for {format_} files")
    return found


_IGNORED = "Ignored; accepted for compatibility with rosbag."


@click.command(context_settings=SETTINGS)
@click.option("-a", "--all", "all_", is_flag=True, help="Record all topics.")
@click.option("-e", "--regex", is_flag=True, help="Match topics using regular expressions.")
@click.option(
    "-x",
    "--exclude",
    metavar="REGEX",
    callback=_pattern,
    help="Exclude the topics that match this regular expression (with -a or -e).",
)
@click.option("-q", "--quiet", is_flag=True, help="Print warnings and errors only.")
@click.option(
    "-o",
    "--output-prefix",
    "prefix",
    metavar="PREFIX",
    help="Begin of the bag's name; the date and time follow.",
)
@click.option(
    "-O",
    "--output-name",
    "name",
    metavar="NAME",
    help="Name of the bag. With the suffix .mcap it is an MCAP file, else a .bag.",
)
@click.option(
    "--split", is_flag=True, help="Begin another bag when --size or --duration is reached."
)
@click.option(
    "--max-splits",
    metavar="COUNT",
    type=click.IntRange(min=1),
    help="Keep the newest COUNT bags of a split, and remove older ones.",
)
@click.option("--size", metavar="MB", type=click.IntRange(min=1), help="Maximum size of a bag.")
@click.option(
    "--duration",
    metavar="TIME",
    callback=_number_with_unit(_DURATIONS, "30, 5m or 1h"),
    help="Maximum duration of a bag in seconds, or with m in minutes, with h in hours.",
)
@click.option(
    "-b",
    "--buffsize",
    metavar="MB",
    type=click.IntRange(min=0),
    default=256,
    show_default=True,
    help="Messages that may wait for the disk; 0 for no limit.",
)
@click.option(
    "--chunksize",
    metavar="KB",
    type=click.IntRange(min=1),
    default=768,
    show_default=True,
    help="Size of the bag's chunks.",
)
@click.option(
    "-l",
    "--limit",
    metavar="COUNT",
    type=click.IntRange(min=0),
    default=0,
    help="Record COUNT messages of each topic only.",
)
@click.option(
    "-L",
    "--min-space",
    metavar="SIZE",
    default="1G",
    show_default=True,
    callback=_number_with_unit(_MULTIPLIERS, "1G, 500M or 0"),
    help="Free space of the disk below which nothing is recorded.",
)
@click.option("-j", "--bz2", is_flag=True, help="Use BZ2 compression (for .bag).")
@click.option("--lz4", is_flag=True, help="Use LZ4 compression.")
@click.option("--zstd", is_flag=True, help="Use Zstandard compression (for .mcap).")
@click.option(
    "--node",
    "observed",
    metavar="NODE",
    shell_complete=completers.nodes,
    help="Record the topics that this node subscribes to.",
)
@click.option(
    "--topic",
    "topics",
    metavar="TOPIC",
    multiple=True,
    shell_complete=completers.topics,
    help="Topic to record.",
)
@click.option(
    "--repeat-latched", is_flag=True, help="Begin each bag of a split with the latched messages."
)
@click.option(
    "-p",
    "--publish",
    is_flag=True,
    help="Publish the name of each bag that begins on the topic begin_write.",
)
@click.option("--tcpnodelay", is_flag=True, help=_IGNORED)
@click.option("--udp", is_flag=True, help=_IGNORED)
@examples(
    ("{bag record} -a", "all topics, in a bag named after the date and time"),
    ("{bag record} -O walk.mcap /scan /tf", "two topics, in an MCAP file"),
    ("{bag record} -a --split --duration 5m --max-splits 12 --lz4", "the last hour"),
)
@node("record", arguments="[TOPIC]...", complete=completers.topics)
def command(
    node: fibws.Node,
    arguments: tuple[str, ...],
    topics: tuple[str, ...],
    all_: bool,
    regex: bool,
    exclude: re.Pattern[str] | None,
    quiet: bool,
    prefix: str | None,
    name: str | None,
    split: bool,
    max_splits: int | None,
    size: int | None,
    duration: float,
    observed: str | None,
    publish: bool,
    **others: Any,
) -> None:
    """Record the messages of topics in a bag, until Ctrl-C.

    Messages are written as they come, without being decoded; no message classes are needed. While
    it is written, a bag's name ends with .active. After a crash `fibws bag reindex` restores it.
    """
    names = (*topics, *arguments)
    if not names and not all_ and not observed:
        raise click.UsageError("You must specify a topic name or else use the '-a' option.")
    if prefix is not None and name is not None:
        raise click.UsageError("Can't set both prefix and name.")
    if split and not (size or duration):
        raise click.UsageError("Split specified without giving a maximum duration or size")
    if max_splits and not split:
        raise click.UsageError("--max-splits requires --split")
    check_new_name(name or prefix or "")
    if exclude is not None and not (all_ or regex):
        warn("--exclude is for -a and -e only")
    if regex:
        for each in names:
            _compiled(each)
    options = RecordingOptions(
        path=name if name is not None else prefix or "",
        dated=name is None,
        compression=_compression(name or prefix or "", others),
        chunk_size=others["chunksize"] * 1024,
        buffer_size=others["buffsize"] * MIB,
        split=split,
        max_size=(size or 0) * MIB,
        max_duration=round(duration * 1e9),
        max_splits=max_splits or 0,
        limit=others["limit"],
        min_space=round(others["min_space"]),
        repeat_latched=others["repeat_latched"],
    )
    try:
        options.check()
    except BagError as error:
        raise click.ClickException(str(error)) from None
    wanted = Topics(
        names=names,
        are_patterns=regex,
        all=all_,
        excluded=exclude,
        node=observed or "",
    )
    if quiet:
        node.log.setLevel(logging.WARNING)
    run(_record(node, wanted, options, announces=publish, is_quiet=quiet))


async def _record(
    node: fibws.Node,
    topics: Topics,
    options: RecordingOptions,
    *,
    announces: bool,
    is_quiet: bool,
) -> None:
    async with node:
        recording = RecordingNode(node, topics, options, announces=announces)
        try:
            await recording.run()
        finally:
            state = recording.recorder.state()
            if state.files and not is_quiet:
                output.line(_summary(state))
    if state.fault:  # It has been logged.
        sys.exit(1)


def _summary(state: RecordingState) -> str:
    """Return what was recorded: ``40 messages, 24.5 KB in out.mcap``."""
    where = state.file if state.files == 1 else f"{state.files} bags, the last one {state.file}"
    return f"{output.counted(state.messages, 'message')}, {size_text(state.bytes)} in {where}"
