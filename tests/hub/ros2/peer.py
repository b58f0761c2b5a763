"""A ROS 2 program on a zenoh network, as rmw_zenoh would have it: written by hand, byte by byte."""

from __future__ import annotations

import asyncio
import json
import struct
from collections.abc import Callable
from typing import Any, NamedTuple, Self

import xxhash
import zenoh
from patience import PATIENCE
from zenoh import ext

import fibws

STRING = "std_msgs::msg::dds_::String_"
STRING_HASH = "RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18"
ADD = "example_interfaces::srv::dds_::AddTwoInts_"
ADD_HASH = "RIHS01_e118de6bf5eeb66a2491b5bda11202e7b68f198d6f67922cf30364858239c81a"
QOS = "::,10:,:,:,,"
LATCHED_QOS = ":1:,1:,:,:,,"


async def reaching(publisher: fibws.Publisher[Any, ...], *nodes: str) -> None:
    """Wait until messages of a publisher, made with ``peers=True``, reach nodes."""
    async with asyncio.timeout(PATIENCE):
        async for names in publisher.peers.changes():
            if set(nodes) <= set(names):
                return


def cdr_string(text: str) -> bytes:
    """Return a std_msgs/String as CDR."""
    data = text.encode() + b"\0"
    return b"\x00\x01\x00\x00" + struct.pack("<I", len(data)) + data


def text_of(data: bytes) -> str:
    """Return the text of a std_msgs/String."""
    assert data[:4] == b"\x00\x01\x00\x00"
    (size,) = struct.unpack_from("<I", data, 4)
    assert len(data) == 8 + size
    assert data[-1] == 0
    return data[8:-1].decode()


class Received(NamedTuple):
    """A message with its attachment."""

    data: bytes
    sequence: int
    stamp: int
    gid: bytes


def read_attachment(data: bytes) -> tuple[int, int, bytes]:
    """Return the number, the time and the gid."""
    assert len(data) == 33
    sequence, stamp, size = struct.unpack_from("<qqB", data)
    assert size == 16
    return sequence, stamp, data[17:]


class Entity:
    """Something that has a token.

    Attributes:
        gid: what is in the attachments of its messages.
    """

    def __init__(self, text: str, token: zenoh.LivelinessToken) -> None:
        self.text = text
        self.gid = xxhash.xxh3_128_intdigest(text.encode()).to_bytes(16, "little")
        self._token = token
        self.declared: Any = None
        self.listener: Any = None
        self.sequence = 0
        self.matched = asyncio.Event()
        """Set while somebody subscribes to a publisher."""
        self.unmatched = asyncio.Event()

    def note(self, is_matched: bool) -> None:
        """Take note that somebody subscribes, or nobody does."""
        for event, is_set in ((self.matched, is_matched), (self.unmatched, not is_matched)):
            if is_set:
                event.set()
            else:
                event.clear()

    async def close(self) -> None:
        """Undeclare everything."""
        for each in (self.listener, self.declared):
            if each is not None:
                await asyncio.to_thread(each.undeclare)
        await asyncio.to_thread(self._token.undeclare)

    def attachment(self) -> bytes:
        """Return the attachment of the next message."""
        self.sequence += 1
        return struct.pack("<qqB", self.sequence, 1_700_000_000_000_000_000, 16) + self.gid

    async def publish(self, data: bytes, attachment: bytes | None = None) -> None:
        """Publish a message."""
        head = self.attachment() if attachment is None else attachment
        await asyncio.to_thread(self.declared.put, data, attachment=head)


class Peer:
    """A session with one or more nodes.

    Args:
        endpoint: that of the hub.
        lease: seconds of silence after which the hub takes it for lost.
    """

    def __init__(self, endpoint: str, domain: int = 0, lease: float = 10.0) -> None:
        config = zenoh.Config()
        for key, value in {
            "mode": "client",
            "connect/endpoints": [endpoint],
            "scouting/multicast/enabled": False,
            "timestamping/enabled": True,
            "transport/link/tx/lease": round(lease * 1000),
        }.items():
            config.insert_json5(key, json.dumps(value))
        self.domain = domain
        self._config = config
        self.session: zenoh.Session
        self._ids = 0
        self._entities: list[Entity] = []
        """Tokens end when nothing refers to them."""

    async def __aenter__(self) -> Self:
        self.session = await asyncio.to_thread(zenoh.open, self._config)
        self.id = str(self.session.zid())
        return self

    async def __aexit__(self, *error: object) -> None:
        await asyncio.to_thread(self.session.close)

    async def declare(
        self,
        kind: str,
        node: str,
        name: str = "",
        type_: str = STRING,
        type_hash: str = STRING_HASH,
        qos: str = QOS,
    ) -> Entity:
        """Declare a token."""
        self._ids += 1
        namespace, _, base = node.rpartition("/")
        text = f"@ros2_lv/{self.domain}/{self.id}/0/{self._ids}/{kind}/%/"
        text += f"{namespace.replace('/', '%') or '%'}/{base}"
        if name:
            text += f"/{name.replace('/', '%')}/{type_}/{type_hash}/{qos}"
        entity = Entity(
            text, await asyncio.to_thread(self.session.liveliness().declare_token, text)
        )
        self._entities.append(entity)
        return entity

    def key(self, name: str, type_: str = STRING, type_hash: str = STRING_HASH) -> str:
        """Return the key of a topic or a service."""
        return f"{self.domain}/{name.lstrip('/')}/{type_}/{type_hash}"

    async def publisher(
        self,
        node: str,
        topic: str,
        type_: str = STRING,
        type_hash: str = STRING_HASH,
        *,
        latched: bool = False,
    ) -> Entity:
        """Declare a publisher."""
        key = self.key(topic, type_, type_hash)

        def declare() -> Any:
            if not latched:
                # As rmw_zenoh does for history KEEP_ALL: nothing is dropped on the way.
                block = zenoh.CongestionControl.BLOCK
                return self.session.declare_publisher(key, congestion_control=block)
            return ext.declare_advanced_publisher(
                self.session,
                key,
                cache=ext.CacheConfig(max_samples=1),
                sample_miss_detection=ext.MissDetectionConfig(
                    heartbeat=None, sporadic_heartbeat=0.5
                ),
                publisher_detection=True,
            )

        declared = await asyncio.to_thread(declare)
        qos = LATCHED_QOS if latched else QOS
        entity = await self.declare("MP", node, topic, type_, type_hash, qos)
        entity.declared = declared
        if not latched:
            loop = asyncio.get_running_loop()
            handler: Any = zenoh.handlers.Callback(
                lambda status: loop.call_soon_threadsafe(entity.note, status.matching),
                indirect=False,
            )
            entity.listener = await asyncio.to_thread(declared.declare_matching_listener, handler)
            entity.note(declared.matching_status.matching)
        return entity

    async def subscriber(
        self,
        node: str,
        topic: str,
        type_: str = STRING,
        type_hash: str = STRING_HASH,
        *,
        latched: bool = False,
        key: str = "",
    ) -> tuple[Entity, asyncio.Queue[Received]]:
        """Declare a subscriber."""
        loop = asyncio.get_running_loop()
        queue: asyncio.Queue[Received] = asyncio.Queue()

        def arrived(sample: zenoh.Sample) -> None:
            assert sample.attachment is not None
            found = read_attachment(sample.attachment.to_bytes())
            message = Received(sample.payload.to_bytes(), *found)
            loop.call_soon_threadsafe(queue.put_nowait, message)

        handler = zenoh.handlers.Callback(arrived, indirect=False)
        where = key or self.key(topic, type_, type_hash)

        def declare() -> Any:
            if not latched:
                return self.session.declare_subscriber(where, handler)
            return ext.declare_advanced_subscriber(
                self.session,
                where,
                handler,
                history=ext.HistoryConfig(detect_late_publishers=True, max_samples=1),
                subscriber_detection=True,
            )

        declared = await asyncio.to_thread(declare)
        qos = LATCHED_QOS if latched else QOS
        entity = await self.declare("MS", node, topic, type_, type_hash, qos)
        entity.declared = declared
        return entity, queue

    async def server(
        self, node: str, name: str, answer: Callable[[zenoh.Query], object], **types: str
    ) -> Entity:
        """Declare a service server, whose answers are given in a thread."""
        types = {"type_": ADD, "type_hash": ADD_HASH, **types}
        declared = await asyncio.to_thread(
            lambda: self.session.declare_queryable(self.key(name, **types), answer, complete=True)
        )
        entity = await self.declare("SS", node, name, **types)
        entity.declared = declared
        return entity

    async def call(
        self, name: str, data: bytes | None, attachment: bytes | None, timeout: float = PATIENCE
    ) -> zenoh.Reply | None:
        """Call a service; return its first reply."""

        def get() -> zenoh.Reply | None:
            replies = self.session.get(
                self.key(name, ADD, ADD_HASH),
                payload=data,
                attachment=attachment,
                timeout=timeout,
                target=zenoh.QueryTarget.ALL_COMPLETE,
                consolidation=zenoh.ConsolidationMode.NONE,
            )
            return next(iter(replies), None)

        return await asyncio.to_thread(get)

    async def tokens(self, changed: Callable[[str, bool], object]) -> None:
        """Report all tokens, in this event loop."""
        loop = asyncio.get_running_loop()

        def arrived(sample: zenoh.Sample) -> None:
            is_alive = sample.kind == zenoh.SampleKind.PUT
            loop.call_soon_threadsafe(changed, str(sample.key_expr), is_alive)

        self._watcher = await asyncio.to_thread(
            lambda: self.session.liveliness().declare_subscriber(
                f"@ros2_lv/{self.domain}/**",
                zenoh.handlers.Callback(arrived, indirect=False),
                history=True,
            )
        )
