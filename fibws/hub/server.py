"""The hub as a server: one port, all its connections, one timer."""

from __future__ import annotations

import asyncio
import ipaddress
import logging
import os
import secrets
import socket
import time
import uuid
from collections import deque
from collections.abc import Callable, Iterable
from contextlib import AsyncExitStack, ExitStack, suppress
from functools import cache, partial
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any, Self, TypeAlias

from fibws import __version__
from fibws.access.rights import Principal
from fibws.errors import BagError, FibwsError, InterfaceError, SettingError
from fibws.files import check_writable
from fibws.hub.access.authentication import Authentication
from fibws.hub.access.policy import AccessPolicy
from fibws.hub.announcement import machine_addresses
from fibws.hub.delivery.deflate import MOST_HELD, Deflater
from fibws.hub.delivery.send_queue import CHUNK, MOST_UNWRITTEN, Flusher
from fibws.hub.errors import NotAllowed
from fibws.hub.federation import link
from fibws.hub.federation.connections import Join, LinkEndpoint
from fibws.hub.federation.federation import Federation
from fibws.hub.federation.records import HubInfo
from fibws.hub.foxglove import SUBPROTOCOLS as FOXGLOVE_SUBPROTOCOLS
from fibws.hub.graph.graph import Graph
from fibws.hub.graph.policy import Policy
from fibws.hub.graph.topic import SinkReport
from fibws.hub.held_memory import count_held, memory_limit
from fibws.hub.http.login import LoginRoutes
from fibws.hub.http.proxies import TrustedProxies
from fibws.hub.http.recording_downloads import RecordingRoute
from fibws.hub.http.requests import HttpRequests, built_files
from fibws.hub.http.robot_assets import MOST_UNSENT, AssetRoute, RobotAssets
from fibws.hub.listening import listen, local_url, reached_at
from fibws.hub.log.audit import Audit, ClientIdentity
from fibws.hub.memory.account import Account
from fibws.hub.memory.byte_room import ByteRoom
from fibws.hub.monitoring.loop_lag import LoopLag
from fibws.hub.monitoring.metrics import ClientTotals, Metrics
from fibws.hub.monitoring.probes import Probes, Watchers
from fibws.hub.rosapi.clients import ListedClient
from fibws.hub.rosapi.nodes import RESERVED_NODES, OwnNodes
from fibws.hub.rosbridge.session import Rosbridge
from fibws.hub.settings import Settings
from fibws.hub.tls.certificate import ServerTls
from fibws.hub.tls.self_signed import ensure_certificate
from fibws.hub.websocket.connection import Connection, SharedParts
from fibws.hub.websocket.endpoint import Endpoints, Work
from fibws.hub.websocket.shared_limits import SharedLimits
from fibws.hub.websocket.turns import Turns
from fibws.hub.worker_threads import WorkerThreads
from fibws.interfaces import Interfaces
from fibws.protocol.serialized import SUBPROTOCOL
from fibws.protocol.websocket import KILLED, RESTART, SHUTDOWN

if TYPE_CHECKING:
    from fibws.hub.federation.zenoh_backplane import ZenohBackplane
    from fibws.hub.foxglove.session import Foxglove
    from fibws.hub.recording import Recording
    from fibws.hub.ros1.server import Ros1Server
    from fibws.hub.ros2.server import Ros2

logger = logging.getLogger("fibws.hub")

ExceptionHandler: TypeAlias = Callable[[asyncio.AbstractEventLoop, dict[str, Any]], object]

RECORDING_TIMEOUT = 10.0
"""On shutdown, the recorder is given up after so many seconds without a written message."""
SWEEP_INTERVAL = 1.0
DRAIN_RATE = 100.0
"""Clients that are closed in a second before the hub ends, if there is time enough."""
DRAIN_INTERVAL = 0.05
"""Seconds between two groups of clients that are closed."""
BACKLOG = 1024
"""Connections that may wait to be accepted: a thousand may come at once."""


class HubServer:
    """A hub with all its parts, which `fibws.Hub` does not show.

    Args:
        settings: the port and the limits.
        policy: decides what nodes may do; None is for the policy of the settings: everything is
            allowed, or what the tokens' rights allow.

    Raises:
        HubError: on entering, as `fibws.Hub`.
        SettingError: a folder of definitions is not there.
    """

    _asset_room: ByteRoom
    _account: Account
    """Counts what is held for clients."""
    _has_unsaved: Callable[[], bool] | None = None
    """Returns whether the parameters cannot be written, if they are kept."""

    def __init__(self, settings: Settings | None = None, policy: Policy | None = None) -> None:
        self.settings = settings or Settings()
        self._authentication: Authentication | None = None
        if self.settings.has_authentication:
            self._authentication = Authentication(self.settings, time.time)
            policy = policy or AccessPolicy(self._authentication.known())
        self.port = self.settings.port
        """The port it listens on; once entered, also when the system chose it."""
        self.graph = Graph(
            _interfaces(self.settings),
            time.time_ns,
            strict_types=self.settings.strict_types,
            max_parameter_bytes=self.settings.max_parameter_bytes,
            policy=policy,
            ticks=time.perf_counter_ns,
        )
        self.assets = RobotAssets(self.graph, os.environ)
        """The files of robots whose descriptions are loaded."""
        self.endpoints: Endpoints
        """The protocols that clients may speak, once entered."""
        self.federation: Federation
        """The other hubs, once entered."""
        self._joins: list[Join] = []
        self._zenoh: ZenohBackplane | None = None
        self.audit: Audit
        """Records logins, refusals and changes, once entered."""
        self._connections: set[Connection] = set()
        self._clients = ClientTotals(self._connections)
        self._server: asyncio.Server
        self._tls: ServerTls | None = None
        self._limits: SharedLimits
        self._own: OwnNodes
        self._shared: SharedParts
        self._sweeper: asyncio.TimerHandle
        self._threads: WorkerThreads
        self._readers: WorkerThreads
        """Read files: large ones must not delay the work of `_threads`."""
        self._requests: HttpRequests
        self._probes: Probes
        self._lag: LoopLag
        self.ros1: Ros1Server | None = None
        """The master for ROS 1 nodes, once entered, if the settings want one."""
        self.ros2: Ros2 | None = None
        """The ROS 2 nodes, once entered, if the settings want some."""
        self.recording: Recording | None = None
        """The recorder of all topics, once entered, if the settings want one."""
        self.stop_requested: Callable[[str], object] = lambda reason: None
        """Called, with a reason, when a ROS 1 program of this machine asks the master to end."""
        self._started = 0.0
        self._handle_exception: ExceptionHandler | None = None
        """The event loop's exception handler before this hub's."""
        self._end = AsyncExitStack()
        """What ends the parts that have been started, in reverse order."""
        self._ending = asyncio.Lock()
        self._closing = False
        self._empty = _set_event()
        self._vacant = _set_event()
        """Set while no client is connected."""

    async def start(self) -> Self:
        """Start as `fibws.Hub.start` says."""
        try:
            await self._start()
        except BaseException:
            await self.close()
            raise
        return self

    async def __aenter__(self) -> Self:
        return await self.start()

    async def _start(self) -> None:
        """Start one part after the other; how each is ended goes to `_end`, which `close` runs."""
        loop = asyncio.get_running_loop()
        end = self._end
        self._handle_exception = loop.get_exception_handler()
        loop.set_exception_handler(self._on_exception)
        end.callback(self._restore_exception_handler)
        self._tls = _tls(self.settings)
        self._server = server = await listen(
            self.settings, self._tls, lambda: Connection(self._shared)
        )
        end.push_async_callback(self._wait_until_closed, server)
        end.callback(server.close)  # Again, if the start fails: see the last step.
        self._threads = WorkerThreads(loop)
        end.push_async_callback(self._threads.close)
        self._readers = WorkerThreads(loop, most=1)
        end.push_async_callback(self._readers.close)
        self._enter_own_nodes(server)
        self._federate(await self._load_parameters())
        self._prepare_recording()
        await self._join_ros1()
        self._answer_requests()
        end.push_async_callback(self._close_connections)
        await self._join_ros2()
        await self._join_zenoh()
        for join in self._joins:
            end.push_async_callback(join.close)
            join.start()
        self._lag.start()
        end.callback(self._lag.stop)
        self._sweeper = loop.call_later(SWEEP_INTERVAL, self._sweep)
        end.callback(lambda: self._sweeper.cancel())
        self._started = time.monotonic()
        self._warn_if_public()
        end.callback(server.close)
        await server.start_serving()
        for listening in server.sockets:
            with listening.dup() as same:
                same.listen(BACKLOG)

    def _enter_own_nodes(self, server: asyncio.Server) -> None:
        loop = asyncio.get_running_loop()
        address, self.port = server.sockets[0].getsockname()[:2]
        self.audit = Audit(loop.time, self._identify)
        if self._tls is not None:
            self._tls.on_refused = partial(self.audit.refused, "authentication")
        self._account = account = Account(memory_limit(self.settings), loop.call_soon)
        self._limits = SharedLimits(self.settings, self._connections, account, self.audit)
        self._end.callback(self._limits.report_refusals)
        self.graph.rights.on_refused = self._refused
        self._own = OwnNodes(
            self.graph,
            loop,
            self.audit,
            host=reached_at(self.settings.host),
            port=self.port,
            address=address,
            run_id=str(uuid.uuid1()),
            hubs=lambda caller: self.federation.report(caller, self._broken_links()),
        )
        self._end.callback(self._own.close)

    def _compress(self, loop: asyncio.AbstractEventLoop) -> Deflater:
        """Return what compresses texts: in one thread, so that the event loop has a CPU."""
        workers = WorkerThreads(loop, most=1)
        self._end.push_async_callback(workers.close)
        most = min(MOST_HELD, self._account.reserved)
        deflater = Deflater(workers, time.perf_counter, most)
        self._account.add_fixed("queues", lambda: deflater.held, 0)
        return deflater

    def _answer_requests(self) -> None:
        """Prepare for clients and HTTP requests, which come once the server serves."""
        loop = asyncio.get_running_loop()
        deflater = self._compress(loop)
        report = self._own.refusals.report
        rosbridge = Rosbridge(self.graph, loop, self.settings, self._threads, deflater, report)
        self.endpoints = endpoints = Endpoints(rosbridge.open)
        endpoints.add(partial(rosbridge.open, serialized=True), subprotocol=SUBPROTOCOL)
        endpoints.add(
            lambda opening: LinkEndpoint(opening, self.federation, self.settings),
            subprotocol=link.SUBPROTOCOL,
        )
        self._speak_foxglove()
        self._requests = requests = HttpRequests(
            self.settings, built_files(), RESERVED_NODES, partial(_refuse_origin, self.audit)
        )
        self._lag = LoopLag(loop, time.monotonic)
        watchers = Watchers(self.settings, self._authentication, self.audit, requests.host_refusal)
        has_authentication = self._authentication is not None
        self._probes = Probes(
            self._lag, watchers, self.health, shows_version=not has_authentication
        )
        self._probes.add_to(requests)
        refuse = partial(_refuse_login, self.audit)
        LoginRoutes(requests, self._authentication, refuse, self._logged_out)
        self._asset_room = room = ByteRoom(min(MOST_UNSENT, self._account.reserved))
        AssetRoute(requests, self.assets, self._authentication, self._readers, room, self.audit)
        if self.recording is not None:
            RecordingRoute(
                requests, self.recording, self._authentication, self._readers, room, self.audit
            )
        count_held(
            self._account,
            self.graph,
            federation=self.federation,
            ros1=self.ros1,
            ros2=lambda: self.ros2,
            recording=self.recording,
            files=room,
            find_client=self._own.clients.find,
        )
        metrics = Metrics(
            self.graph,
            self._connections,
            settings=self.settings,
            clients=self._clients,
            limits=self._limits,
            audit=self.audit,
            lag=self._lag,
            probes=self._probes,
            watchers=watchers,
            links=lambda: [*self.federation.links(), *self._broken_links()],
            recording=self.recording,
            has_unsaved=self._has_unsaved,
            certificate_end=lambda: self._tls.end if self._tls is not None else None,
            account=self._account,
            loop=type(loop).__module__.partition(".")[0],
        )
        requests.add_route("/metrics", metrics.respond)
        flusher = Flusher(
            loop.call_soon,
            allowance=self._account.allowance,
            max_unwritten=_max_unwritten(self.settings),
        )
        turns = Turns(loop.call_later, flusher.flush)
        self.graph.finish = turns.finish
        self._shared = SharedParts(
            settings=self.settings,
            http=requests,
            proxies=TrustedProxies(self.settings.trusted_proxy),
            endpoints=endpoints,
            loop=loop,
            flusher=flusher,
            deflater=deflater,
            turns=turns,
            limits=self._limits,
            observer=_Reports(self),
            authentication=self._authentication,
            audit=self.audit,
            is_simulated=lambda: self.graph.clock.simulated is not None,
        )

    async def __aexit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        await self.close()

    async def _join_ros1(self) -> None:
        """Let ROS 1 nodes join, if the settings want that."""
        if self.settings.ros1 is None:
            return
        from fibws.hub.ros1.server import Ros1Server  # Most hubs need none of it.

        self.ros1 = Ros1Server(
            self.graph,
            self.settings,
            self.audit,
            limits=self._limits,
            principal=self._network_principal("ros1"),
            kill=self._kill,
            shut_down=lambda reason: self.stop_requested(reason),
        )
        self._end.push_async_callback(self.ros1.close)
        await self.ros1.start()

    def _prepare_recording(self) -> None:
        """Record all topics, if the settings want that."""
        folder = self.settings.record
        if folder is None:
            return
        from fibws.hub.recording import Recording, options  # Most hubs need none of it.

        try:
            check_writable(folder)
            options(self.settings, 0).check()
        except OSError as error:
            fault = error.strerror or str(error)
            raise SettingError(f"--record: cannot write to {folder}: {fault}") from None
        except BagError as error:
            raise SettingError(f"--record: {error}") from None
        loop = asyncio.get_running_loop()
        self.recording = Recording(
            self.graph, self.settings, self.audit, loop, self._account.reserved
        )
        self._end.push_async_callback(self._end_recording, self.recording)
        if self.settings.record_at_start:
            self.recording.start()

    async def _end_recording(self, recording: Recording) -> None:
        """Wait for the end of the file, unless the disk hangs."""
        complete = asyncio.Event()
        recording.close(complete.set)
        before = -1
        try:
            while not complete.is_set():
                written = recording.totals().messages
                if written == before:
                    logger.error(
                        "The recording is not complete: the disk has not answered for %g s.",
                        RECORDING_TIMEOUT,
                    )
                    break
                before = written
                with suppress(TimeoutError):
                    await asyncio.wait_for(complete.wait(), RECORDING_TIMEOUT)
        finally:
            recording.remove()

    async def _load_parameters(self) -> dict[str, int]:
        """Set the parameters of a file, if the settings name one, and keep it up to date.

        Returns:
            When each was set at the latest, in nanoseconds since 1970.
        """
        path = self.settings.params
        if path is None:
            return {}
        from fibws.hub.parameter_file import ParameterFile  # Most hubs have none.

        kept = ParameterFile(
            path, self.graph.parameters, self._own.parameters, is_kept=self.settings.keep_params
        )
        if self.settings.keep_params:
            self._end.enter_context(kept.file.reserved())
        found = await kept.load()
        if self.settings.keep_params:
            self._has_unsaved = lambda: kept.file.has_failed
            kept.watch()
            self._end.push_async_callback(kept.file.close)
        return found

    def _federate(self, loaded: dict[str, int]) -> None:
        """Let other hubs join this one, and prepare to join others."""
        name = self.settings.hub_name or socket.gethostname().partition(".")[0]
        hub = HubInfo(id=secrets.token_hex(8), name=name, version=__version__)
        loop = asyncio.get_running_loop()
        self.federation = Federation(self.graph, hub, loop, self.settings, self.audit, loaded)
        self._end.callback(self.federation.close)
        principal = partial(self._network_principal, "join")
        try:
            self._joins = [
                Join(address, self.federation, self.settings, principal)
                for address in dict.fromkeys(self.settings.join)
            ]
        except FibwsError as error:
            raise SettingError(f"--join: {error}") from None

    def _speak_foxglove(self) -> None:
        """Let Foxglove and Lichtblick connect by their own protocol, which the first one loads."""
        loop = asyncio.get_running_loop()

        @cache
        def foxglove() -> Foxglove:
            from fibws.hub.foxglove.session import Foxglove  # It takes a while to load.

            return Foxglove(
                self.graph,
                loop,
                self.settings,
                self.audit,
                name=f"fibws {__version__}",
                assets=self.assets,
                readers=self._readers,
                asset_room=self._asset_room,
                report=self._own.refusals.report,
            )

        def add(subprotocol: str) -> None:
            self.endpoints.add(
                lambda opening: foxglove().open(opening, subprotocol), subprotocol=subprotocol
            )

        for each in FOXGLOVE_SUBPROTOCOLS:
            add(each)

    async def _join_zenoh(self) -> None:
        """Join the other hubs on a zenoh network, if the settings want that."""
        settings = self.settings
        if not (settings.zenoh or settings.zenoh_listen):
            return
        from fibws.hub.federation.zenoh_backplane import ZenohBackplane  # Most hubs need none.

        self._zenoh = ZenohBackplane(
            self.federation,
            self.federation.hub,
            asyncio.get_running_loop(),
            principal=self._network_principal("zenoh"),
            domain=settings.domain,
            listen=settings.zenoh_listen,
            connect=settings.zenoh,
            config=settings.zenoh_config,
            max_queued=settings.max_queued_bytes,
        )
        self._end.push_async_callback(self._zenoh.close)
        await self._zenoh.open()

    async def _join_ros2(self) -> None:
        """Let ROS 2 nodes join, if the settings want that."""
        if not (self.settings.ros2 or self.settings.ros2_connect):
            return
        from fibws.hub.ros2.server import Ros2  # Most hubs need none of it.

        self.ros2 = Ros2(self.graph, self.settings, self._network_principal("ros2"))
        self._end.push_async_callback(self.ros2.close)
        await self.ros2.start()

    def _broken_links(self) -> list[dict[str, Any]]:
        """Return the links that should be there and are not, as fibws_msgs/HubLink."""
        found = [join.report() for join in self._joins if join.fault]
        if self._zenoh is not None and not self._zenoh.peers:
            found.append(self._zenoh.report())
        return found

    def _network_principal(self, name: str) -> Principal | None:
        """Return the principal of what joins without a token; see `token_file.NETWORKS`."""
        return self._authentication.network(name) if self._authentication is not None else None

    def _kill(self, node: str, reason: str) -> bool:
        """End a client, as a ROS 1 program has asked for; return whether it is one."""
        client = self._own.clients.find(node)
        if client is None:
            return False
        self.audit.node_killed(node, node=reason)
        client.close(KILLED)
        return True

    @property
    def url(self) -> str:
        """The URL by which nodes on this machine reach it."""
        return local_url(self.settings, self.port, self._tls)

    async def drain(self, seconds: float) -> None:
        """Close all clients little by little, as `fibws.Hub.drain` says.

        About `DRAIN_RATE` clients are closed in a second, more if that takes too long: a thousand
        that connect again at once would be a burden to the other hub.
        """
        self._probes.is_draining = True
        self._requests.refuse_websockets("The hub is about to end; try again later")
        if not self._limits.clients:
            return
        nodes = [client for client, _ in self._own.clients]  # The oldest first.
        others = {each for each in self._connections if each.is_open}.difference(nodes)
        waiting = deque[ListedClient]([*nodes, *others])
        pieces = max(1, int(min(seconds, len(waiting) / DRAIN_RATE) / DRAIN_INTERVAL))
        size = -(-len(waiting) // pieces)
        logger.info("Draining: closing %d clients.", len(waiting), extra={"event": "draining"})
        while waiting:
            for _ in range(min(size, len(waiting))):
                waiting.popleft().close(RESTART)
            if waiting:
                await asyncio.sleep(DRAIN_INTERVAL)
        with suppress(TimeoutError):
            await asyncio.wait_for(self._vacant.wait(), self.settings.close_timeout)

    async def close(self) -> None:
        """Close all connections and stop, as `fibws.Hub.close` says.

        Every step runs even if one raises, or this is cancelled.
        """
        self._closing = True
        async with self._ending:
            await self._end.aclose()

    async def _close_connections(self) -> None:
        """Close the clients' connections, with a reason; abort those that remain."""
        for connection in list(self._connections):
            connection.close(SHUTDOWN)
        try:
            with suppress(TimeoutError):
                await asyncio.wait_for(self._empty.wait(), self.settings.close_timeout)
        finally:
            for connection in list(self._connections):
                connection.abort()
        await self._empty.wait()
        self._shared.turns.close()

    async def _wait_until_closed(self, server: asyncio.Server) -> None:
        with suppress(TimeoutError):  # Clients may be in the middle of their TLS handshake.
            await asyncio.wait_for(server.wait_closed(), self.settings.close_timeout)

    def _restore_exception_handler(self) -> None:
        loop = asyncio.get_running_loop()
        if loop.get_exception_handler() == self._on_exception:
            loop.set_exception_handler(self._handle_exception)

    def reload(self, done: Callable[[list[str]], object] = lambda changes: None) -> list[str]:
        """Read the files again, as `fibws.Hub.reload` says, which has the same arguments."""
        if self.settings.self_signed:
            ensure_certificate(machine_addresses())
        use_certificate = self._tls.read() if self._tls is not None else list
        changes: list[str] = []
        if self._authentication is not None:
            changes = self._authentication.reload()
            if self.ros1 is not None:
                self.ros1.set_principal(self._authentication.network("ros1"))
            if self.ros2 is not None:
                self.ros2.set_principal(self._authentication.network("ros2"))
            for join in self._joins:
                join.check_rights()
            if self._zenoh is not None:
                self._zenoh.set_principal(self._authentication.network("zenoh"))
            if isinstance(self.graph.policy, AccessPolicy):
                self.graph.policy.keep_names(self._authentication.known())
        changes += use_certificate()

        def checked(closed: int) -> None:
            text = f"{closed} client{'s' if closed > 1 else ''} closed"
            done([*changes, *([text] if closed else ())])

        everyone = self._connections if self._authentication is not None else ()
        self._check_logins(everyone, "after a reload", checked)
        return changes

    @property
    def _files(self) -> list[Path]:
        """The files that `reload` reads."""
        own = (self.settings.tokens, self.settings.jwt_key)
        return [*filter(None, own), *(self._tls.files if self._tls is not None else ())]

    def _logged_out(self) -> None:
        ended = [each for each in self._connections if each.is_logged_out]
        self._check_logins(ended, "after a log-out")

    def _check_logins(
        self,
        connections: Iterable[Connection],
        when: str,
        done: Callable[[int], object] = lambda closed: None,
    ) -> None:
        """Check the logins and rights of clients in turns; ``done`` takes how many are closed."""
        self._shared.turns.finish(_login_checks(list(connections), when, done))

    def _status(self) -> str:
        """Return one line about the hub, for the service manager."""
        state = "draining, " if self._probes.is_draining else ""
        counts = f"{state}{self._limits.clients} clients, {len(self.graph.topics)} topics"
        return "; ".join([counts, *self._warnings()])

    def _warnings(self) -> list[str]:
        """Return the faults that an operator should mend, although clients can use the hub."""
        found = []
        if self.recording is not None and (fault := self.recording.fault):
            found.append(f"nothing is recorded: {fault}")
        if self._has_unsaved is not None and self._has_unsaved():
            found.append("the parameters cannot be written")
        if count := len(self._broken_links()):
            found.append(f"other hubs that are not reached: {count}")
        return found

    def health(self) -> dict[str, object]:
        """Return what ``/healthz`` shows: counts, and the clients that read too slowly."""
        open_ = [each for each in self._connections if each.endpoint is not None]
        return {
            "version": __version__,
            "uptime_seconds": round(time.monotonic() - self._started, 3),
            "clients": len(open_),
            "max_clients": self.settings.max_connections,
            "refused": self._limits.refused,
            "queued_bytes": self._limits.queued_bytes(),
            "max_queued_bytes": self.settings.max_total_queued_bytes,
            "held_bytes": sum(self._account.held().values()),
            "max_held_bytes": self._account.bound.limit,
            "incoming_bytes": self._limits.incoming_bytes(),
            "max_incoming_bytes": self.settings.max_total_incoming_bytes,
            "topics": len(self.graph.topics),
            "ros1_port": self.ros1.port if self.ros1 is not None else None,
            "links": len(self.federation.peers),
            "links_down": len(self._broken_links()),
            "ros1_nodes": len(self.ros1.nodes.by_name) if self.ros1 is not None else 0,
            "dropped": self._clients.dropped(),
            "warnings": self._warnings(),
            "slow_clients": [
                {
                    "node": each.name,
                    "address": each.peer,
                    "kept_bytes": each.queue.kept_bytes,
                    "dropped": each.queue.dropped,
                    "dropped_by_topic": self._by_topic(each.name, lambda report: report.dropped),
                    "throttled_by_topic": self._by_topic(
                        each.name, lambda report: report.throttled
                    ),
                }
                for each in open_
                if each.queue.dropped
            ],
        }

    def _by_topic(self, node: str, count: Callable[[SinkReport], int]) -> dict[str, int]:
        """Return the sums of one node's subscriptions by the topics' global names."""
        known = self.graph.nodes.get(node)
        topics = map(self.graph.topics.get, known.subscribing()) if known is not None else ()
        counts = {
            topic.name: sum(count(sink.report()) for sink in topic.sinks_of(node))
            for topic in topics
            if topic is not None
        }
        return {name: number for name, number in counts.items() if number}

    def _refused(self, error: NotAllowed) -> None:
        self.audit.refused("right", str(error), node=error.node)

    def _identify(self, node: str) -> ClientIdentity:
        """Return who a connected node is, for the audit events."""
        client = self._own.clients.find(node)
        if not isinstance(client, Connection):
            return ClientIdentity()
        principal = client.principal.title if client.principal is not None else ""
        return ClientIdentity(principal, client.address)

    def _warn_if_public(self) -> None:
        address = self._server.sockets[0].getsockname()[0]
        if self._authentication is None and not ipaddress.ip_address(address).is_loopback:
            logger.warning(
                "Other machines can reach this hub at %s, port %d; no authentication is enabled.",
                address,
                self.port,
            )

    def _count_out(self, connection: Connection) -> None:
        self._connections.discard(connection)
        if connection.endpoint is not None:
            self._limits.clients -= 1
            if not self._limits.clients:
                self._vacant.set()
        if not self._connections:
            self._empty.set()

    def _sweep(self) -> None:
        loop = asyncio.get_running_loop()
        now = loop.time()
        late = max(0.0, now - self._sweeper.when())
        self._sweeper = loop.call_later(SWEEP_INTERVAL, self._sweep)
        for connection in list(self._connections):
            try:
                connection.sweep(now, late)
            except Exception:
                # A fault at one client must not leave the others unwatched.
                logger.exception("%s: the sweep failed.", connection.name)
        self._limits.sweep(self._shared.turns.clock())

    def _on_exception(self, loop: asyncio.AbstractEventLoop, context: dict[str, Any]) -> None:
        """Handle an exception in the event loop.

        asyncio reports each accept() that fails, a thousand times a second while the limit of open
        files is reached, and tries again after a second.
        """
        if "socket.accept()" in context["message"]:
            if self._limits.accept_failed(context.get("exception")):
                return
        if self._handle_exception is not None:
            self._handle_exception(loop, context)
        else:
            loop.default_exception_handler(context)


class _Reports:
    """The reports of connections to their hub."""

    def __init__(self, hub: HubServer) -> None:
        self._hub = hub

    def opened(self, connection: Connection) -> None:
        """Count a socket that has been opened."""
        self._hub._connections.add(connection)
        self._hub._empty.clear()
        if self._hub._closing:
            connection.abort()

    def connected(self, connection: Connection) -> None:
        """Count a client that has finished its handshake."""
        self._hub._clients.connected += 1
        self._hub._limits.clients += 1
        self._hub._vacant.clear()

    def entered(self, connection: Connection) -> None:
        """Add a client that is a node now."""
        self._hub._own.connected(connection)

    def ponged(self, connection: Connection, data: bytes) -> None:
        """Called when a client has sent a pong."""
        self._hub._own.ponged(connection, data)

    def lost(self, connection: Connection) -> None:
        """Remove a connection that is closed."""
        with ExitStack() as stack:  # Whatever fails of this, the rest is done.
            stack.callback(self._hub._count_out, connection)
            stack.callback(self._hub._own.disconnected, connection)
            stack.callback(self._hub._clients.left, connection)


def _login_checks(connections: list[Connection], when: str, done: Callable[[int], object]) -> Work:
    """Check the login and rights of a client with each step."""
    closed = 0
    for connection in connections:
        try:
            closed += not connection.check_login(when)
        except Exception:
            # A fault at one client must not leave the others their old rights, nor itself.
            logger.exception("%s: its login cannot be checked.", connection.name)
            connection.abort()
            closed += 1
        yield
    done(closed)


def _tls(settings: Settings) -> ServerTls | None:
    if settings.self_signed:
        file = ensure_certificate(machine_addresses()).certificate
        return ServerTls(file, file, settings.client_ca)
    if settings.cert is None or settings.key is None:
        return None
    return ServerTls(settings.cert, settings.key, settings.client_ca)


def _set_event() -> asyncio.Event:
    event = asyncio.Event()
    event.set()
    return event


def _interfaces(settings: Settings) -> Interfaces:
    try:
        return Interfaces(settings.interfaces)
    except InterfaceError as error:
        raise SettingError(f"--interfaces: {error}") from None


def _refuse_login(audit: Audit, reason: str, address: str) -> None:
    audit.refused("authentication", reason, ip=address)


def _refuse_origin(audit: Audit, reason: str, address: str) -> None:
    audit.refused("origin", reason, ip=address)


def _max_unwritten(settings: Settings) -> int:
    """Return the bytes that may be written to one client at once before it can count as slow."""
    return max(CHUNK, min(MOST_UNWRITTEN, settings.max_queued_bytes))
