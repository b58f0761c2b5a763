"""The operations of the rosbridge v2.0 protocol, one frozen model each.

Unknown fields are ignored. A new operation is a model here and a case in the hub's session, which
does not type-check without it.

Additions of fibws to rosbridge are marked at their fields. All are off unless a client asks for
them, so that rosbridge clients never get an unknown field.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BaseModel, ConfigDict, Field

from fibws.interfaces.json_text import exact_json_of
from fibws.interfaces.json_text import json_of as json_of
from fibws.interfaces.json_text import plain_json as plain_json
from fibws.interfaces.serialized_values import SerializedValues
from fibws.protocol.headers import Headers, HubHeader
from fibws.protocol.serialized import MOST_PUBLISHERS, VALUES, operation_head

MOST_CREDIT = 1000
"""The largest credit of a subscription."""
SHORTEST_WILL, LONGEST_WILL = 0.05, 3600.0
"""Seconds: the least and the most that a will can wait for the client's next message."""
LONGEST_ID = 2000
"""Most characters of an id, which is kept as long as its operation."""
Id = Annotated[str, Field(max_length=LONGEST_ID)] | int | float | bool | None
"""The id of an operation, chosen by the client."""
Level = Literal["error", "warning", "info", "none"]
FragmentSize = Annotated[
    int | None, AfterValidator(lambda size: size if size and size > 0 else None)
]
"""Characters above which a message is fragmented; None or <= 0 for never."""
Code = str | None
"""The ``code`` of the error in `fibws.errors`. The hub sends it on connections of ``fibws.v1`` (an
addition of fibws)."""
Asked = bool | None
"""Whether a client asks for an addition of fibws; no is None, which is not sent."""


class Operation(BaseModel):
    """The base of all operations; replies carry the id of the request."""

    model_config = ConfigDict(frozen=True, strict=True, extra="ignore")

    id: Id = None


class Advertise(Operation):
    """The client registers as a publisher of ``topic``."""

    op: Literal["advertise"] = "advertise"
    topic: str
    type: str
    latch: bool = False
    queue_size: int = 100
    """Most messages that wait for one ROS 1 node that reads too slowly; 0 or less for no limit.
    Other subscribers set their own."""
    definition: str | None = None
    """The type's .msg text, for types that the hub does not have (an addition of fibws)."""
    headers: Headers | None = None
    """The connection header for subscribers that ask for headers (an addition of fibws). The
    client's newest advertisement of the topic that has one counts."""
    peers: Asked = None
    """Whether to report the subscribers by `Peers` (an addition of fibws)."""
    peer_changes: Asked = None
    """Whether the client understands changes of the peers; else it is sent them all after each
    change (an addition of fibws)."""
    publisher: Annotated[int, Field(ge=0, lt=MOST_PUBLISHERS)] | None = None
    """On a connection of ``fibws.v1``: the number that binary frames of this publisher begin with;
    it is free for another topic after ``unadvertise`` (see `protocol.serialized`)."""
    md5sum: str | None = None
    """The md5 of the type as the client knows it; the hub refuses another one (an addition of
    fibws)."""
    keep_seq: Asked = None
    """Whether messages keep their ``header.seq``, as those of a recording should; else the hub
    counts them, as rospy's publishers do (an addition of fibws)."""


class Unadvertise(Operation):
    """The client withdraws an advertisement of ``topic``, or all of them if there is no id."""

    op: Literal["unadvertise"] = "unadvertise"
    topic: str


class Publish(Operation):
    """One message, either way; ``msg`` of None stands for the type's default message."""

    op: Literal["publish"] = "publish"
    topic: str
    msg: Any = None
    latch: bool = False
    to: str | None = None
    """The only node to deliver it to; it is then not latched (an addition of fibws)."""
    header: HubHeader = None
    """For a subscription that asks for headers: ``callerid``, the publisher's node, ``latching``,
    0 or 1, and the headers of its advertisement (an addition of fibws)."""


class Subscribe(Operation):
    """The client subscribes to ``topic``; ``throttle_rate`` is in milliseconds."""

    op: Literal["subscribe"] = "subscribe"
    topic: str
    type: str | None = None
    throttle_rate: Annotated[float, Field(allow_inf_nan=False)] = 0
    queue_length: int = 0
    fragment_size: FragmentSize = None
    compression: str = "none"
    headers: Asked = None
    """Whether messages carry a ``header``, see `Publish`; those in CBOR and PNG never do. Infinity
    is then written as 1e999, not null (an addition of fibws)."""
    peers: Asked = None
    """Whether to report the publishers by `Peers` (an addition of fibws)."""
    peer_changes: Asked = None
    """As in `Advertise`."""
    definition: str | None = None
    """As in `Advertise`: serialized messages need the type's fields, and the subscriber may be the
    first node that uses the type (an addition of fibws)."""
    md5sum: str | None = None
    """As in `Advertise`."""
    send_definition: Asked = None
    """Whether `Subscribed` has the text of the type (an addition of fibws)."""
    int64: Literal["string"] | None = None
    """Whether all fields of int64 and uint64 are decimal strings in JSON, small values too:
    numbers in JavaScript hold no integers beyond 2**53 (an addition of fibws)."""
    credit: Annotated[int, Field(ge=1, le=MOST_CREDIT)] | None = None
    """With serialized messages only: how many may be on the way that the client has not
    acknowledged by `Acknowledge`; meanwhile the newest one waits. None for no limit (an addition of
    fibws)."""


class Unsubscribe(Operation):
    """The client ends a subscription to ``topic``, or all of them if there is no id."""

    op: Literal["unsubscribe"] = "unsubscribe"
    topic: str


class Acknowledge(Operation):
    """The client has processed messages of ``topic``, to which it subscribed with a credit (an
    addition of fibws).

    To acknowledge more messages than were sent is the same as to acknowledge all.
    """

    op: Literal["acknowledge"] = "acknowledge"
    topic: str
    count: Annotated[int, Field(ge=1)] = 1


class CallService(Operation):
    """A service call, from its caller or to the service's server.

    ``args`` is an object, or a list of the request's fields in order; other values count as absent.
    ``timeout`` is in seconds.
    """

    op: Literal["call_service"] = "call_service"
    service: str
    args: Any = None
    fragment_size: FragmentSize = None
    timeout: Annotated[float, Field(allow_inf_nan=False)] | None = None
    headers: Headers | None = None
    """The caller's header; its ``md5sum``, if any, must be that of the service's type (an addition
    of fibws)."""
    header: HubHeader = None
    """For a server that asks for headers: ``callerid``, the caller's node, and its headers (an
    addition of fibws)."""


class AdvertiseService(Operation):
    """The client provides ``service``."""

    op: Literal["advertise_service"] = "advertise_service"
    service: str
    type: str
    definition: str | None = None
    """The type's .srv text, for types that the hub does not have (an addition of fibws)."""
    headers: Asked = None
    """Whether calls carry a ``header``, see `CallService` (an addition of fibws)."""
    compression: str | None = None
    """`ROS1` to get requests serialized, on a connection of ``fibws.v1``, as long as the type of
    the service has the ``md5sum`` (an addition of fibws)."""
    md5sum: Annotated[str, Field(max_length=LONGEST_ID)] | None = None
    """The md5 of the type as the server knows it (an addition of fibws)."""


class UnadvertiseService(Operation):
    """The client withdraws ``service``, or all its services if that is None."""

    op: Literal["unadvertise_service"] = "unadvertise_service"
    service: str | None = None


class ServiceResponse(Operation):
    """The response to a call, either way: ``values`` is an object, or an error's text."""

    op: Literal["service_response"] = "service_response"
    service: str
    values: Any = None
    result: bool
    code: Code = None
    header: HubHeader = None
    """For a caller that sent ``headers``: ``callerid``, the server's node (an addition of
    fibws)."""


class AdvertiseAction(Operation):
    """The client executes the goals of ``action``."""

    op: Literal["advertise_action"] = "advertise_action"
    action: str
    type: str
    definition: str | None = None
    """The type's .action text, for types that the hub does not have (an addition of fibws)."""
    compression: str | None = None
    """As in `AdvertiseService`, for goals (an addition of fibws)."""
    md5sum: Annotated[str, Field(max_length=LONGEST_ID)] | None = None
    """The md5s of goal, feedback and result as the server knows them, with commas between them (an
    addition of fibws)."""


class UnadvertiseAction(Operation):
    """The client withdraws ``action``."""

    op: Literal["unadvertise_action"] = "unadvertise_action"
    action: str


class SendActionGoal(Operation):
    """A goal, from its client or to the action's server."""

    op: Literal["send_action_goal"] = "send_action_goal"
    action: str
    action_type: str
    args: Any = None
    feedback: bool = False
    fragment_size: FragmentSize = None


class CancelActionGoal(Operation):
    """Cancel the goal of this id, either way."""

    op: Literal["cancel_action_goal"] = "cancel_action_goal"
    action: str


class ActionFeedback(Operation):
    """Feedback of the goal of this id, either way."""

    op: Literal["action_feedback"] = "action_feedback"
    action: str
    values: Any = None


class ActionResult(Operation):
    """The result of the goal of this id, either way.

    ``status`` is one of action_msgs/GoalStatus; ``values`` is the result, or an error's text.
    """

    op: Literal["action_result"] = "action_result"
    action: str
    values: Any = None
    status: Annotated[int, Field(ge=0, le=6)] = 0
    result: bool
    code: Code = None


class Png(Operation):
    """Another operation's text as an image: see `png`."""

    op: Literal["png"] = "png"
    data: str


class SetWill(Operation):
    """Have the hub publish a message once the client has gone (an addition of fibws).

    A topic has one will of each client: another replaces it, and ``unadvertise`` forgets it. It is
    published however the connection ends.
    """

    op: Literal["set_will"] = "set_will"
    topic: str
    type: str | None = None
    """The topic's type; needed only if the client has not advertised it and it has none yet."""
    msg: Any = None
    timeout: Annotated[float, Field(ge=SHORTEST_WILL, le=LONGEST_WILL)] | None = None
    """Seconds after the client's last message on the topic: if no other follows in this time, the
    will is published although the client is connected."""


class ClearWill(Operation):
    """Forget the will for a topic (an addition of fibws)."""

    op: Literal["clear_will"] = "clear_will"
    topic: str


class Fragment(Operation):
    """One of ``total`` pieces of the text of another operation, counted from 0."""

    op: Literal["fragment"] = "fragment"
    id: str | int
    data: str
    num: int
    total: int


class Auth(Operation):
    """The client's token, also to renew one that expires soon.

    The fields of rosauth (``mac``, ``client`` and so on) are ignored.
    """

    op: Literal["auth"] = "auth"
    token: str | None = Field(default=None, repr=False)
    """(An addition of fibws.)"""


class SetLevel(Operation):
    """The least level of the statuses to send to the client."""

    op: Literal["set_level"] = "set_level"
    level: Level


class Status(Operation):
    """A report of the hub about the client's operation of this id.

    ``operation`` (an addition of fibws) takes the place of ``id`` in some reports to web pages.
    """

    op: Literal["status"] = "status"
    level: Level
    msg: str
    operation: str | None = None
    code: Code = None


class Subscribed(Operation):
    """The reply to a ``subscribe`` that asks for serialized messages (an addition of fibws).

    Binary frames of this topic begin with ``topic_id``; see `protocol.serialized`.
    """

    op: Literal["subscribed"] = "subscribed"
    topic: str
    topic_id: int
    type: str
    md5sum: str
    credit: int | None = None
    """As in the request: messages are to be acknowledged."""
    definition: str | None = None
    """The text of the type with those of the types in it, if ``send_definition`` asked for it."""


class Peers(Operation):
    """The subscribers of a publisher's topic, or the publishers of a subscriber's.

    The hub sends it with all ``nodes`` after an advertisement or subscription of this id that asks
    for peers, and then with the nodes that were ``removed`` and those that were ``added``: a node
    in both has left and come back. A client that does not understand changes, or has missed many,
    is sent all nodes. A node is listed once messages reach it. All lists are sorted and unique;
    ``topic`` may be absent from changes that have an id. (An addition of fibws.)
    """

    op: Literal["peers"] = "peers"
    topic: str | None = None
    nodes: list[str] | None = None
    removed: list[str] = []
    added: list[str] = []


Request = (
    Advertise
    | Unadvertise
    | Publish
    | Subscribe
    | Unsubscribe
    | Acknowledge
    | CallService
    | AdvertiseService
    | UnadvertiseService
    | ServiceResponse
    | AdvertiseAction
    | UnadvertiseAction
    | SendActionGoal
    | CancelActionGoal
    | ActionFeedback
    | ActionResult
    | SetWill
    | ClearWill
    | Fragment
    | Auth
    | SetLevel
)
"""The operations that clients send."""

Reply = (
    Publish
    | CallService
    | ServiceResponse
    | SendActionGoal
    | CancelActionGoal
    | ActionFeedback
    | ActionResult
    | Fragment
    | Png
    | Status
    | Subscribed
    | Peers
)
"""The operations that the hub sends."""


def legal_id(id_: object) -> Id:
    """Return ``id_`` if it is a valid id, else None."""
    if isinstance(id_, str):
        return id_ if len(id_) <= LONGEST_ID else None
    return id_ if isinstance(id_, int | float) else None


def encode(operation: Operation, *, exact: bool = False) -> bytes:
    """Return an operation as JSON text, ``op`` first, without the fields that are None.

    Args:
        exact: as in `encode_fields`.
    """
    fields = operation.__dict__
    return encode_fields({"op": fields["op"], **fields}, exact=exact)


def encode_serialized(operation: Operation) -> bytes | None:
    """Return the payload of an operation with serialized values; None if it has no such.

    See `protocol.serialized`.
    """
    fields = operation.__dict__
    name = VALUES.get(fields["op"], "")
    values = fields.get(name)
    if not isinstance(values, SerializedValues):
        return None
    fields = {"op": fields["op"], **fields, name: None, "md5sum": values.md5sum}
    return operation_head(encode_fields(fields)) + values.data


def encode_fields(fields: dict[str, Any], *, exact: bool = False, **texts: bytes) -> bytes:
    """Return an operation's fields as JSON text, without those that are None.

    Args:
        exact: whether infinity is a number, as `exact_json_of` writes it, and not null.
        texts: fields that are JSON text already.
    """
    known = {name: value for name, value in fields.items() if value is not None}
    text = exact_json_of(known) if exact else json_of(known)
    for name, value in texts.items():
        text = b'%b,"%b":%b}' % (text[:-1], name.encode(), value)
    return text
