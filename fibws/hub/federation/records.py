"""Records that hubs announce to each other: nodes, topics, services, actions, shared parameters.

Each record replaces an earlier one of its name, and None removes it, so that a hub can be brought
up to date from any state. A record that a hub cannot take costs that record only. Names are global
names of the backplane, which may lie below a prefix (see `names.NameView`). Records are JSON;
messages of topics never are.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Annotated, Any, Literal, NamedTuple, TypeAlias

from pydantic import BaseModel, ConfigDict, FailFast, Field, TypeAdapter, ValidationError
from pydantic_core import PydanticSerializationError, from_json, to_json

from fibws.hub.errors import FederationError
from fibws.names import MAX_LENGTH

EARLIEST, LATEST = -(2**63), 2**63 - 1
"""The limits of times, in nanoseconds since 1970."""
LONGEST_PATH = 16
"""Hubs between a node and the hub that it is announced to."""
MOST_RECORDS = 100_000
"""Records of one hub, and users of its topics, that are kept; further ones are ignored."""

MOST_INVALID = 1000
"""Invalid records of one announcement that are left out one by one; with more all of it is."""

Skipped: TypeAlias = Callable[[str, str], object]
"""Takes a kind of fault, and what was left out and why."""
Kind: TypeAlias = Literal["nodes", "topics", "services", "actions", "parameters"]
KINDS: tuple[Kind, ...] = ("nodes", "topics", "services", "actions", "parameters")

Name: TypeAlias = Annotated[str, Field(max_length=MAX_LENGTH + 200, pattern=r"^/")]
Text: TypeAlias = Annotated[str, Field(max_length=MAX_LENGTH)]
HubId: TypeAlias = Annotated[str, Field(pattern=r"^[0-9a-f]{16}$")]
"""The identity of one run of a hub."""
Number: TypeAlias = Annotated[int, Field(ge=0, lt=2**63)]
Stamp: TypeAlias = Annotated[int, Field(ge=EARLIEST, le=LATEST)]
"""Nanoseconds since 1970."""


class _Record(BaseModel):
    model_config = ConfigDict(frozen=True, strict=True, extra="ignore")


class HubInfo(_Record):
    """One run of a hub.

    Attributes:
        id: 16 random hexadecimal digits.
        name: what people call it; several hubs may have one name.
        version: of fibws.
    """

    id: HubId
    name: Text
    version: Text = ""


class NodeRecord(_Record):
    """A node.

    Attributes:
        path: the hubs on the way to it: first its own, last the one that announces it.
        since: when it connected, by the clock of its own hub, in nanoseconds since 1970.
        replaces: the id of the hub whose node of this name it has replaced; empty if there was
            none.
    """

    path: Annotated[tuple[HubInfo, ...], Field(min_length=1, max_length=LONGEST_PATH), FailFast()]
    since: Stamp
    replaces: Text = ""

    @property
    def hub(self) -> HubInfo:
        """The hub that the node is connected to."""
        return self.path[0]


class PublisherRecord(_Record):
    """A publisher of a topic.

    Attributes:
        node: its node.
        number: stands for it on this backplane.
        origin: stands for it at its own hub, for its sequence numbers.
        latch: whether its last message is for later subscribers.
        queue_size: most messages that wait for a slow hub; 0 or less for no limit. The graph bounds
            it.
    """

    node: Name
    number: Number
    origin: Number
    latch: bool = False
    queue_size: int = 100


class TypeUsers(_Record):
    """The users of a topic with one type.

    Attributes:
        type: ``package/Type``; empty while it has none.
        md5sum: of the type; empty if its fields are unknown.
    """

    type: Text = ""
    md5sum: Text = ""
    publishers: Annotated[tuple[PublisherRecord, ...], FailFast()] = ()
    subscribers: Annotated[tuple[Name, ...], FailFast()] = ()


class TopicRecord(TypeUsers):
    """A topic.

    Attributes:
        others: those who use it with another type; older hubs know nothing of them.
    """

    others: Annotated[tuple[TypeUsers, ...], FailFast()] = ()

    def by_type(self) -> tuple[TypeUsers, ...]:
        """Return the users of each type."""
        return (self, *self.others)


class ServiceRecord(_Record):
    """A service; ``since`` and ``replaces`` are as of `NodeRecord`."""

    node: Name
    type: Text
    md5sum: Text = ""
    since: Stamp
    replaces: Text = ""


class ActionRecord(_Record):
    """An action; ``md5sums`` are those of its goal, feedback and result."""

    node: Name
    type: Text
    md5sums: tuple[Text, Text, Text] | None = None
    since: Stamp
    replaces: Text = ""


class ParameterRecord(_Record):
    """The last change of a shared parameter; among several the highest (stamp, hub) wins.

    Attributes:
        stamp: nanoseconds since 1970.
        hub: the id of the hub where it was changed.
        value: its JSON, ``{}`` for a namespace in which there is nothing; None if it was deleted.
    """

    stamp: Stamp
    hub: HubId
    value: str | None = None


class Announcement(_Record):
    """Changes of what a hub has: records by kind and name, None for those removed."""

    nodes: dict[Name, NodeRecord | None] = {}
    topics: dict[Name, TopicRecord | None] = {}
    services: dict[Name, ServiceRecord | None] = {}
    actions: dict[Name, ActionRecord | None] = {}
    parameters: dict[Name, ParameterRecord | None] = {}

    def of(self, kind: Kind) -> Mapping[str, Record | None]:
        """Return the records of one kind."""
        found: Mapping[str, Record | None] = getattr(self, kind)
        return found


Record: TypeAlias = NodeRecord | TopicRecord | ServiceRecord | ActionRecord | ParameterRecord


class LinkMessage(NamedTuple):
    """A message of a topic on its way between hubs.

    Attributes:
        number: its `PublisherRecord.number`.
        sequence: counts the messages of its publisher, at the publisher's own hub.
        stamp: when that hub received it, in nanoseconds since 1970.
        data: in ROS 1's serialization.
    """

    number: int
    sequence: int
    stamp: int
    data: bytes | bytearray | memoryview


@dataclass(frozen=True, slots=True)
class Request:
    """A request to another hub.

    Attributes:
        op: ``call`` (a service), ``goal`` (an action), ``cancel_goal``, ``describe`` (a type),
            ``ping_node``, ``kill_node`` or ``older_node`` (one of its name was closed elsewhere).
        fields: depend on ``op``.
        body: the serialized request or goal.
    """

    op: str
    fields: Mapping[str, Any]
    body: bytes = b""

    @property
    def must_arrive(self) -> bool:
        """Whether nobody would send it again: a link must carry it, or end."""
        return self.op in ("cancel_goal", "older_node")


@dataclass(frozen=True, slots=True)
class Reply:
    """A reply to a request; a goal gets several.

    Attributes:
        fields: ``error`` and ``code`` if it failed; others depend on the request.
        body: the serialized response, feedback or result.
        is_final: whether it is the last one.
    """

    fields: Mapping[str, Any]
    body: bytes = b""
    is_final: bool = True


def failure(text: str, code: str) -> Reply:
    """Return the reply to a request that failed; codes are those of `CallFailed`."""
    return Reply({"error": text, "code": code})


_ANNOUNCEMENT = TypeAdapter(Announcement)
_NAME: TypeAdapter[str] = TypeAdapter(Name)
_RECORDS: dict[Kind, TypeAdapter[Any]] = {
    "nodes": TypeAdapter(NodeRecord),
    "topics": TypeAdapter(TopicRecord),
    "services": TypeAdapter(ServiceRecord),
    "actions": TypeAdapter(ActionRecord),
    "parameters": TypeAdapter(ParameterRecord),
}
_USERS: dict[str, TypeAdapter[Any]] = {
    "publishers": TypeAdapter(PublisherRecord),
    "subscribers": TypeAdapter(Name),
}
_FIELDS = TypeAdapter(dict[str, Any])


def encode_announcement(announcement: Announcement) -> bytes:
    """Return an announcement as JSON."""
    return _ANNOUNCEMENT.dump_json(announcement, exclude_defaults=True)


def decode_announcement(
    data: bytes | bytearray | memoryview, skipped: Skipped | None = None
) -> Announcement:
    """Return an announcement without what is invalid in it.

    Of a topic, invalid publishers and subscribers are left out. Another invalid record is None: it
    would have replaced an earlier one of its name.

    Args:
        skipped: called with each kind of fault, and what is left out and why; None leaves out
            nothing, so that any fault is an error.

    Raises:
        FederationError: it is not a JSON object, or more than `MOST_INVALID` of it is invalid.
    """
    text = bytes(data)
    try:
        return _ANNOUNCEMENT.validate_json(text)
    except ValidationError as error:
        if skipped is None:
            raise FederationError(f"invalid announcement: {fault(error)}") from None
    try:
        found = from_json(text)
    except ValueError as error:
        raise FederationError(f"invalid announcement: {error}") from None
    if not isinstance(found, dict):
        raise FederationError("invalid announcement: expected an object")
    faults = 0

    def skip(kind: str, what: str) -> None:
        nonlocal faults
        faults += 1
        if faults > MOST_INVALID:
            text = f"more than {MOST_INVALID} invalid records, such as {what}"
            raise FederationError(f"invalid announcement: {text}")
        skipped(kind, what)

    kinds: dict[str, Any] = {kind: _valid_records(kind, found, skip) for kind in KINDS}
    return Announcement.model_construct(None, **kinds)


def _valid_records(kind: Kind, announcement: dict[str, Any], skipped: Skipped) -> dict[str, Any]:
    """Return the valid records of one kind, and None for the others."""
    records = announcement.get(kind, {})
    if not isinstance(records, dict):
        skipped(kind, f"{kind}: expected an object")
        return {}
    found: dict[str, Any] = {}
    for name, record in records.items():
        try:
            _NAME.validate_python(name)
            found[name] = None
            if record is not None:
                found[name] = _valid_record(kind, name, record, skipped)
        except ValidationError as error:
            skipped(_kind_of(kind, error), f"{kind} {name[:200]}: {fault(error)}")
    return found


def _valid_record(kind: Kind, name: str, record: Any, skipped: Skipped) -> Any:
    """Return a record, without invalid users of a topic; raise `ValidationError`."""
    try:
        return _RECORDS[kind].validate_json(to_json(record))
    except ValidationError:
        if kind != "topics" or not isinstance(record, dict):
            raise
    for users, adapter in _USERS.items():
        if isinstance(record.get(users), list):
            valid = []
            for user in record[users]:
                try:
                    adapter.validate_json(to_json(user))
                    valid.append(user)
                except ValidationError as error:
                    text = f"a user of topic {name}: {fault(error)}"
                    skipped(_kind_of(users, error), text)
            record[users] = valid
    return _RECORDS[kind].validate_json(to_json(record))


def _kind_of(what: str, error: ValidationError) -> str:
    """Return a text that all faults of one kind share: of one field of one kind of records."""
    first = error.errors(include_url=False, include_input=False)[0]
    fields = (part for part in first["loc"] if isinstance(part, str))
    return " ".join((what, *fields, first["type"]))


def encode_fields(fields: Mapping[str, Any]) -> bytes:
    """Return the fields of a request or reply as JSON; raise `FederationError` if invalid."""
    try:
        return _FIELDS.dump_json(dict(fields))
    except PydanticSerializationError as error:
        raise FederationError(f"invalid fields: {error}") from None


def decode_fields(data: bytes | bytearray | memoryview) -> dict[str, Any]:
    """Return the fields of a request or reply; raise `FederationError` for invalid JSON."""
    try:
        return _FIELDS.validate_json(bytes(data))
    except ValidationError as error:
        raise FederationError(f"invalid fields: {fault(error)}") from None


def fault(error: ValidationError) -> str:
    """Return the first fault of some JSON: where and what."""
    first = error.errors(include_url=False, include_input=False)[0]
    where = ".".join(map(str, first["loc"]))[:200]
    return f"{where}: {first['msg']}" if where else first["msg"]
