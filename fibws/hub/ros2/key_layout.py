"""The keys, liveliness tokens and attachments of rmw_zenoh (https://github.com/ros2/rmw_zenoh).

Messages have the key ``DOMAIN/NAME/TYPE/HASH``, and so have the queries of services. Each node,
publisher, subscriber, service server and service client has a token:

    @ros2_lv/DOMAIN/SESSION/NODE_ID/ID/KIND/ENCLAVE/NAMESPACE/NODE[/NAME/TYPE/HASH/QOS]

in which ``%`` stands for ``/``. Every message, request and response has an attachment of 33 bytes:
its number, its time, the length of the gid, and the gid of its publisher or client, which is a hash
of the token.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from struct import Struct
from typing import Final, Literal, NamedTuple, TypeAlias, get_args

from fibws.errors import Ros2Error

Kind: TypeAlias = Literal["NN", "MP", "MS", "SS", "SC"]
"""Node, publisher, subscriber, service server, service client."""
TypeKind: TypeAlias = Literal["msg", "srv"]

KINDS: Final[dict[str, Kind]] = {kind: kind for kind in get_args(Kind)}
TOPIC_KINDS: Final = ("MP", "MS")
ADMIN_SPACE: Final = "@ros2_lv"
NO_HASH: Final = "TypeHashNotSupported"
"""In place of a type's hash, by ROS 2 Humble."""
MAX_TOKEN: Final = 2000
"""Characters of a token; zenoh would take more."""
GID_SIZE: Final = 16

_ID: Final = re.compile(r"[\w.-]{1,64}", re.ASCII)
_NAME: Final = re.compile(r"(/[A-Za-z_]\w*)+", re.ASCII)
_NODE: Final = re.compile(r"[A-Za-z_]\w*", re.ASCII)
_TYPE: Final = re.compile(
    r"([A-Za-z]\w{0,99})::(msg|srv|action)::dds_::([A-Za-z]\w{0,99})_", re.ASCII
)
_HASH: Final = re.compile(rf"RIHS01_[0-9a-f]{{64}}|{NO_HASH}")
_TOO_OLD: Final = "rmw_zenoh before 0.2.4, or before 0.1.2 of Humble, is not supported"
_ATTACHMENT: Final = Struct(f"<qqB{GID_SIZE}s")
_PARTS_OF_NODE: Final = 9
_PARTS: Final = 13


@dataclass(frozen=True, slots=True)
class Qos:
    """The quality of service of a publisher or subscriber, as far as it matters here.

    Attributes:
        is_reliable: whether messages must not be lost.
        is_latched: ROS 2's durability ``transient_local``: late subscribers get the last messages.
        depth: how many messages are kept for them, or wait for a slow subscriber; up to ROS 2's
            SIZE_MAX.
    """

    is_reliable: bool = True
    is_latched: bool = False
    depth: int = 42

    def __str__(self) -> str:
        reliability = "" if self.is_reliable else "2"
        durability = "1" if self.is_latched else ""
        depth = "" if self.depth == _DEFAULT_DEPTH else str(self.depth)
        return f"{reliability}:{durability}:,{depth}:,:,:,,"

    @classmethod
    def parse(cls, text: str) -> Qos:
        """Read the field of a token; empty fields have rmw_zenoh's defaults.

        Raises:
            Ros2Error: it is invalid.
        """
        parts = text.split(":")
        if len(parts) < 6:
            raise Ros2Error(f"invalid QoS {text[:100]}: expected 6 fields")
        reliability, durability, (history, _, depth) = parts[0], parts[1], parts[2].partition(",")
        numbers = (reliability, durability, history, depth)
        if any(number and not (number.isdecimal() and len(number) <= 20) for number in numbers):
            raise Ros2Error(f"invalid QoS {text[:100]}: expected numbers")
        return cls(reliability != "2", durability == "1", int(depth or _DEFAULT_DEPTH))


_DEFAULT_DEPTH: Final = 42


@dataclass(frozen=True, slots=True)
class Entity:
    """A node, publisher, subscriber, service server or client, as its token describes it.

    Attributes:
        session: the id of the zenoh session that it belongs to.
        node_id: the number of its node in the session.
        id: its own number in the session.
        node: the global name of its node.
        name: the global name of the topic or service; empty for a node.
        type: ``package/Type``; empty for a node.
        type_hash: ``RIHS01_...`` or `NO_HASH`.
        enclave: the node's enclave of SROS 2.
    """

    domain: int
    session: str
    node_id: str
    id: str
    kind: Kind
    node: str
    name: str = ""
    type: str = ""
    type_hash: str = ""
    qos: Qos = Qos()
    enclave: str = "/"

    def token(self) -> str:
        """Return the token."""
        namespace, _, node = self.node.rpartition("/")
        ids = f"{self.domain}/{self.session}/{self.node_id}/{self.id}/{self.kind}"
        owner = f"{_mangled(self.enclave)}/{_mangled(namespace or '/')}/{node}"
        text = f"{ADMIN_SPACE}/{ids}/{owner}"
        if self.kind == "NN":
            return text
        kind: TypeKind = "msg" if self.kind in TOPIC_KINDS else "srv"
        type_ = dds_type(kind, self.type)
        return f"{text}/{_mangled(self.name)}/{type_}/{self.type_hash}/{self.qos}"

    @classmethod
    def parse(cls, token: str) -> Entity:
        """Read a token.

        Further parts behind the known ones are ignored, as later releases may add some.

        Raises:
            Ros2Error: it is not a token of rmw_zenoh.
        """
        if len(token) > MAX_TOKEN:
            raise Ros2Error(f"invalid token: {len(token)} characters, limit is {MAX_TOKEN}")
        parts = token.split("/")
        if len(parts) < _PARTS_OF_NODE or parts[0] != ADMIN_SPACE:
            raise Ros2Error(f"invalid token {token}")
        _, domain, session, node_id, id_, kind, enclave, namespace, node = parts[:_PARTS_OF_NODE]
        if kind not in KINDS or not domain.isdecimal() or len(domain) > 10:
            raise Ros2Error(f"invalid token {token}")
        if not all(map(_ID.fullmatch, (session, node_id, id_))) or not _NODE.fullmatch(node):
            raise Ros2Error(f"invalid token {token}")
        namespace = _demangled(namespace)
        full = f"{namespace.rstrip('/')}/{node}"
        _check_name(full)
        own: tuple[int, str, str, str, Kind] = int(domain), session, node_id, id_, KINDS[kind]
        if kind == "NN":
            return cls(*own, full, enclave=_demangled(enclave))
        if len(parts) < _PARTS:
            raise Ros2Error(f"invalid token {token}: expected name, type, hash and QoS")
        name, type_, type_hash, qos = parts[_PARTS_OF_NODE:_PARTS]
        name = _demangled(name)
        _check_name(name)
        type_kind, type_name = parse_dds_type(type_)
        is_right = type_kind == ("msg" if kind in TOPIC_KINDS else "srv")
        if not is_right and not is_left_out(name):
            raise Ros2Error(f"{name}: {type_} is not a type of a {_WORDS[kind]}")
        if not _HASH.fullmatch(type_hash):
            raise Ros2Error(f"{name}: invalid type hash {type_hash[:100]}")
        found = Qos.parse(qos)
        return cls(*own, full, name, type_name, type_hash, found, _demangled(enclave))


_WORDS: Final = {"MP": "topic", "MS": "topic", "SS": "service", "SC": "service"}


class Attachment(NamedTuple):
    """The metadata of a message, a request or a response.

    Attributes:
        sequence: the number of the message or request.
        stamp: when it was sent, in nanoseconds since 1970.
        gid: the publisher, or the client.
    """

    sequence: int
    stamp: int
    gid: bytes

    def pack(self) -> bytes:
        """Return its bytes."""
        return _ATTACHMENT.pack(self.sequence, self.stamp, GID_SIZE, self.gid)

    @classmethod
    def parse(cls, data: bytes) -> Attachment:
        """Read the bytes.

        Raises:
            Ros2Error: they are not those of an attachment.
        """
        if len(data) != _ATTACHMENT.size:
            hint = f"; {_TOO_OLD}" if len(data) == 77 else ""
            expected = f"expected {_ATTACHMENT.size} bytes, got {len(data)}"
            raise Ros2Error(f"invalid attachment: {expected}{hint}")
        sequence, stamp, size, gid = _ATTACHMENT.unpack(data)
        if size != GID_SIZE:
            raise Ros2Error(f"invalid attachment: expected a gid of {GID_SIZE} bytes, got {size}")
        return cls(sequence, stamp, gid)


def gid_of(token: str) -> bytes:
    """Return the gid of the publisher or client that has a token: its XXH3 hash of 128 bits."""
    from xxhash import xxh3_128_intdigest  # It comes with the extra zenoh.

    return xxh3_128_intdigest(token.encode()).to_bytes(GID_SIZE, "little")


def data_key(domain: int, name: str, kind: TypeKind, type_: str, type_hash: str) -> str:
    """Return the key of a topic's messages, or of a service's requests."""
    return f"{domain}/{name.strip('/')}/{dds_type(kind, type_)}/{type_hash}"


def tokens_key(domain: int) -> str:
    """Return the key expression of all tokens of a domain."""
    return f"{ADMIN_SPACE}/{domain}/**"


def dds_type(kind: TypeKind, name: str) -> str:
    """Return ``std_msgs::msg::dds_::String_`` for ``std_msgs/String``."""
    package, _, type_ = name.partition("/")
    return f"{package}::{kind}::dds_::{type_}_"


def parse_dds_type(text: str) -> tuple[str, str]:
    """Return ``msg``, ``srv`` or ``action``, and ``package/Type``; raise `Ros2Error`."""
    found = _TYPE.fullmatch(text)
    if found is None:
        raise Ros2Error(f"invalid type {text[:200]}")
    return found[2], f"{found[1]}/{found[3]}"


def is_legal(name: str) -> bool:
    """Return whether ROS 2 allows a global name."""
    return len(name) < 256 and _NAME.fullmatch(name) is not None


def is_left_out(name: str) -> bool:
    """Return whether a topic or a service is a part of an action or of service introspection."""
    return "/_action/" in name or name.endswith("/_service_event")


def _check_name(name: str) -> None:
    if not is_legal(name):
        raise Ros2Error(f"invalid name {name[:300]}")


def _mangled(name: str) -> str:
    return name.replace("/", "%")


def _demangled(name: str) -> str:
    return name.replace("%", "/")
