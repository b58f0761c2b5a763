"""/metrics: the hub's counters and gauges for Prometheus.

They are read from the totals that the hub has anyway; a message costs nothing more for them. All
is read in one turn of the event loop, so that the numbers fit each other. Counters never go back
when a client or a topic leaves: what they had counted is kept.
"""

from __future__ import annotations

import gzip
import http
import os
import platform
import sys
import time
from collections.abc import Callable, Collection, Iterable, Mapping
from pathlib import Path
from typing import Any, Protocol

from websockets.http11 import Response

from fibws import __version__
from fibws.hub.graph.graph import Graph
from fibws.hub.http.requests import Get, accepts, response
from fibws.hub.log.audit import Audit
from fibws.hub.memory.account import Account
from fibws.hub.monitoring.exposition import Column, Exposition
from fibws.hub.monitoring.loop_lag import LoopLag
from fibws.hub.monitoring.probes import Probes, Watchers
from fibws.hub.settings import Settings
from fibws.hub.websocket import tcp_counters
from fibws.hub.websocket.connection import Connection
from fibws.hub.websocket.shared_limits import SharedLimits

_PROC = Path("/proc/self")
_STARTED = time.time()
BY_TOPIC = (
    Column("fibws_topic_messages", "Messages published, by topic."),
    Column("fibws_topic_bytes", "Bytes of the messages published, by topic."),
    Column("fibws_topic_sent_messages", "Messages sent to subscribers, by topic."),
    Column(
        "fibws_topic_dropped_messages", "Messages dropped for slow subscribers, by topic.", True
    ),
    Column("fibws_topic_throttled_messages", "Messages left out on request, by topic.", True),
)
BY_HUB = (
    Column("fibws_link_sent_messages", "Messages sent to another hub, by hub."),
    Column("fibws_link_received_messages", "Messages received from another hub, by hub."),
    Column("fibws_link_sent_bytes", "Bytes sent to another hub, by hub."),
    Column("fibws_link_received_bytes", "Bytes received from another hub, by hub."),
    Column("fibws_link_dropped_messages", "Messages dropped as the link was too slow, by hub."),
    Column("fibws_link_lost_messages", "Messages of another hub that were lost, by hub."),
)
SMALL = 1024
"""Bytes below which a body is not compressed."""


class ClientTotals:
    """The totals of all clients, those that have left included.

    Args:
        connections: all connections, now and later.
    """

    def __init__(self, connections: Collection[Connection]) -> None:
        self.connected = 0
        """Clients that have connected so far."""
        self._connections = connections
        self._dropped = 0
        self._limited = 0
        self._seen: dict[Connection, tuple[int, int]] = {}
        """The bytes of each connection as of the last look: some sockets are gone at the end."""
        self._received = 0
        self._sent = 0

    def left(self, connection: Connection) -> None:
        """Keep the totals of a connection that is about to be lost."""
        if connection.endpoint is not None:
            self._dropped += connection.queue.dropped
            self._limited += connection.limited
        received, sent = self._transferred(connection)
        self._seen.pop(connection, None)
        self._received += received
        self._sent += sent

    def dropped(self) -> int:
        """Return the messages that were dropped for all clients so far."""
        present = (each.queue.dropped for each in self._connections if each.is_open)
        return self._dropped + sum(present)

    def limited(self) -> int:
        """Return the messages of all clients that were beyond their rates, and so dropped."""
        return self._limited + sum(each.limited for each in self._connections)

    def transferred(self) -> tuple[int, int]:
        """Return the bytes that all clients have sent, and those that they have received."""
        received, sent = self._received, self._sent
        for each in self._connections:
            more = self._seen[each] = self._transferred(each)
            received += more[0]
            sent += more[1]
        return received, sent

    def _transferred(self, connection: Connection) -> tuple[int, int]:
        counts = tcp_counters.read(connection.socket)
        if counts is None:
            return self._seen.get(connection, (0, 0))
        return counts.received, counts.acknowledged


class MeasuredRecording(Protocol):
    """The recorder of topics, as far as metrics use it."""

    @property
    def is_recording(self) -> bool:
        """Whether something is recorded now."""

    @property
    def fault(self) -> str:
        """Why nothing is recorded; usually empty."""

    @property
    def buffered(self) -> int:
        """Bytes that wait for the disk."""

    def totals(self) -> tuple[int, int, int]:
        """Return the messages that were recorded, the bytes, and the messages that were not."""


class Metrics:
    """Responds to /metrics.

    Args:
        links: returns the links to other hubs, as fibws_msgs/HubLink.
        recording: what records all topics, if anything does.
        has_unsaved: returns whether the parameters cannot be written, if they are kept.
        certificate_end: returns when the hub's certificate ends, if it is known.
        account: counts what is held for clients.
        loop: the name of the event loop's library.
    """

    def __init__(
        self,
        graph: Graph,
        connections: Collection[Connection],
        *,
        settings: Settings,
        clients: ClientTotals,
        limits: SharedLimits,
        audit: Audit,
        lag: LoopLag,
        probes: Probes,
        watchers: Watchers,
        links: Callable[[], Iterable[Mapping[str, Any]]],
        recording: MeasuredRecording | None,
        has_unsaved: Callable[[], bool] | None,
        certificate_end: Callable[[], float | None],
        account: Account,
        loop: str,
    ) -> None:
        self._graph = graph
        self._connections = connections
        self._settings = settings
        self._clients = clients
        self._limits = limits
        self._audit = audit
        self._lag = lag
        self._probes = probes
        self._watchers = watchers
        self._links = links
        self._recording = recording
        self._has_unsaved = has_unsaved
        self._certificate_end = certificate_end
        self._account = account
        self._build = {
            "version": __version__,
            "python": platform.python_version(),
            "loop": loop,
        }

    def respond(self, get: Get) -> Response:
        """Return the response to a request, in the format that it prefers."""
        refusal = self._watchers.refusal(get)
        if refusal is not None:
            return self._watchers.refuse(get, refusal)
        metrics = Exposition(get.headers.get("Accept", ""))
        self._add_all(metrics)
        body, content_type = metrics.render()
        is_zipped = len(body) >= SMALL and accepts(get.headers, "gzip")
        if is_zipped:
            body = gzip.compress(body, 1, mtime=0)
        found = response(http.HTTPStatus.OK, content_type, body)
        if is_zipped:
            found.headers["Content-Encoding"] = "gzip"
        found.headers["Vary"] = "Accept, Accept-Encoding"
        found.headers["Cache-Control"] = "no-store"
        return found

    def _add_all(self, metrics: Exposition) -> None:
        self._add_hub(metrics)
        self._add_clients(metrics)
        self._add_messages(metrics)
        self._add_calls(metrics)
        self._add_links(metrics)
        self._add_held(metrics)
        if self._recording is not None:
            self._add_recording(metrics, self._recording)
        if self._has_unsaved is not None:
            help_ = "1 while the file of the parameters cannot be written."
            metrics.gauge("fibws_parameters_unsaved", help_, +self._has_unsaved())
        if (end := self._certificate_end()) is not None:
            help_ = "End of the hub's certificate, in seconds since 1970."
            metrics.gauge("fibws_certificate_expiry_timestamp_seconds", help_, end)
        add_process(metrics)

    def _add_hub(self, metrics: Exposition) -> None:
        graph = self._graph
        metrics.info("fibws_build_info", "Versions of the hub and of Python.", self._build)
        metrics.gauge("fibws_draining", "1 if the hub is about to end.", +self._probes.is_draining)
        metrics.gauge("fibws_nodes", "Nodes, those of the hub included.", len(graph.nodes))
        metrics.gauge("fibws_topics", "Topics with a publisher or subscriber.", len(graph.topics))
        metrics.gauge("fibws_services", "Services.", len(graph.services))
        metrics.gauge("fibws_actions", "Actions.", len(graph.actions))
        refusals: dict[str, int] = {str(key): n for key, n in self._audit.refusals.items()}
        metrics.counters(
            "fibws_refusals",
            "Refused connections, requests and operations by reason.",
            "reason",
            refusals,
        )
        help_ = "Seconds by which a timer of the event loop was late."
        metrics.histogram("fibws_loop_lag_seconds", help_, self._lag.histogram)

    def _add_clients(self, metrics: Exposition) -> None:
        settings, clients = self._settings, self._clients
        queues = [each.queue for each in self._connections if each.is_open]
        kept = [queue.kept_bytes for queue in queues]
        metrics.gauge("fibws_clients", "Clients that are connected.", len(queues))
        limit = settings.max_connections
        metrics.gauge("fibws_clients_limit", "Clients that may be connected at once.", limit)
        metrics.counter("fibws_connections", "Clients that have connected.", clients.connected)
        paused = sum(queue.paused for queue in queues)
        metrics.gauge("fibws_slow_clients", "Clients whose socket takes no data now.", paused)
        help_ = "Bytes that wait for all clients."
        metrics.gauge("fibws_send_queue_bytes", help_, sum(kept))
        help_ = "Bytes that wait for the client with the most."
        metrics.gauge("fibws_send_queue_bytes_longest", help_, max(kept, default=0))
        help_ = "Limit of the bytes that wait for all clients."
        metrics.gauge("fibws_send_queue_bytes_limit", help_, settings.max_total_queued_bytes)
        waiting = sum(queue.kept_messages for queue in queues)
        metrics.gauge("fibws_send_queue_messages", "Messages that wait for all clients.", waiting)
        help_ = "Bytes kept of messages that came in part."
        metrics.gauge("fibws_incoming_bytes", help_, self._limits.incoming_bytes())
        help_ = "Limit of the bytes kept of messages that came in part."
        metrics.gauge("fibws_incoming_bytes_limit", help_, settings.max_total_incoming_bytes)
        latched = self._graph.latched
        help_ = "Bytes of latched messages and wills."
        metrics.gauge("fibws_latched_bytes", help_, latched.used)
        help_ = "Latched messages that were dropped because there were too many bytes of them."
        metrics.counter("fibws_latched_dropped", help_, latched.dropped)
        if tcp_counters.are_available:
            received, sent = clients.transferred()
            help_ = "Bytes that clients have sent, on their sockets."
            metrics.counter("fibws_received_bytes", help_, received)
            help_ = "Bytes that clients have received, on their sockets."
            metrics.counter("fibws_sent_bytes", help_, sent)

    def _add_messages(self, metrics: Exposition) -> None:
        totals, every = self._graph.messages.by_topic()
        metrics.counter("fibws_messages", "Messages published.", every.messages)
        metrics.counter("fibws_message_bytes", "Bytes of the messages published.", every.bytes)
        help_ = "Messages sent to subscribers, once for each."
        metrics.counter("fibws_sent_messages", help_, every.sent)
        help_ = "Messages dropped for clients that read too slowly."
        metrics.counter("fibws_dropped_messages", help_, self._clients.dropped())
        help_ = "Messages of clients dropped because they were beyond a rate limit."
        metrics.counter("fibws_limited_messages", help_, self._clients.limited())
        help_ = "Messages left out on request, by throttle_rate or credit."
        metrics.counter("fibws_throttled_messages", help_, every.throttled)
        rows = {
            name: (each.messages, each.bytes, each.sent, each.dropped, each.throttled)
            for name, each in totals.items()
        }
        metrics.counter_table(BY_TOPIC, "topic", rows)

    def _add_calls(self, metrics: Exposition) -> None:
        calls = self._graph.calls
        help_ = "Seconds from a service call to its response."
        metrics.histogram("fibws_service_call_seconds", help_, calls.seconds)
        help_ = "Responses to service calls."
        metrics.counters("fibws_service_responses", help_, "service", calls.responses)
        help_ = "Service calls that failed, by the error's code."
        labels = ("service", "code")
        metrics.counters_by_two("fibws_service_failures", help_, labels, calls.failures.items())

    def _add_links(self, metrics: Exposition) -> None:
        """Add the links to other hubs, if there are any."""
        links = list(self._links())
        if not links:
            return
        up = {f"{each['name']} ({each['id'][:6]})": each for each in links if not each["fault"]}
        metrics.gauge("fibws_links", "Links to other hubs that are connected.", len(up))
        help_ = "Links to other hubs that are not connected."
        metrics.gauge("fibws_links_down", help_, len(links) - len(up))
        help_ = "Seconds to another hub and back, by hub."
        times = {name: each["round_trip"] for name, each in up.items()}
        metrics.gauges("fibws_link_round_trip_seconds", help_, "hub", times)
        help_ = "Seconds by which the clock of another hub is ahead, by hub."
        offsets = {name: each["clock_offset"] for name, each in up.items()}
        metrics.gauges("fibws_link_clock_offset_seconds", help_, "hub", offsets)
        keys = ("messages_sent", "messages_received", "bytes_sent", "bytes_received")
        rows = {
            name: [each[key] for key in (*keys, "dropped", "lost")] for name, each in up.items()
        }
        metrics.counter_table(BY_HUB, "hub", rows)

    def _add_held(self, metrics: Exposition) -> None:
        account = self._account
        help_ = "Bytes that the hub holds, by what for."
        held: dict[str, float] = dict(account.held())
        metrics.gauges("fibws_held_bytes", help_, "part", held)
        help_ = "Limit of the bytes that the hub may hold."
        metrics.gauge("fibws_held_bytes_limit", help_, account.bound.limit)

    def _add_recording(self, metrics: Exposition, recording: MeasuredRecording) -> None:
        metrics.gauge("fibws_recording", "1 while topics are recorded.", +recording.is_recording)
        help_ = "1 while nothing is recorded because of a fault, such as a full disk."
        metrics.gauge("fibws_recording_failed", help_, +bool(recording.fault))
        messages, size, dropped = recording.totals()
        metrics.counter("fibws_recorded_messages", "Messages that were recorded.", messages)
        metrics.counter("fibws_recorded_bytes", "Bytes of the recorded bags.", size)
        help_ = "Messages that were not recorded, as the disk was too slow or full."
        metrics.counter("fibws_recording_dropped_messages", help_, dropped)


def add_process(metrics: Exposition) -> None:
    """Add CPU time, memory and open files, under the names of Prometheus's client libraries."""
    times = os.times()
    seconds = times.user + times.system
    metrics.counter("process_cpu_seconds", "CPU time in user and kernel mode.", seconds)
    metrics.gauge("process_start_time_seconds", "Start, in seconds since 1970.", _STARTED)
    if sys.platform == "win32":
        return
    import resource

    try:
        pages = (_PROC / "statm").read_text("ascii").split()
        files = len(os.listdir(_PROC / "fd"))
    except OSError:  # Only Linux has them.
        return
    size = os.sysconf("SC_PAGE_SIZE")
    metrics.gauge("process_virtual_memory_bytes", "Virtual memory.", int(pages[0]) * size)
    metrics.gauge("process_resident_memory_bytes", "Resident memory.", int(pages[1]) * size)
    metrics.gauge("process_open_fds", "Open file descriptors.", files)
    most, _ = resource.getrlimit(resource.RLIMIT_NOFILE)
    if most != resource.RLIM_INFINITY:
        metrics.gauge("process_max_fds", "Limit of open file descriptors.", most)
