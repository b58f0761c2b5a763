"""The operations of the rosbridge v2.0 protocol, one frozen model each.

Fields that a client sends and no model names are ignored. A new operation is a model here and a
case in `hub/session/session.py`, which does not type-check until it has one.

What rosbridge does not have, and fibws adds, is said at its field. All of it is off unless it is
asked for, so that no client of rosbridge is sent what it does not know.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BaseModel, ConfigDict, Field

from fibws.interfaces.json_text import json_of as json_of
from fibws.protocol.headers import Headers, HubHeader
from fibws.protocol.serialized import MOST_PUBLISHERS

LONGEST_ID = 2000
"""Characters: it is kept while its operation lasts."""
Id = Annotated[str, Field(max_length=LONGEST_ID)] | int | float | bool | None
"""What a client may call an operation by."""
Level = Literal["error", "warning", "info", "none"]
FragmentSize = Annotated[
    int | None, AfterValidator(lambda size: size if size and size > 0 else None)
]
"""Characters above which a text is to come in pieces; None for never, as what is not above 0."""
Code = str | None
"""What went wrong, for programs: the ``code`` of the error in `fibws.errors`. The hub sends it on
connections of ``fibws.v1`` (an addition of fibws)."""
Asked = bool | None
"""Whether a client asks for an addition of fibws; None, which is not sent, for no."""


class Operation(BaseModel):
    """What every operation has: a name, and an id that answers carry back as it was sent."""

    model_config = ConfigDict(frozen=True, strict=True, extra="ignore")

    id: Id = None


class Advertise(Operation):
    """The client will publish on ``topic``."""

    op: Literal["advertise"] = "advertise"
    topic: str
    type: str
    latch: bool = False
    queue_size: int = 100
    definition: str | None = None
    """The type's .msg text, for types that the hub does not have (an addition of fibws)."""
    headers: Headers | None = None
    """What subscribers that ask for headers are told beside each message (an addition of fibws).
    The client's newest advertisement of the topic that has any decides."""
    peers: Asked = None
    """Whether the client wants to know who subscribes: see `Peers` (an addition of fibws)."""
    publisher: Annotated[int, Field(ge=0, lt=MOST_PUBLISHERS)] | None = None
    """On a connection of ``fibws.v1``: the number that binary frames of this publisher begin with;
    it is free for another topic after ``unadvertise`` (see `protocol.serialized`)."""
    md5sum: str | None = None
    """The md5 of the type as the client knows it; the hub refuses another one (an addition of
    fibws)."""


class Unadvertise(Operation):
    """The client will publish no more on ``topic``; without an id, for all its advertisements."""

    op: Literal["unadvertise"] = "unadvertise"
    topic: str


class Publish(Operation):
    """One message, either way; ``msg`` of None stands for the type's default message."""

    op: Literal["publish"] = "publish"
    topic: str
    msg: Any = None
    latch: bool = False
    to: str | None = None
    """The only node that is to hear it; it is not latched then (an addition of fibws)."""
    header: HubHeader = None
    """For a subscription that asks for headers: ``callerid``, the publisher's node, ``latching``,
    0 or 1, and the headers of its advertisement (an addition of fibws)."""


class Subscribe(Operation):
    """The client wants the messages of ``topic``; ``throttle_rate`` is in milliseconds."""

    op: Literal["subscribe"] = "subscribe"
    topic: str
    type: str | None = None
    throttle_rate: Annotated[float, Field(allow_inf_nan=False)] = 0
    queue_length: int = 0
    fragment_size: FragmentSize = None
    compression: str = "none"
    headers: Asked = None
    """Whether messages are to carry a ``header``: see `Publish`. Those in CBOR and PNG have none.
    Infinity is then a number that no float can hold, not null (an addition of fibws)."""
    peers: Asked = None
    """Whether the client wants to know who publishes: see `Peers` (an addition of fibws)."""
    md5sum: str | None = None
    """As in `Advertise`."""


class Unsubscribe(Operation):
    """The client wants no more of ``topic``; without an id, for all its subscriptions."""

    op: Literal["unsubscribe"] = "unsubscribe"
    topic: str


class CallService(Operation):
    """A call, from a client that asks it or to the client that is to answer it.

    ``args`` is an object, or a list of the request's fields in order; what else comes there counts
    as absent. ``timeout`` is in seconds.
    """

    op: Literal["call_service"] = "call_service"
    service: str
    args: Any = None
    fragment_size: FragmentSize = None
    timeout: Annotated[float, Field(allow_inf_nan=False)] | None = None
    headers: Headers | None = None
    """What the caller says beside its request; ``md5sum`` must be that of the service's type, if it
    is there (an addition of fibws)."""
    header: HubHeader = None
    """For a provider that asks for headers: ``callerid``, the caller's node, and its headers (an
    addition of fibws)."""


class AdvertiseService(Operation):
    """The client answers the calls of ``service``."""

    op: Literal["advertise_service"] = "advertise_service"
    service: str
    type: str
    definition: str | None = None
    """The type's .srv text, for types that the hub does not have (an addition of fibws)."""
    headers: Asked = None
    """Whether calls are to carry a ``header``: see `CallService` (an addition of fibws)."""


class UnadvertiseService(Operation):
    """The client answers no more calls of ``service``; of none of its services, if that is None."""

    op: Literal["unadvertise_service"] = "unadvertise_service"
    service: str | None = None


class ServiceResponse(Operation):
    """The answer to a call, either way: ``values`` is an object, or the text of what went wrong."""

    op: Literal["service_response"] = "service_response"
    service: str
    values: Any = None
    result: bool
    code: Code = None


class AdvertiseAction(Operation):
    """The client pursues the goals of ``action``."""

    op: Literal["advertise_action"] = "advertise_action"
    action: str
    type: str
    definition: str | None = None
    """The type's .action text, for types that the hub does not have (an addition of fibws)."""


class UnadvertiseAction(Operation):
    """The client pursues no more goals of ``action``."""

    op: Literal["unadvertise_action"] = "unadvertise_action"
    action: str


class SendActionGoal(Operation):
    """A goal, from a client that wants it or to the client that is to pursue it."""

    op: Literal["send_action_goal"] = "send_action_goal"
    action: str
    action_type: str
    args: Any = None
    feedback: bool = False
    fragment_size: FragmentSize = None


class CancelActionGoal(Operation):
    """The goal of this id is wanted no more, either way."""

    op: Literal["cancel_action_goal"] = "cancel_action_goal"
    action: str


class ActionFeedback(Operation):
    """How far the goal of this id has come, either way."""

    op: Literal["action_feedback"] = "action_feedback"
    action: str
    values: Any = None


class ActionResult(Operation):
    """What became of the goal of this id, either way.

    ``status`` is one of action_msgs/GoalStatus; ``values`` is the result, or the text of what went
    wrong.
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


class Fragment(Operation):
    """One of ``total`` pieces of the text of another operation, counted from 0."""

    op: Literal["fragment"] = "fragment"
    id: str | int
    data: str
    num: int
    total: int


class Auth(Operation):
    """Who the client is, in the way of rosauth, which this hub does not ask for."""

    op: Literal["auth"] = "auth"


class SetLevel(Operation):
    """Which statuses the client wants to be sent: this level and what is graver."""

    op: Literal["set_level"] = "set_level"
    level: Level


class Status(Operation):
    """What the hub has to say about an operation of the client's, named by its id."""

    op: Literal["status"] = "status"
    level: Level
    msg: str
    code: Code = None


class Subscribed(Operation):
    """The answer to a ``subscribe`` that asks for serialized messages (an addition of fibws).

    ``topic_id`` is what binary frames of this topic begin with; see `protocol.serialized`.
    """

    op: Literal["subscribed"] = "subscribed"
    topic: str
    topic_id: int
    type: str
    md5sum: str


class Peers(Operation):
    """Who is at the other side of a topic: the subscribers for a publisher that asks, and so on.

    It comes at once after the advertisement or subscription of this id, which asked for it, and
    whenever it is others; a node comes only once what is published would reach it. ``nodes`` are
    sorted, each there once. (An addition of fibws.)
    """

    op: Literal["peers"] = "peers"
    topic: str
    nodes: list[str]


Request = (
    Advertise
    | Unadvertise
    | Publish
    | Subscribe
    | Unsubscribe
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
    | Fragment
    | Auth
    | SetLevel
)
"""What a client may send."""

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
"""What a client may be sent."""


def legal_id(id_: object) -> Id:
    """The id of an operation that may be none; None if that is none, either."""
    if isinstance(id_, str):
        return id_ if len(id_) <= LONGEST_ID else None
    return id_ if isinstance(id_, int | float) else None


def encode(operation: Operation) -> bytes:
    """The operation as JSON text, ``op`` first, without the fields that are None."""
    fields = operation.__dict__
    return encode_fields({"op": fields["op"], **fields})


def encode_fields(fields: dict[str, Any], **texts: bytes) -> bytes:
    """An operation's fields as JSON text, without those that are None.

    Args:
        texts: fields that are JSON text already.
    """
    known = {name: value for name, value in fields.items() if value is not None}
    text = json_of(known)
    for name, value in texts.items():
        text = b'%b,"%b":%b}' % (text[:-1], name.encode(), value)
    return text
