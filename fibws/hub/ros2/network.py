"""A zenoh network with ROS 2 nodes: what this hub declares there, and what arrives.

All calls are made in threads (`zenoh_session`); results arrive in the event loop. Messages are
converted in these threads, too: in the one that sends, and in the one in which zenoh delivers, so
that large ones do not delay the event loop.
"""

from __future__ import annotations

import asyncio
import logging
import time
from collections.abc import Callable, Mapping
from functools import partial
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fibws.errors import FibwsError, Ros2Error, SettingError
from fibws.hub.log.text import is_power_of_ten, printable
from fibws.hub.ros2.key_layout import Attachment, tokens_key
from fibws.hub.zenoh_session import (
    LEASE,
    QUEUES,
    Inbox,
    Receivers,
    ZenohCalls,
    ZenohLane,
    ZenohLanes,
    close_session,
    direct,
    lossless,
    lossy,
    open_session,
)

if TYPE_CHECKING:
    import zenoh

logger = logging.getLogger("fibws.hub")

_TX = "transport/link/tx"
_CLOSE = f"{_TX}/queue/congestion_control/block/wait_before_close"
SESSION: Mapping[str, Any] = {
    **QUEUES,
    "transport/unicast/open_timeout": 60_000,
    "transport/unicast/accept_timeout": 60_000,
    "transport/unicast/accept_pending": 10_000,
    "transport/unicast/max_sessions": 10_000,
    f"{_TX}/lease": 60_000,
    f"{_TX}/keep_alive": 2,
    _CLOSE: 60_000_000,
    "timestamping/enabled": True,
}
"""rmw_zenoh's settings of a node's session, for many nodes that start together: milliseconds, and
the microseconds after which a receiver that does not read is disconnected."""
ROUTER: Mapping[str, Any] = {
    **SESSION,
    _CLOSE: 5_000_000,
    "routing/router/peers_failover_brokering": False,
}
"""rmw_zenoh's settings of its router."""
UNREACHED, CHECK_AGAIN = 2.0, 0.02
"""Seconds for which a call waits for the way to its server, and between two looks."""
HEARTBEAT = 0.5
"""Seconds after a latched message in which subscribers notice that they have missed it."""


class Declared:
    """Something that was declared on the network.

    Args:
        make: declares it, in the thread for control; it returns what has ``undeclare``.
    """

    def __init__(self, control: ZenohCalls, make: Callable[[], Any]) -> None:
        self.found: Any = None
        """What was declared, for the thread for control; None if that failed, or it is closed."""
        self._control = control
        control.call(partial(self._declare, make))

    def _declare(self, make: Callable[[], Any]) -> None:
        self.found = make()

    def close(self) -> None:
        """Undeclare it."""
        self._control.call(self._undeclare)

    def _undeclare(self) -> None:
        found, self.found = self.found, None
        if found is not None:
            found.undeclare()


class DeclaredPublisher(Declared):
    """A publisher that was declared, with its messages that wait.

    Args:
        report: called, in a thread, with the error of a message that cannot be converted.
    """

    def __init__(
        self,
        control: ZenohCalls,
        lanes: ZenohLanes,
        make: Callable[[], Any],
        report: Callable[[str], object],
    ) -> None:
        self._lanes = lanes
        self._lane = ZenohLane()
        self._report = report
        super().__init__(control, make)

    def send(self, size: int, limit: int, make: Callable[[], tuple[bytes, bytes]]) -> None:
        """Send a message.

        Args:
            size: its bytes, more or less.
            limit: most messages that wait; the oldest are dropped.
            make: returns the message and its attachment; called in a thread.
        """
        self._lanes.send(self._lane, partial(self._send, make), size, max(1, limit))

    def _send(self, make: Callable[[], tuple[bytes, bytes]]) -> None:
        try:
            data, attachment = make()
        except FibwsError as error:
            self._report(str(error))
            return
        found = self.found
        if found is not None:
            found.put(data, attachment=attachment)

    def _declare(self, make: Callable[[], Any]) -> None:
        try:
            super()._declare(make)
        finally:
            self._lanes.open(self._lane)

    def _undeclare(self) -> None:
        self._lanes.drain(self._lane)
        super()._undeclare()


class _Publisher:
    """A publisher of zenoh's with its matching listener.

    Args:
        matched: called, in a thread, once there is a subscriber.
    """

    def __init__(self, publisher: Any, matched: Callable[[], object]) -> None:
        self._publisher = publisher
        self.put = publisher.put
        self._listener = publisher.declare_matching_listener(
            direct(lambda status: matched() if status.matching else None)
        )
        if publisher.matching_status.matching:
            matched()

    def undeclare(self) -> None:
        """Undeclare both."""
        self._listener.undeclare()
        self._publisher.undeclare()


class Ros2Network:
    """A session on a zenoh network.

    Args:
        listen: endpoints to listen on, such as ``tcp/0.0.0.0:7447``.
        connect: endpoints to connect to.
        config: a file of zenoh's own settings.
        domain: ROS_DOMAIN_ID.
        max_queued: most bytes of messages that wait for the network, and for the event loop.
        max_message_size: most bytes of a message, request or response that arrives.
        token: called with each token that appears or disappears, and whether it appears.
    """

    def __init__(
        self,
        loop: asyncio.AbstractEventLoop,
        *,
        listen: tuple[str, ...],
        connect: tuple[str, ...],
        config: Path | None,
        domain: int,
        max_queued: int,
        max_message_size: int,
        token: Callable[[str, bool], object],
    ) -> None:
        self.session_id = ""
        self.domain = domain
        self.dropped = 0
        self.faults = 0
        self._loop = loop
        self._listen = listen
        self._connect = connect
        self._config = config
        self._token = token
        self._max_message_size = max_message_size
        self._session: zenoh.Session
        self.inbox = Inbox(loop, max_queued)
        self._control = ZenohCalls("ros2-control")
        self._receivers = Receivers("ros2-receivers")
        """For requests, by client of a service here, and responses, by client there."""
        self._lanes = ZenohLanes("ros2", max_queued, self._count_dropped)
        self._tokens: Declared
        self._is_open = False

    @property
    def waiting_bytes(self) -> int:
        """Bytes of messages that wait for the network, and from it; both are bounded."""
        return self._lanes.bytes + self.inbox.bytes

    async def open(self) -> None:
        """Connect; raises `HubError` if that is impossible, or a package is missing."""
        if find_spec("xxhash") is None:
            raise SettingError("--ros2 requires xxhash: pip install 'fibws[zenoh]'")
        self._session = await open_session(
            self._listen,
            self._connect,
            self._config,
            flags=("--ros2", "--ros2-connect"),
            defaults=ROUTER if self._listen else SESSION,
        )
        self.session_id = str(self._session.zid())
        self._is_open = True
        self._control.start()
        self._lanes.start()

    def watch_tokens(self) -> None:
        """Report tokens from now on; those that exist, too."""
        import zenoh

        def arrived(sample: zenoh.Sample) -> None:
            is_alive = sample.kind == zenoh.SampleKind.PUT
            self.inbox.put(self._token, str(sample.key_expr), is_alive)

        key = tokens_key(self.domain)
        self._tokens = Declared(
            self._control,
            lambda: self._session.liveliness().declare_subscriber(
                key, direct(arrived), history=True
            ),
        )

    async def close(self) -> None:
        """Leave the network."""
        if not self._is_open:
            return
        self._is_open = False
        self.inbox.close()
        await asyncio.to_thread(self._close_session)

    def _close_session(self) -> None:
        self._control.close()
        self._receivers.close()
        self._control.join(LEASE)
        self._receivers.join(LEASE)
        self._lanes.close()
        self._lanes.join(LEASE)
        close_session(self._session)

    # Declaring.

    def declare_token(self, token: str) -> Declared:
        """Declare a token."""
        return Declared(self._control, lambda: self._session.liveliness().declare_token(token))

    def declare_publisher(
        self, key: str, history: int, matched: Callable[[], object]
    ) -> DeclaredPublisher:
        """Declare a publisher.

        Args:
            history: messages that late subscribers get; 0 for none.
            matched: called, in the event loop, once messages reach a subscriber.
        """

        def report() -> None:
            self.inbox.put(matched)

        def declare() -> Any:
            import zenoh

            # rmw_zenoh waits for receivers only with history KEEP_ALL, which nodes here have not.
            options = {**lossy(), "allowed_destination": zenoh.Locality.REMOTE}
            if not history:
                return _Publisher(self._session.declare_publisher(key, **options), report)
            from zenoh import ext

            report()  # Each subscriber gets the last message, however late it comes.
            return ext.declare_advanced_publisher(
                self._session,
                key,
                **options,
                cache=ext.CacheConfig(max_samples=history),
                sample_miss_detection=ext.MissDetectionConfig(
                    heartbeat=None, sporadic_heartbeat=HEARTBEAT
                ),
                publisher_detection=True,
            )

        failed = partial(self.inbox.put, self.report)
        return DeclaredPublisher(self._control, self._lanes, declare, failed)

    def subscribe(
        self,
        key: str,
        history: int,
        read: Callable[[bytes], Any],
        received: Callable[[Attachment, Any], object],
        ready: Callable[[], object],
    ) -> Declared:
        """Subscribe to messages.

        Args:
            history: earlier messages of each publisher to get; 0 for none.
            read: converts a message, in a thread of zenoh; raises `FibwsError` to reject it.
            received: called, in the event loop, with each message.
            ready: called, in the event loop, once messages arrive.
        """
        import zenoh

        def arrived(sample: zenoh.Sample) -> None:
            if sample.kind == zenoh.SampleKind.PUT:
                self._arrived(sample, read, received)

        def declare() -> Any:
            origin = zenoh.Locality.REMOTE
            found: Any
            if not history:
                found = self._session.declare_subscriber(
                    key, direct(arrived), allowed_origin=origin
                )
            else:
                from zenoh import ext

                found = ext.declare_advanced_subscriber(
                    self._session,
                    key,
                    direct(arrived),
                    allowed_origin=origin,
                    history=ext.HistoryConfig(detect_late_publishers=True, max_samples=history),
                    subscriber_detection=True,
                )
            self.inbox.put(ready)
            return found

        return Declared(self._control, declare)

    def _arrived(
        self,
        sample: Any,
        read: Callable[[bytes], Any],
        received: Callable[[Attachment, Any], object],
    ) -> None:
        try:
            attachment = self._attachment(sample)
            data = self._payload(sample)
            values = read(data)
        except FibwsError as error:
            self.inbox.put(self.report, f"{sample.key_expr}: {error}")
            return
        self.inbox.put(received, attachment, values, size=max(1, len(data)))

    def serve(
        self,
        key: str,
        read: Callable[[bytes], Any],
        requested: Callable[[Attachment, Any, Callable[..., None]], object],
    ) -> Declared:
        """Serve a service.

        Args:
            read: as in `subscribe`.
            requested: called, in the event loop, with the attachment and the request, and with a
                function that takes what makes the response, in a thread, and then an error's text.
        """

        def arrived(query: zenoh.Query) -> None:
            try:
                attachment = self._attachment(query)
                data = self._payload(query)
                values = read(data)
            except FibwsError as error:
                self.inbox.put(self.report, f"{key}: {error}")
                refuse = partial(self._reply, query, key, b"", None, str(error))
                self._receivers.call(None, refuse)
                return

            def respond(make: Callable[[], tuple[bytes, bytes]] | None, error: str = "") -> None:
                def job() -> None:
                    data, head, fault = b"", None, error
                    if make is not None:
                        try:
                            data, head = make()
                        except FibwsError as found:
                            fault = str(found)
                    self._reply(query, key, data, head, fault)

                self._receivers.call(attachment.gid, job)

            self.inbox.put(requested, attachment, values, respond)

        def declare() -> Any:
            import zenoh

            return self._session.declare_queryable(
                key, direct(arrived), complete=True, allowed_origin=zenoh.Locality.REMOTE
            )

        return Declared(self._control, declare)

    def _reply(self, query: Any, key: str, data: bytes, head: bytes | None, error: str) -> None:
        """Answer a query; all responses have an attachment."""
        if head is None:
            query.reply_err(error.encode())
        else:
            query.reply(key, data, attachment=head)
        query.drop()

    def declare_client(self, key: str, timeout: float) -> Declared:
        """Declare a client of a service.

        Args:
            timeout: seconds until the network gives up a call.
        """

        def declare() -> Any:
            import zenoh

            return self._session.declare_querier(
                key,
                timeout=timeout,
                target=zenoh.QueryTarget.ALL_COMPLETE,
                consolidation=zenoh.ConsolidationMode.NONE,
                allowed_destination=zenoh.Locality.REMOTE,
                **lossless(),
            )

        return Declared(self._control, declare)

    def call(
        self,
        client: Declared,
        make: Callable[[], tuple[bytes, bytes]],
        read: Callable[[bytes], Any],
        responded: Callable[[Any, str], object],
    ) -> Callable[[], None]:
        """Call a service, once the network knows the way to it.

        Args:
            make: returns the request and its attachment; called in a thread.
            read: as in `subscribe`.
            responded: called, in the event loop, with the response and an empty text, or with None
                and an error's text; more than once if there are several servers, and at the end.

        Returns:
            A function that cancels.
        """
        import zenoh

        token = zenoh.CancellationToken()
        until = time.monotonic() + UNREACHED

        def replied(reply: zenoh.Reply) -> None:
            sample = reply.ok
            try:
                if sample is None:
                    payload = reply.err.payload.to_bytes() if reply.err is not None else b""
                    raise Ros2Error(payload[:1000].decode("utf-8", "replace") or "it failed")
                self._attachment(sample)
                values, fault = read(self._payload(sample)), ""
            except FibwsError as error:
                values, fault = None, str(error)
            self.inbox.put(responded, values, fault)

        def job() -> None:
            querier = client.found
            if querier is None or token.is_cancelled:
                self.inbox.put(responded, None, "it has left")
                return
            if not querier.matching_status.matching and time.monotonic() < until:
                # The token of a server may arrive before the network knows the way to it.
                again = partial(self._loop.call_later, CHECK_AGAIN, self._send, client, job)
                self._loop.call_soon_threadsafe(again)
                return
            try:
                data, attachment = make()
            except FibwsError as error:
                self.inbox.put(responded, None, str(error))
                return
            querier.get(
                direct(replied, lambda: self.inbox.put(responded, None, "it did not answer")),
                payload=data,
                attachment=attachment,
                cancellation_token=token,
            )

        self._send(client, job)
        return lambda: self._send(client, token.cancel)

    def _send(self, client: Declared, job: Callable[[], object]) -> None:
        """Call a function in the thread of a client, once that is declared."""
        self._control.call(partial(self._receivers.call, client, job))

    # Checking what arrives.

    def _attachment(self, sample: Any) -> Attachment:
        found = sample.attachment
        if found is None:
            raise Ros2Error("there is no attachment")
        return Attachment.parse(found.to_bytes())

    def _payload(self, sample: Any) -> bytes:
        payload = sample.payload
        size = len(payload) if payload is not None else 0
        if size > self._max_message_size:
            limit = self._max_message_size
            raise Ros2Error(f"{size} bytes, limit is {limit} (--max-message-size)")
        data: bytes = payload.to_bytes() if payload is not None else b""
        return data

    def report(self, text: str) -> None:
        """Log that something invalid has arrived; not each time."""
        self.faults += 1
        if is_power_of_ten(self.faults):
            logger.warning("ROS 2 (%d faults so far): %s", self.faults, printable(text[:500]))

    def _count_dropped(self) -> None:
        self.dropped += 1
