"""Recording within the hub: all topics, in bags (``--record``).

The recorder is a node of the hub's own, with a `Sink` for each topic that has a publisher. Nothing
is decoded or sent: the bytes of messages go to a `Recorder`, whose thread writes them.
"""

from __future__ import annotations

import logging
import time
from collections import OrderedDict
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from pydantic_core import from_json

from fibws.bag_recorder import (
    MIB,
    PLAYBACK,
    Origin,
    Recorder,
    RecordingOptions,
    RecordingState,
    Stream,
)
from fibws.errors import FibwsError
from fibws.hub.errors import NotAllowed
from fibws.hub.graph.graph import Graph
from fibws.hub.graph.publication import Publication
from fibws.hub.graph.service import Deferred, Function, Response
from fibws.hub.graph.topic import SinkReport, Topic
from fibws.hub.graph.types import MessageType
from fibws.hub.log.audit import Audit
from fibws.hub.settings import Settings

if TYPE_CHECKING:
    from asyncio import AbstractEventLoop, TimerHandle

logger = logging.getLogger("fibws.hub")

NODE = "/hub_recorder"
STATE = f"{NODE}/state"
"""The topic of the recording's state (fibws_msgs/RecordingState)."""
MOST_DEPARTED = 100
"""Publishers of a topic that have left and are remembered, as they may come back."""
STATE_INTERVAL = 1.0
"""Seconds between two messages of the state while something is recorded."""
MOST_FILES = 10_000
"""Files of recordings whose names are kept, for downloads."""


def options(settings: Settings, buffer_size: int) -> RecordingOptions:
    """Return the recorder's options for those settings that begin with ``record``."""
    return RecordingOptions(
        path=f"{settings.record}/{'.mcap' if settings.record_mcap else ''}",
        compression=settings.record_compression,
        buffer_size=buffer_size,
        split=bool(settings.record_size or settings.record_duration),
        max_size=settings.record_size * MIB,
        max_duration=round(settings.record_duration * 1e9),
        max_splits=settings.record_files,
        min_space=settings.record_min_space * MIB,
        repeat_latched=True,
    )


class RecordedTopic:
    """Takes the messages of one topic; a `Sink`."""

    __slots__ = (
        "_definition",
        "_fault",
        "_put",
        "_recorder",
        "_recording",
        "_streams",
        "messages",
        "topic",
    )

    node = NODE

    def __init__(self, topic: Topic, recorder: Recorder, recording: Recording) -> None:
        self.topic = topic
        self.messages = 0
        self._recorder = recorder
        self._put = recorder.put
        self._recording = recording
        self._streams: dict[bytes, tuple[MessageType, Stream]] = {}
        """By the publishers' connection headers."""
        self._definition: tuple[MessageType | None, str] = None, ""
        """The text of the last message's type, which all publishers share."""
        self._fault = ""

    def receive(self, publication: Publication) -> None:
        """Record a message."""
        found = self._streams.get(publication.header)
        if found is None or found[0] is not publication.type:
            stream = self._find_stream(publication)
            if stream is None:
                return
        else:
            stream = found[1]
        self.messages += 1
        self._put(stream, publication.received, publication.ros1())

    def replay(self, publication: Publication) -> None:
        """Record a latched message: now, and not when it was published."""
        stream = self._find_stream(publication)
        if stream is not None:
            self.messages += 1
            self._put(stream, self._recording.graph.clock.now(), publication.ros1())

    def report(self) -> SinkReport:
        """Return the totals."""
        return SinkReport(messages=self.messages)

    def forget_departed(self) -> None:
        """Forget the publishers that have left, once these are more than those that are there."""
        sources = self.topic.publishers
        if sources and len(self._streams) <= 2 * len(sources) + MOST_DEPARTED:
            return
        headers = {each.header for each in sources.values()}
        kept = {header: found for header, found in self._streams.items() if header in headers}
        streams = {stream for _, stream in kept.values()}
        for _, stream in self._streams.values():
            if stream not in streams:
                self._recorder.forget(stream)
        self._streams = kept

    def _find_stream(self, publication: Publication) -> Stream | None:
        """Return the stream of a message's publisher; None if the fields are unknown."""
        try:
            stream = self._recorder.stream(self._origin(publication))
        except FibwsError as error:
            if str(error) != self._fault:
                self._fault = str(error)
                logger.warning("%s is not recorded: %s.", self.topic.name, error)
            return None
        self.forget_departed()
        self._streams[publication.header] = (publication.type, stream)
        return stream

    def _origin(self, publication: Publication) -> Origin:
        """Return where a message comes from; raise `FibwsError` if its fields are unknown."""
        type_ = publication.type
        type_.check_known()
        if self._definition[0] is not type_:
            # The definitions of the graph may be others than those of the hub's own topics.
            text = type_.codecs.definitions.full_text(type_.name) if type_.codecs else ""
            self._definition = type_, text
        header = from_json(publication.header)
        return Origin(
            self.topic.name,
            type_.name,
            type_.md5sum or "",
            self._definition[1],
            header.get("callerid", publication.node),
            header.get("latching") == "1",
        )


class RecordingTotals(NamedTuple):
    """What was recorded since the hub has started."""

    messages: int = 0
    bytes: int = 0
    dropped: int = 0


class Recording:
    """The hub's node that records, its services, and the topic of its state.

    The hub's own topics are not recorded, as other nodes cannot publish them; nor are the states of
    players.

    Args:
        settings: those that begin with ``record``; the folder must be set.
    """

    def __init__(
        self,
        graph: Graph,
        settings: Settings,
        audit: Audit,
        loop: AbstractEventLoop,
        most_bytes: int,
    ) -> None:
        self.graph = graph
        self.buffer_size = min(settings.record_buffer * MIB or most_bytes, most_bytes)
        """Bytes of messages that may wait for the disk; latched ones may take as many."""
        self._settings = settings
        self._audit = audit
        self._loop = loop
        self._recorder: Recorder | None = None
        """The current recording, or the last one."""
        self._topics: dict[str, RecordedTopic] = {}
        self._is_recording = False
        self._files: OrderedDict[str, Path] = OrderedDict()
        """All files since the hub's start, by their names."""
        self._past = RecordingTotals()
        """Of the recordings that have ended."""
        self._starting: list[Callable[[], None]] = []
        """What waits for the first file of the recording."""
        self._waiting: list[Callable[[], None]] = []
        """What waits for the end of the recording."""
        self._timer: TimerHandle | None = None
        self._is_closed = False
        graph.rights.internal.add(NODE)
        graph.permanent.add(NODE)
        graph.reserved.add(STATE)
        for name, (type_, function) in self._services().items():
            graph.serve_internally(name, type_, NODE, function)
        self._state = graph.advertise(
            graph.topic(STATE), NODE, "fibws_msgs/RecordingState", latch=True
        )
        graph.enter(self, NODE, internal=True)
        graph.watch_topics(self._topic_changed)
        self._publish_state()

    # As a node

    def publishing(self) -> tuple[str, ...]:
        """Return the topics that it publishes."""
        return (STATE,)

    def subscribing(self) -> tuple[str, ...]:
        """Return the topics that are recorded."""
        return tuple(self._topics)

    def providing(self) -> tuple[str, ...]:
        """Return its services."""
        return tuple(self._services())

    def replaced(self) -> None:
        """Fail: no client can take its name."""
        raise AssertionError(f"{NODE} is the hub's own")

    # Beginning and ending

    def start(self) -> None:
        """Record from now on; nothing happens if that is done already."""
        if self._is_recording or self._is_closed:
            return
        recorder = Recorder(
            options(self._settings, self.buffer_size),
            self.graph.clock.now,
            logger,
            on_file=lambda path: self._loop.call_soon_threadsafe(self._file_begun, path),
            on_end=lambda: self._loop.call_soon_threadsafe(self._ended),
        )
        self._recorder = recorder
        self._is_recording = True
        recorder.start()
        for topic in list(self.graph.topics.values()):
            self._topic_changed(topic)
        self._tick()

    def stop(self, done: Callable[[], None]) -> None:
        """End the recording, and call a function once the file is complete."""
        if not self._is_recording or self._recorder is None:
            done()
            return
        self._waiting.append(done)
        self._recorder.finish()
        self._leave_topics()

    def state(self) -> RecordingState | None:
        """Return how far the recording has come; None before the first one."""
        return self._recorder.state() if self._recorder is not None else None

    def totals(self) -> RecordingTotals:
        """Return what has been recorded so far, by all recordings."""
        past, state = self._past, self.state()
        if state is None or not self._is_recording:
            return past
        return RecordingTotals(
            past.messages + state.messages,
            past.bytes + state.bytes,
            past.dropped + state.dropped,
        )

    @property
    def buffered(self) -> int:
        """Bytes that wait for the disk."""
        state = self.state()
        return state.buffered if state is not None else 0

    @property
    def held_bytes(self) -> int:
        """Bytes that the recorder holds."""
        return self._recorder.held_bytes if self._recorder is not None else 0

    @property
    def is_recording(self) -> bool:
        """Whether something is recorded now."""
        return self._is_recording

    @property
    def fault(self) -> str:
        """Why the disk takes no messages, so that nothing is recorded; usually empty."""
        state = self.state()
        return state.fault if state is not None else ""

    def close(self, done: Callable[[], None]) -> None:
        """End, and take everything back; a function is called when the file is complete."""
        self._is_closed = True
        self.stop(done)

    def remove(self) -> None:
        """Take the node, its services and its topic back."""
        self._is_closed = True
        self._leave_topics()
        if self._timer is not None:
            self._timer.cancel()
        self.graph.remove_source(self._state)
        for name in self._services():
            self.graph.remove_service(self.graph.services[name])
        self.graph.leave(self, NODE)

    def find(self, name: str) -> Path | None:
        """Return the path of a file of this hub's recordings by its name."""
        return self._files.get(name)

    def _file_begun(self, path: Path) -> None:
        self._files[path.name] = path
        if len(self._files) > MOST_FILES:
            self._files.popitem(last=False)
        self._begun()

    def _begun(self) -> None:
        """Tell those who wait for it that a file has begun, or that none can begin."""
        starting, self._starting = self._starting, []
        for done in starting:
            done()

    def _ended(self) -> None:
        """Called when the recording is complete, or has failed."""
        self._past = self.totals()
        self._is_recording = False
        self._begun()
        self._leave_topics()
        if not self._is_closed:
            self._publish_state()
        waiting, self._waiting = self._waiting, []
        for done in waiting:
            done()

    # Topics

    def _topic_changed(self, topic: Topic) -> None:
        """Subscribe to a topic that has a publisher, and leave one that has none any more."""
        recorder = self._recorder
        if recorder is None or not self._is_recording or topic.name in self.graph.reserved:
            return
        if topic.type is not None and topic.type.name == PLAYBACK:
            return
        sink = self._topics.get(topic.name)
        if sink is None and topic.publishers and not recorder.is_finishing:
            sink = self._topics[topic.name] = RecordedTopic(topic, recorder, self)
            self.graph.subscribe(topic, sink)
            topic.replay(sink)
        elif sink is not None:
            sink.forget_departed()
            if not topic.publishers:
                self._leave(sink)

    def _leave_topics(self) -> None:
        for sink in list(self._topics.values()):
            self._leave(sink)

    def _leave(self, sink: RecordedTopic) -> None:
        del self._topics[sink.topic.name]
        self.graph.unsubscribe(sink.topic, sink)

    # Services and the state

    def _services(self) -> dict[str, tuple[str, Function]]:
        return {
            f"{NODE}/start": ("std_srvs/Trigger", self._handle_start),
            f"{NODE}/stop": ("std_srvs/Trigger", self._handle_stop),
            f"{NODE}/status": ("fibws_msgs/GetRecording", self._handle_status),
        }

    def _handle_start(self, request: dict[str, Any], caller: str) -> Response | Deferred:
        self._check_admin(caller, "start")
        if self._is_recording:
            return {"success": False, "message": "a recording is in progress"}
        response = Deferred()

        def done() -> None:
            state = self.state()
            if self._is_recording or state is None:
                text = f"recording to {self._settings.record}"
                response.respond({"success": True, "message": text})
            else:
                response.respond({"success": False, "message": state.fault})

        self._starting.append(done)
        self._audit.recording_started(str(self._settings.record), node=caller)
        self.start()
        return response

    def _handle_stop(self, request: dict[str, Any], caller: str) -> Response | Deferred:
        self._check_admin(caller, "stop")
        if not self._is_recording:
            return {"success": False, "message": "nothing is recorded"}
        self._audit.recording_stopped(str(self._settings.record), node=caller)
        response = Deferred()

        def done() -> None:
            state = self.state()
            if state is not None:
                files = f"{state.files} files, the last one " if state.files > 1 else ""
                text = state.fault or f"recorded {state.messages} messages in {files}{state.file}"
                response.respond({"success": not state.fault, "message": text})

        self.stop(done)
        return response

    def _handle_status(self, request: dict[str, Any], caller: str) -> Response:
        return {"state": self._values()}

    def _check_admin(self, caller: str, verb: str) -> None:
        policy = self.graph.policy
        if not policy.allows_all and not policy.is_admin(caller):
            raise self.graph.rights.refused(NotAllowed(caller, "admin", f"{NODE}/{verb}"))

    def _values(self) -> dict[str, Any]:
        """Return the state as fibws_msgs/RecordingState."""
        state = self.state()
        stamp = _time(time.time_ns())
        if state is None:
            return {"stamp": stamp}
        return {
            "stamp": stamp,
            "recording": self._is_recording,
            "since": _time(state.began),
            **{name: getattr(state, name) for name in _COUNTS},
        }

    def _publish_state(self) -> None:
        self._state.publish(self._values())

    def _tick(self) -> None:
        """Publish the state every second while something is recorded."""
        if self._is_recording and not self._is_closed:
            self._publish_state()
            self._timer = self._loop.call_later(STATE_INTERVAL, self._tick)


def _time(nanoseconds: int) -> dict[str, int]:
    seconds, rest = divmod(nanoseconds, 10**9)
    return {"secs": seconds, "nsecs": rest}


_COUNTS = ("file", "files", "messages", "bytes", "buffered", "dropped", "fault")
