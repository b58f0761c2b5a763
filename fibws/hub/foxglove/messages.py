"""Foxglove's WebSocket protocol, version 1: its JSON operations and its binary messages.

The specification is ``docs/spec.md`` of https://github.com/foxglove/ws-protocol. A binary message
begins with one byte for its kind; integers are little-endian:

    hub to client   u8 1, u32 subscription, u64 time, message
                    u8 2, u64 time
                    u8 3, u32 service, u32 call, u32 n, n bytes of the encoding's name, response
                    u8 4, u32 request, u8 status, u32 n, n bytes of an error, data
                    u8 5, u8 status, u64 time, f32 speed, u8 seek, u32 n, n bytes of a request's id
    client to hub   u8 1, u32 channel, message
                    u8 2, u32 service, u32 call, u32 n, n bytes of the encoding's name, request
                    u8 3, u8 command, f32 speed, u8 seek, u64 time, u32 n, n bytes of an id

Times count nanoseconds from 1970. The client chooses the ids in them, except the service's.
"""

from __future__ import annotations

import struct
from collections.abc import Iterable
from typing import Annotated, Any, Final, Literal, NamedTuple, TypeAlias, get_args

from pydantic import BaseModel, ConfigDict, FailFast, Field, TypeAdapter, ValidationError
from pydantic_core import to_json

from fibws.errors import InvalidUtf8, OperationError
from fibws.hub.delivery.send_queue import Frame, frame_of
from fibws.interfaces.json_text import json_of
from fibws.protocol.decoding import quoted
from fibws.protocol.value_limits import check_json
from fibws.protocol.websocket import BINARY, TEXT, Payload, server_frame, server_header

ROS1: Final = "ros1"
"""The encoding of messages in ROS 1's serialization."""
JSON: Final = "json"
ENCODINGS: Final = (ROS1, JSON)
"""The encodings of messages and requests that clients may send."""
ROS1_TEXT: Final = "ros1msg"
ROS2_IDL: Final = "ros2idl"
ROS2_TEXTS: Final = ("ros2msg", ROS2_IDL)
"""The encoding of schemas: the text of a type with those of all types in it."""

INFO, WARNING, ERROR = 0, 1, 2
"""The levels of a status."""

LONGEST_ID = 2000
"""Most characters of an id."""
MOST_ITEMS = 1000
"""Subscriptions, channels or parameters in one operation: each may end with an error of its own."""
MOST_NAMES = 10_000
"""Names of parameters in one operation."""
Names = Annotated[list[str], Field(alias="parameterNames", max_length=MOST_NAMES), FailFast()]
Number = Annotated[int, Field(ge=0, lt=2**32)]
Numbers = Annotated[list[Number], FailFast()]
"""Ids; only the first invalid one is an error, which takes a thousand times the bytes of an id."""
Id = Annotated[str, Field(max_length=LONGEST_ID)] | None

_MESSAGE, _TIME, _RESPONSE, _ASSET, _PLAYBACK = 1, 2, 3, 4, 5
_CLIENT_MESSAGE, _CLIENT_REQUEST, _CLIENT_PLAYBACK = 1, 2, 3
_MESSAGE_HEAD = struct.Struct("<BIQ")
_TIME_MESSAGE = struct.Struct("<BQ")
_CALL_HEAD = struct.Struct("<BIII")
_ASSET_HEAD = struct.Struct("<BIBI")
_PLAYBACK_HEAD = struct.Struct("<BBQfBI")
_CLIENT_HEAD = struct.Struct("<BI")
_CLIENT_PLAYBACK_HEAD = struct.Struct("<BBfBQI")
MESSAGE_HEAD_SIZE: Final = _MESSAGE_HEAD.size
"""Bytes of what `message_head` returns."""


# What clients send.


class _Model(BaseModel):
    model_config = ConfigDict(frozen=True, strict=True, extra="ignore")


class ChannelSubscription(_Model):
    """One of the subscriptions of `SubscribeChannels`."""

    id: Number
    channel: Number = Field(alias="channelId")


class SubscribeChannels(_Model):
    """The client wants the messages of some channels."""

    op: Literal["subscribe"]
    subscriptions: Annotated[list[ChannelSubscription], Field(max_length=MOST_ITEMS), FailFast()]


class UnsubscribeChannels(_Model):
    """The client ends some of its subscriptions."""

    op: Literal["unsubscribe"]
    subscriptions: Numbers = Field(alias="subscriptionIds")


class ClientChannel(_Model):
    """A topic that the client publishes."""

    id: Number
    topic: str
    encoding: str
    schema_name: str = Field(alias="schemaName")
    schema_text: str | None = Field(None, alias="schema")
    schema_encoding: str | None = Field(None, alias="schemaEncoding")


class AdvertiseChannels(_Model):
    """The client publishes some topics."""

    op: Literal["advertise"]
    channels: Annotated[list[ClientChannel], Field(max_length=MOST_ITEMS), FailFast()]


class UnadvertiseChannels(_Model):
    """The client has stopped publishing some topics."""

    op: Literal["unadvertise"]
    channels: Numbers = Field(alias="channelIds")


class Parameter(_Model):
    """A parameter with its new value; without a value it is to be deleted."""

    name: str
    value: Any = None
    type: str | None = None


class GetParameters(_Model):
    """The client asks for parameters; no names stand for all."""

    op: Literal["getParameters"]
    names: Names
    id: Id = None


class SetParameters(_Model):
    """The client sets or deletes parameters, and wants to be answered if there is an id."""

    op: Literal["setParameters"]
    parameters: Annotated[list[Parameter], Field(max_length=MOST_ITEMS), FailFast()]
    id: Id = None


class SubscribeParameterUpdates(_Model):
    """The client wants to know when some parameters change."""

    op: Literal["subscribeParameterUpdates"]
    names: Names


class UnsubscribeParameterUpdates(_Model):
    """Stop reporting some parameters; an empty list means all."""

    op: Literal["unsubscribeParameterUpdates"]
    names: Names


class SubscribeConnectionGraph(_Model):
    """The client wants to know who publishes, subscribes and serves."""

    op: Literal["subscribeConnectionGraph"]


class UnsubscribeConnectionGraph(_Model):
    """Stop reporting the connection graph."""

    op: Literal["unsubscribeConnectionGraph"]


class FetchAsset(_Model):
    """The client asks for a file."""

    op: Literal["fetchAsset"]
    uri: str
    request: Number = Field(alias="requestId")


Operation: TypeAlias = (
    SubscribeChannels
    | UnsubscribeChannels
    | AdvertiseChannels
    | UnadvertiseChannels
    | GetParameters
    | SetParameters
    | SubscribeParameterUpdates
    | UnsubscribeParameterUpdates
    | SubscribeConnectionGraph
    | UnsubscribeConnectionGraph
    | FetchAsset
)
"""An operation of a client."""

_NAMES = ", ".join(get_args(each.model_fields["op"].annotation)[0] for each in get_args(Operation))
_OPERATION: TypeAdapter[Operation] = TypeAdapter(Annotated[Operation, Field(discriminator="op")])


class ClientMessage(NamedTuple):
    """A message that a client publishes."""

    channel: int
    data: memoryview


class ClientRequest(NamedTuple):
    """A call of a service."""

    service: int
    call: int
    encoding: str
    data: memoryview


class PlaybackRequest(NamedTuple):
    """A command for the player of a bag."""

    is_pause: bool
    speed: float
    seek: int | None
    """The time to play from, in nanoseconds."""
    id: str


def parse_operation(data: Payload) -> Operation:
    """Return the operation of a JSON text.

    Raises:
        OperationError: the text is not JSON or has too many values, the operation is unknown, or a
            field is missing or wrong.
        InvalidUtf8: the text is not UTF-8.
    """
    check_json(data)
    try:
        return _OPERATION.validate_json(data)
    except ValidationError as error:
        fault = _fault(error)
    try:
        str(data, "utf-8")
    except UnicodeDecodeError as error:
        raise InvalidUtf8(str(error)) from None
    raise OperationError(fault)


def parse_binary(data: Payload) -> ClientMessage | ClientRequest | PlaybackRequest:
    """Return a binary message of a client; its data are a view of ``data``.

    Raises:
        OperationError: it is too short, or of an unknown kind.
    """
    if not data:
        raise OperationError("invalid binary message: it is empty")
    kind = data[0]
    view = memoryview(data)
    try:
        if kind == _CLIENT_MESSAGE:
            _, channel = _CLIENT_HEAD.unpack_from(data)
            return ClientMessage(channel, view[_CLIENT_HEAD.size :])
        if kind == _CLIENT_REQUEST:
            _, service, call, size = _CALL_HEAD.unpack_from(data)
            end = _CALL_HEAD.size + size
            if end <= len(data):
                encoding = str(view[_CALL_HEAD.size : end], "utf-8", "replace")
                return ClientRequest(service, call, encoding, view[end:])
        if kind == _CLIENT_PLAYBACK:
            _, command, speed, has_seek, time, size = _CLIENT_PLAYBACK_HEAD.unpack_from(data)
            start, end = _CLIENT_PLAYBACK_HEAD.size, _CLIENT_PLAYBACK_HEAD.size + size
            if end <= len(data) and size <= LONGEST_ID:
                id_ = str(view[start:end], "utf-8", "replace")
                return PlaybackRequest(command == 1, speed, time if has_seek else None, id_)
    except struct.error:
        pass
    if kind in (_CLIENT_MESSAGE, _CLIENT_REQUEST, _CLIENT_PLAYBACK):
        fault = f"its {len(data)} bytes do not fit its header"
    else:
        fault = f"kind must be 1, 2 or 3, got {kind}"
    raise OperationError(f"invalid binary message: {fault}")


def _fault(error: ValidationError) -> str:
    """Return the text of the first error of a model."""
    first = error.errors(include_url=False)[0]
    if first["type"] == "json_invalid":
        return f"expected a JSON object: {first['msg']}"
    if first["type"] == "union_tag_invalid":
        return f"unknown op {first['ctx']['tag'][:LONGEST_ID]!r}; known are {_NAMES}"
    if not first["loc"]:
        return f"expected an object whose op is one of {_NAMES}, got {quoted(first['input'])}"
    where = "".join(f"{step}: " for step in map(str, first["loc"]))
    value = "" if first["type"] == "missing" else f", got {quoted(first['input'])}"
    return f"{where}{first['msg']}{value}"


# What the hub sends.


def text_frame(op: str, **fields: object) -> bytes:
    """Return the WebSocket frame of an operation; fields that are None are left out."""
    kept = {name: value for name, value in fields.items() if value is not None}
    return server_frame(TEXT, json_of({"op": op, **kept}))


def list_frame(op: str, field: str, items: Iterable[bytes], **fields: object) -> bytes:
    """Return the frame of an operation with a list whose items are JSON texts already."""
    head = to_json({"op": op, **{name: each for name, each in fields.items() if each is not None}})
    text = b'%b,"%b":[%b]}' % (head[:-1], field.encode(), b",".join(items))
    return server_frame(TEXT, text)


def message_head(subscription: int, time: int) -> bytes:
    """Return what precedes a message."""
    return _MESSAGE_HEAD.pack(_MESSAGE, subscription, time)


def time_frame(time: int) -> bytes:
    """Return the frame that sets the client's clock."""
    return server_frame(BINARY, _TIME_MESSAGE.pack(_TIME, time))


def response_frame(service: int, call: int, encoding: str, data: bytes) -> bytes:
    """Return the frame of a service's response."""
    name = encoding.encode()
    head = _CALL_HEAD.pack(_RESPONSE, service, call, len(name))
    return server_frame(BINARY, b"".join((head, name, data)))


def playback_frame(
    status: int, time: int, speed: float, request: str = "", *, did_seek: bool = False
) -> bytes:
    """Return the frame of the state of a bag's player.

    Args:
        status: 0 while it plays, 1 paused, 2 waiting, 3 ended.
        request: the id of the request that this answers, if it answers one.
    """
    id_ = request.encode()
    head = _PLAYBACK_HEAD.pack(_PLAYBACK, status, time, speed, did_seek, len(id_))
    return server_frame(BINARY, head + id_)


def asset_frame(request: int, data: bytes) -> Frame:
    """Return the frame of a file."""
    head = _ASSET_HEAD.pack(_ASSET, request, 0, 0)
    return frame_of(server_header(BINARY, len(head) + len(data)) + head, data)


def asset_error_frame(request: int, error: str) -> bytes:
    """Return the frame that says why there is no such file."""
    text = error.encode()
    return server_frame(BINARY, _ASSET_HEAD.pack(_ASSET, request, 1, len(text)) + text)
